#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "hw_models/machines/gpu_config.h"

namespace hw::test {

/// A change of a machine that doubles a resource at equal latencies. The change should never slow a frame.
struct Improvement {
  std::string_view name;
  void (*apply)(GpuConfig& config);
};
extern const std::array<Improvement, 9> kImprovements;

/// Returns the change that is tested on the machine sane_config(seed).
const Improvement& improvement_of(std::uint64_t seed);

/// A known exception: a 256x128 frame that the change slows by more than 1 %. tests/validation/DEVIATIONS.md has the
/// cause.
struct KnownSlower {
  std::string_view scene;
  std::uint64_t seed = 0;
  double percent = 0;
};
/// Returns the known exception for a scene and a seed, or null.
const KnownSlower* known_slower(std::string_view scene, std::uint64_t seed);

}  // namespace hw::test
