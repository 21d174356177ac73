#pragma once
#include <vector>

#include "traces/scene/gltf/materials/placements.h"
#include "traces/scene/gltf/materials/textures.h"

namespace traces::gltf {

/// Fills Scene::materials, one per glTF material, and returns the texture placements of each. Maps metallic-roughness
/// to Whitted's diffuse, mirror and glass:
///
///   gloss    1 up to roughness 0.1, falling linearly to 0 at roughness 0.5
///   mirror   gloss x (metallic + (1 - metallic) x dielectric). dielectric = 2 F0, about a dielectric's mean
///            reflectance over all angles. F0 comes from the index of refraction, scaled by KHR_materials_specular (the
///            mean of its colour channels). A mirror below 0.02 becomes 0 to save rays. With a metallic-roughness
///            texture, the rule applies to each texel.
///   tint     base colour for the metallic part of the mirror, white for the dielectric part
///   coat     KHR_materials_clearcoat is a second dielectric layer with its own roughness: it mirrors coat x gloss x
///            0.08 of the light that is not yet mirrored
///   glass    KHR_materials_transmission with KHR_materials_ior; roughness is ignored. The base colour, with texture
///            and vertex colours, tints transmitted light at each surface. Glass refracts, and Fresnel's law alone
///            gives its mirror share. KHR_materials_volume colours it: absorption = -ln(attenuationColor) /
///            attenuationDistance. A volume of thickness 0 is a thin sheet: no absorption, no refraction (ior 1),
///            mirror as for any dielectric. Without the volume extension the material is solid glass, as most such
///            files mean.
///   alpha    MASK and BLEND keep their alpha; opacity is the base colour's alpha
///   unlit    KHR_materials_unlit: the base colour is emitted; the surface neither receives nor casts light
///   Rough metals use their base colour as diffuse colour.
///
/// Textures of base colour, metallic-roughness, normal, occlusion and emission are kept; textures of transmission,
/// clear coat and specular are replaced by their mean.
std::vector<Placements> read_materials(Context& context, Textures& textures);

}  // namespace traces::gltf
