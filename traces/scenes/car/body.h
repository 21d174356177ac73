#pragma once
#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::car {

// In metres; the car looks along +x, z is its right, it stands on y = 0.
inline constexpr float kFrontAxle = 1.30F, kRearAxle = -1.31F;
inline constexpr float kWheel = 0.335F;  ///< radius, and height of the axles
inline constexpr float kArch = 0.385F;   ///< radius of the wheel arches
inline constexpr float kTrack = 0.795F;  ///< from the middle to the middle of a wheel

/// The shell up to the belt line: fenders, bonnet, doors, tail; open below, with wheel arches.
Mesh make_shell(const Detail& detail);

/// Roof and pillars, without glass; its foot is inside the shell.
Mesh make_cabin(const Detail& detail);

/// Liners of the wheel arches and the floor.
Mesh make_underbody(const Detail& detail);

/// Rims of the wheel arches.
Mesh make_arch_lips(const Detail& detail);

/// Half the width of the shell on that place of its side.
float side_at(float x, float y);

}  // namespace traces::car
