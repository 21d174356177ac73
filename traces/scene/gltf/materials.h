#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// The textures of a glTF file. An image is decoded when a material first uses it; unused images are never decoded.
class Textures {
 public:
  explicit Textures(Context& context) : context_(context) {}

  /// Returns the index in Scene::textures of glTF texture `texture`, read as colour (`srgb`) or as numbers; kNoTexture
  /// if it has no readable image.
  std::uint32_t find_or_add(int texture, bool srgb);

  /// Returns the mean of a texture's texels, 0..1, alpha included; linear colour if `srgb`. White if there is no image.
  glm::vec4 mean_colour_of(int texture, bool srgb);

 private:
  Texture& decode_image(int index);
  int source_of(int texture);
  /// Adds a texture's pixels to the number of decoded pixels. Throws InputError if it then exceeds the scene's limit.
  void count_pixels(const Texture& texture, const std::string& name);

  Context& context_;
  std::map<int, Texture> images_;
  std::set<int> shown_;       ///< images that some texture of the scene shows
  std::uint64_t pixels_ = 0;  ///< number of decoded pixels, including copies for other wrap modes, filters or encodings
  std::map<std::pair<int, bool>, glm::vec4> means_;
  std::map<std::tuple<int, int, int, bool, bool>, std::uint32_t> added_;  ///< texture index by image, both wrap modes,
                                                                          ///< nearest filter and sRGB
};

/// Source of a texture's coordinates: one of the primitive's coordinate sets, transformed by KHR_texture_transform.
struct TexturePlacement {
  int set = 0;
  glm::vec2 offset{0}, scale{1};
  float rotation = 0;
  glm::vec2 transform_uv(const glm::vec2& uv) const;
  friend bool operator==(const TexturePlacement&, const TexturePlacement&) = default;
};

/// Reads the texture placement from a material's reference to a texture.
TexturePlacement read_placement(const Context& context, int set, const tinygltf::ExtensionMap& extensions);

/// The texture placements that a material uses: at most two, for Mesh::uvs and Mesh::second_uvs.
class Placements {
 public:
  /// True if a texture with this placement uses the second coordinates. A third placement adds a warning that names the
  /// material, and uses the first coordinates.
  bool uses_second_uv_set(Context& context, const TexturePlacement& placement, const std::string& material);

  const std::vector<TexturePlacement>& all_placements() const { return list_; }

 private:
  std::vector<TexturePlacement> list_;
};

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
///   facets   for images with GGX roughness: metallic x base colour + (1 - metallic) x F0
///
/// Textures of base colour, metallic-roughness, normal, occlusion and emission are kept; textures of transmission,
/// clear coat and specular are replaced by their mean.
std::vector<Placements> read_materials(Context& context, Textures& textures);

}  // namespace traces::gltf
