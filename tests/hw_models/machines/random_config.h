#pragma once
#include <cstdint>

#include "hw_models/machines/gpu_config.h"

namespace hw::test {

/// Returns a random machine configuration, determined by `seed`. All fields that affect timing or traversal vary within
/// their limits; a quarter of them have their minimum. No field is far above its default. Memory is one of four grades
/// with random ranks and controller. A random value that violates a rule between fields is not used.
GpuConfig random_config(std::uint64_t seed);

/// Returns a random machine for wide trees, determined by `seed`: random_config() with up to eight box testers, any
/// stack and several intersection units.
GpuConfig random_wide_config(std::uint64_t seed);

/// Returns a random machine near the default, determined by `seed`. Each number is half to double its default, and
/// nothing is ideal.
GpuConfig sane_config(std::uint64_t seed);

}  // namespace hw::test
