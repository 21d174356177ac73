#pragma once
#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Reads the light that export_glb() stores in the scene's extras, `"raywatt": {"background": [r, g, b], "ambient": [r,
/// g, b]}`, and converts the file's lights from glTF's units. Returns false if it is missing. If it is present, no
/// lights for emitters, default sun or exposure are added.
bool read_final_light(Context& context);

}  // namespace traces::gltf
