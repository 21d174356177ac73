#pragma once
#include <glm/vec4.hpp>

#include "traces/scene/scene.h"

namespace traces {

/// Mean of all texels, 0..1, alpha included; of linear colour, whether the texture stores it so or sRGB-encoded.
glm::vec4 mean_texel(const Texture& texture);

}  // namespace traces
