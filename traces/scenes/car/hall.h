#pragma once
#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::car {

/// Adds a long hall of concrete with a painted floor, lights in the ceiling and glowing columns along the walls.
void add_hall(Scene& scene, const Detail& detail);

}  // namespace traces::car
