#pragma once
#include <cstddef>

#include "traces/scene/scene.h"

namespace traces {

/// Replaces emissive surfaces by point lights, because a Whitted renderer has only points and directions.
///
/// 1. Each emissive instance with an emission of 1 or more gets one light. Weaker and unlit surfaces get none.
/// 2. intensity = area x emission x mean of its texture. The light moves with the instance's node.
/// 3. The position is the centroid, moved out of the emitter towards the middle of the scene, so that the emitter casts
/// no shadow. It moves along the mean normal of an open surface, or the shortest side of a closed surface's box.
/// 4. Lights below 1 % of the strongest are dropped, then all except the strongest kMaxEmitterLights; the strongest is
/// first.
/// 5. Emissions above 1 are then scaled to 1 with the same hue, so that lamps look white.
void add_emitter_lights(Scene& scene);
inline constexpr std::size_t kMaxEmitterLights = 4;

/// Adds a sun high on one side and bright ambient light, if the scene has no lights.
void add_default_light(Scene& scene);

/// Scales all lights to a suitable exposure, because files give light in candela, lux, watts or arbitrary units. The
/// brightest tenth of the first camera's view then has an irradiance of kTargetIrradiance or more. Sets Scene::ambient
/// to kAmbient. Shadows are ignored.
void scale_lights_to_exposure(Scene& scene);
inline constexpr float kTargetIrradiance = 0.85F;
inline constexpr float kAmbient = 0.15F;

/// Removes all lights except one: the light that alone makes the first camera's view brightest.
void keep_strongest_light(Scene& scene);

/// Runs add_emitter_lights(); then add_default_light() if the scene has no lights, otherwise
/// scale_lights_to_exposure(). Call it after the cameras are set.
void finish_lights(Scene& scene);

}  // namespace traces
