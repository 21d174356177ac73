#pragma once
#include <cstddef>

#include "traces/scene/scene.h"

namespace traces {

/// A Whitted renderer knows points and directions only, so an emissive surface is replaced by a point light.
///
/// One light per emissive instance that shines with 1 or more (weaker ones, say lava, only glow; unlit surfaces shed no
/// light): intensity = area x emission x mean of its texture; it moves with the instance's node; position = the area's
/// centroid, moved just out of the emitter so that it does not shadow itself: along the mean normal of an open surface
/// (the shortest side of a closed one's box), towards the middle of the scene. Those below 1 % of the strongest are
/// dropped, then all but the kMaxEmitterLights strongest; the strongest comes first. Afterwards emissions above 1 are
/// scaled to 1, hue kept: lamps look white, and their strength lives on in the lights.
void add_emitter_lights(Scene& scene);
inline constexpr std::size_t kMaxEmitterLights = 4;

/// A sun high on one side and a bright sky, if the scene has no light of its own.
void add_default_light(Scene& scene);

/// Sets the exposure, as files give light in candela, lux, watts or just numbers: all lights are scaled by one factor
/// such that, of what the first camera sees, the brightest tenth receives an irradiance of kTargetIrradiance or more.
/// Shadows are left out of account. Relative strengths and colours stay. `ambient` becomes kAmbient.
void expose_lights(Scene& scene);
inline constexpr float kTargetIrradiance = 0.85F;
inline constexpr float kAmbient = 0.15F;

/// Drops all lights but the one that, alone, makes what the first camera sees brightest.
void keep_strongest_light(Scene& scene);

/// Emitters, default light and exposure in order; exposure only where lights came with the scene. Needs the cameras.
void finish_lights(Scene& scene);

}  // namespace traces
