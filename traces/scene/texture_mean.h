#pragma once
#include <glm/vec4.hpp>

#include "traces/scene/scene.h"

namespace traces {

/// Returns the mean of all texels, alpha included, 0..1; the mean of linear colour if the texture is sRGB-encoded.
glm::vec4 mean_texel(const Texture& texture);

}  // namespace traces
