#pragma once
#include "traces/scene/gltf_export/document.h"

namespace traces::gltf_export {

/// Writes Scene::materials as metallic-roughness with extensions, one to one and such that the loader's rule
/// (gltf/materials/materials.h) makes the same Whitted values of them:
///
///   mirror   a share a of it is metal (metallic a, roughness 0) and mirrors in the base colour; the rest w is what a
///            dielectric mirrors, white (KHR_materials_ior, 2 F0 = w / (1 - a)), or in glass, whose index is taken, a
///            clear coat. a follows from the tint: a (base - 1) = mirror (tint - 1). A white surface with a white
///            mirror is a metal if it mirrors half or more. A pure mirror is a metal of roughness 0, as its base colour
///            is not seen.
///   no mirror  roughness 1
///   per texel  (metal_rough_texture) the factors as they are; the index from `dielectric`, a clear coat from `coat`
///   glass    KHR_materials_transmission, _ior and _volume; a sheet that bends nothing (ior 1) but mirrors white has a
///            volume of thickness 0 and the index that mirrors so much
///   emission KHR_materials_emissive_strength above 1; a black surface that only shines and lights nothing is unlit
///
/// Properties that glTF cannot say come as near as they go: a tint darker than any mixture of base colour and white,
/// more than 8 % white mirror on glass, a mirror of less than 2 %.
void write_materials(const Scene& scene, Document& out);

}  // namespace traces::gltf_export
