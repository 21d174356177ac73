#pragma once
#include <string>

#include "traces/scene/gltf/materials/textures.h"

namespace traces::gltf {

/// The numbers of a glTF material and its extensions; textures of the extensions are folded in by their mean.
struct Surface {
  float metallic = 1, roughness = 1;            ///< factors
  float mean_metallic = 1, mean_roughness = 1;  ///< factors times the mean of their texture
  float ior = 1.5F;
  float specular = 1;  ///< KHR_materials_specular: scales the mirror share of a dielectric
  float transmission = 0;
  bool thin = false;  ///< KHR_materials_volume with thickness 0: no refraction
  glm::vec3 absorption{0};
  float coat = 0, coat_roughness = 0;
};
Surface read_surface(Context& context, Textures& textures, const tinygltf::Material& material, const std::string& what);

/// Sets the mirror, transmission and absorption of `out` by the rule of materials.h. `mean_base` is its base colour
/// times its texture's mean.
void set_surface(Material& out, const Surface& surface, const glm::vec3& mean_base);

}  // namespace traces::gltf
