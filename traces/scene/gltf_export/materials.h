#pragma once
#include "traces/scene/gltf_export/document.h"

namespace traces::gltf_export {

/// Writes Scene::materials one to one as metallic-roughness with extensions, so that the rule of the loader
/// (gltf/materials.h) restores the same values:
///
///   mirror     a sum of a metal and a white mirror. The metal (metallic a, roughness 0) mirrors in the base colour.
///              The tint determines a by a (base - 1) = mirror (tint - 1). The white rest w = mirror - a is a
///              dielectric (KHR_materials_ior, 2 F0 = w / (1 - a)), or a clear coat on glass, whose index is given.
///              A white surface with a white mirror is a metal if it mirrors half or more. A pure mirror is a metal,
///              because its base colour is invisible.
///   no mirror  roughness 1
///   per texel  (metal_rough_texture) the factors as they are; the index from `dielectric`, a clear coat from `coat`
///   glass      KHR_materials_transmission, _ior and _volume; a sheet that does not refract (ior 1) but mirrors white
///              has a volume of thickness 0 and the index of its mirrored fraction
///   emission   KHR_materials_emissive_strength above 1; a black surface that shines without lighting others is unlit
///
/// Approximated, as glTF cannot express them: a tint darker than any mixture of base colour and white, more than 8 %
/// white mirror on glass, a mirror of less than 2 %.
void write_materials(const Scene& scene, Document& out);

/// Writes Scene::textures one to one. Equal texels share one PNG, equal wrap modes and filters one sampler.
void write_textures(const Scene& scene, Document& out);

}  // namespace traces::gltf_export
