#pragma once

#include <cstdint>
#include <span>

namespace tools {

/// Returns the mean FLIP error (Andersson et al. 2020, LDR) of a picture, from 0 (equal) to 1. Both pictures are linear
/// RGB, clamped to [0, 1], with `width` pixels per row, seen at 67 pixels per degree.
double mean_flip(std::span<const float> reference, std::span<const float> test, std::uint32_t width);

}  // namespace tools
