#pragma once
#include <cstdint>

#include "hw_models/machines/gpu_config.h"

namespace hw::test {

/// A machine drawn by hash from `seed`: every field that affects timing or walk, each within its limits and not far
/// above its default, a quarter of them at their least. Memory is one of the four grades, with its ranks and controller
/// drawn. A field whose new value breaks a rule with others keeps its old one.
GpuConfig random_config(std::uint64_t seed);

/// The same, near the default machine: each figure a half to double, nothing ideal.
GpuConfig sane_config(std::uint64_t seed);

}  // namespace hw::test
