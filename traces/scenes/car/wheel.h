#pragma once
#include "traces/scene/scene.h"

namespace traces::car {

// About the z axis, the outer side towards +z.

Mesh make_tyre(double detail);
/// Rim with five pairs of spokes.
Mesh make_rim(double detail);
Mesh make_brake_disc(double detail);
/// Does not turn with the wheel.
Mesh make_caliper(double detail);

}  // namespace traces::car
