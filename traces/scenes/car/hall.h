#pragma once
#include "traces/scene/scene.h"

namespace traces::car {

/// A long hall of concrete with a painted floor, lights in the ceiling and glowing columns along the walls.
void add_hall(Scene& scene, double detail);

}  // namespace traces::car
