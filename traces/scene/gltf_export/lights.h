#pragma once
#include "traces/scene/gltf_export/nodes.h"

namespace traces::gltf_export {

/// Writes Scene::lights by KHR_lights_punctual, and the light that glTF cannot express into the scene's extras:
/// `"raywatt": {"background": [r, g, b], "ambient": [r, g, b]}`.
///
/// Intensities are multiplied by pi: a white surface has radiance 1 at an irradiance of pi in glTF, and of 1 in a Scene
/// (traces/scene/scene.h). The extras mark the light as final: lights for emitters and the exposure are already in it
/// (gltf/final_light.h).
void write_lights(const Scene& scene, const NodeMap& map, Document& out);

}  // namespace traces::gltf_export
