#pragma once
#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Reads what export_glb() notes in the extras of the scene shown, `"raywatt": {"background": [r, g, b], "ambient": [r,
/// g, b]}`: takes both over and brings the file's lights from glTF's units to a Scene's. True if it is there. Then the
/// light is final: no stand-ins for emitters, no default sun, no exposure.
bool read_final_light(Context& context);

}  // namespace traces::gltf
