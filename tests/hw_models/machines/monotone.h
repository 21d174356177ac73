#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "hw_models/machines/gpu_config.h"

namespace hw::test {

/// A resource that is doubled at the same latencies, which should not slow a frame.
struct Improvement {
  std::string_view name;
  void (*apply)(GpuConfig& config);
};
extern const std::array<Improvement, 9> kImprovements;

/// Returns the resource that is doubled on the machine of this seed (sane_config()).
const Improvement& improvement_of(std::uint64_t seed);

/// A frame of 256x128 that becomes more than 1 % slower; tests/validation/DEVIATIONS.md has the cause.
struct KnownSlower {
  std::string_view scene;
  std::uint64_t seed = 0;
  double percent = 0;
};
/// Returns the listed frame, or null.
const KnownSlower* known_slower(std::string_view scene, std::uint64_t seed);

}  // namespace hw::test
