#pragma once
#include "traces/scene/gltf_export/nodes.h"

namespace traces::gltf_export {

/// Writes Scene::lights by KHR_lights_punctual, and into the extras of the glTF scene what glTF has no place for:
/// `"raywatt": {"background": [r, g, b], "ambient": [r, g, b]}`.
///
/// In glTF an irradiance of pi makes a white surface shine with radiance 1, in a Scene an irradiance of 1 does
/// (traces/scene/scene.h), so intensities grow by pi. The extras tell the loader that the light is final: emitters have
/// their stand-ins, exposure is set (gltf/final_light.h).
void write_lights(const Scene& scene, const NodeMap& map, Document& out);

}  // namespace traces::gltf_export
