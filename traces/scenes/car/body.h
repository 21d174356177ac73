#pragma once
#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::car {

// In metres. The car's front is +x, its right side +z, the ground y = 0.
inline constexpr float kFrontAxle = 1.30F, kRearAxle = -1.31F;
inline constexpr float kWheel = 0.335F;  ///< radius, and height of the axles
inline constexpr float kArch = 0.385F;   ///< radius of the wheel arches
inline constexpr float kTrack = 0.795F;  ///< from the car's middle plane to the middle of a wheel

/// Makes the shell up to the belt line: fenders, bonnet, doors, tail. It is open below and has wheel arches.
Mesh make_shell(const Detail& detail);

/// Makes roof and pillars without glass; the lower edge is inside the shell.
Mesh make_cabin(const Detail& detail);

/// Makes the liners of the wheel arches and the floor.
Mesh make_underbody(const Detail& detail);

/// Makes the rims of the wheel arches.
Mesh make_arch_lips(const Detail& detail);

/// Returns half the width of the shell at a point of its side.
float side_at(float x, float y);

}  // namespace traces::car
