#pragma once
#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::car {

// Wheels rotate about z; the outer side faces +z.

Mesh make_tyre(const Detail& detail);
/// Makes a rim with five pairs of spokes.
Mesh make_rim(const Detail& detail);
Mesh make_brake_disc(const Detail& detail);
/// Makes the brake caliper, which does not rotate with the wheel.
Mesh make_caliper(const Detail& detail);

}  // namespace traces::car
