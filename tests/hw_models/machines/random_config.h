#pragma once
#include <cstdint>

#include "hw_models/machines/gpu_config.h"

namespace hw::test {

/// Returns a machine drawn by hash from `seed`. Every field that affects timing or walk is within its limits and not
/// far above its default; a quarter are at their minimum. Memory is one of the four grades, with random ranks and
/// controller. A field keeps its old value if the new one breaks a rule with others.
GpuConfig random_config(std::uint64_t seed);

/// The same, near the default machine: each number is a half to double, nothing is ideal.
GpuConfig sane_config(std::uint64_t seed);

}  // namespace hw::test
