#pragma once
#include <vector>

#include <glm/vec2.hpp>

#include "traces/scene/gltf/textures.h"

namespace traces::gltf {

/// How a material's base texture finds its texel: which of the primitive's sets of coordinates, and
/// KHR_texture_transform.
struct TexturePlacement {
  int set = 0;
  glm::vec2 offset{0}, scale{1};
  float rotation = 0;
  glm::vec2 apply(const glm::vec2& uv) const;
};

/// Fills Scene::materials, one per glTF material, from metallic-roughness to Whitted's diffuse, mirror and glass:
///
///   gloss    1 up to roughness 0.1, falling linearly to 0 at roughness 0.5
///   mirror   gloss x (metallic x 1 + (1 - metallic) x 2 F0), F0 from the index of refraction; 2 F0 is about a
///            dielectric's mean reflectance over all angles. Below 0.02 it is dropped: no rays for nothing.
///   tint     base colour for the metal's part of the mirror, white for the dielectric's
///   clear coat adds a second such dielectric layer of its own roughness
///   glass    KHR_materials_transmission with KHR_materials_ior, whatever the roughness; it has no mirror share of its
///            own, Fresnel's law gives it one. Blended materials (alpha below 1) let 1 - alpha through unbent (ior 1).
///   rough metals show their base colour as a diffuse one
///
/// Other textures than the base colour's (metallic-roughness, emission, transmission) count by their mean.
std::vector<TexturePlacement> read_materials(Context& context, Textures& textures);

}  // namespace traces::gltf
