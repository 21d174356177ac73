#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "hw_models/machines/gpu_config.h"

namespace hw::test {

/// Twice as much of something that should not hurt, at the same latencies.
struct Improvement {
  std::string_view name;
  void (*apply)(GpuConfig& config);
};
extern const std::array<Improvement, 9> kImprovements;

/// The one that the machine of this seed gets (sane_config()).
const Improvement& improvement_of(std::uint64_t seed);

/// A frame of 256x128 that is slower by over 1 % all the same; why, is written in tests/validation/DEVIATIONS.md.
struct KnownSlower {
  std::string_view scene;
  std::uint64_t seed = 0;
  double percent = 0;
};
/// Null if it is none of these.
const KnownSlower* known_slower(std::string_view scene, std::uint64_t seed);

}  // namespace hw::test
