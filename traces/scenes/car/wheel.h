#pragma once
#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::car {

// About the z axis, the outer side towards +z.

Mesh make_tyre(const Detail& detail);
/// Rim with five pairs of spokes.
Mesh make_rim(const Detail& detail);
Mesh make_brake_disc(const Detail& detail);
/// Does not turn with the wheel.
Mesh make_caliper(const Detail& detail);

}  // namespace traces::car
