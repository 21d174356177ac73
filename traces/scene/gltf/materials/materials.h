#pragma once
#include <vector>

#include "traces/scene/gltf/materials/placements.h"
#include "traces/scene/gltf/materials/textures.h"

namespace traces::gltf {

/// Fills Scene::materials, one per glTF material, from metallic-roughness to Whitted's diffuse, mirror and glass:
///
///   gloss    1 up to roughness 0.1, falling linearly to 0 at roughness 0.5
///   mirror   gloss x (metallic x 1 + (1 - metallic) x dielectric), where dielectric = 2 F0, F0 from the index of
///            refraction and scaled by KHR_materials_specular (its colour by the mean of the channels); 2 F0 is about a
///            dielectric's mean reflectance over all angles. Below 0.02 it is dropped: no rays for nothing. With a
///            metallic-roughness texture the same is done for each texel with its metallic and roughness.
///   tint     base colour for the metal's part of the mirror, white for the dielectric's
///   coat     KHR_materials_clearcoat adds a second such dielectric layer of its own roughness: coat x gloss x 0.08 of
///            what is not yet mirrored
///   glass    KHR_materials_transmission with KHR_materials_ior, whatever the roughness; the base colour, with its
///            texture and vertex colours, tints what is seen through each surface. A body: light is bent, and its
///            mirror share comes from Fresnel's law alone. KHR_materials_volume colours it: absorption =
///            -ln(attenuationColor) / attenuationDistance. A volume of thickness 0 says that the surface is a thin
///            sheet: nothing absorbed, nothing bent (ior 1), and it mirrors as any dielectric. Without the volume
///            extension it is a body too, as most files without it mean solid glass.
///   alpha    MASK and BLEND keep their alpha; opacity is that of the base colour
///   unlit    KHR_materials_unlit: the base colour is emitted, no light falls on the surface and it sheds none
///   rough metals show their base colour as a diffuse one
///
/// Textures of base colour, metallic-roughness, normal, occlusion and emission are kept; those of other features
/// (transmission, clear coat, specular) count by their mean. Returns how the textures of each material are placed.
std::vector<Placements> read_materials(Context& context, Textures& textures);

}  // namespace traces::gltf
