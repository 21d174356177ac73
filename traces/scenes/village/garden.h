#pragma once
#include <cstdint>

#include "traces/scene/scene.h"

namespace traces::village {

/// Adds trees, bushes and grass. Their leaves fill the scene up to `triangles`.
void add_garden(Scene& scene, std::uint32_t triangles, float detail);

}  // namespace traces::village
