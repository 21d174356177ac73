#pragma once
#include <cmath>

#include <glm/vec4.hpp>

#include "traces/scene/scene.h"

namespace traces {

/// Decodes an sRGB channel to a linear value; argument and result are 0 to 1 (IEC 61966-2-1).
inline double srgb_to_linear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// Returns the mean of all texels, including alpha, 0 to 1. sRGB-encoded colours are converted to linear before the
/// mean.
glm::vec4 mean_texel(const Texture& texture);

}  // namespace traces
