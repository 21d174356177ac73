#include "traces/scene/gltf_export/materials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scene/images.h"

namespace traces::gltf_export {
namespace {

int wrap_of(Texture::Wrap wrap) {
  switch (wrap) {
    case Texture::Wrap::kMirror:
      return TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT;
    case Texture::Wrap::kClamp:
      return TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    case Texture::Wrap::kRepeat:
      break;
  }
  return TINYGLTF_TEXTURE_WRAP_REPEAT;
}

int add_image(const Texture& texture, Document& out) {
  const std::string png = encode_png(texture);
  tinygltf::Image image;
  image.name = texture.name;
  image.mimeType = "image/png";
  image.bufferView = out.add_view(std::as_bytes(std::span(png)));
  out.model.images.push_back(image);
  return static_cast<int>(out.model.images.size()) - 1;
}

int add_sampler(const Texture& texture, Document& out) {
  const bool nearest = texture.filter == Texture::Filter::kNearest;
  tinygltf::Sampler sampler;
  sampler.magFilter = sampler.minFilter = nearest ? TINYGLTF_TEXTURE_FILTER_NEAREST : TINYGLTF_TEXTURE_FILTER_LINEAR;
  sampler.wrapS = wrap_of(texture.wrap_u);
  sampler.wrapT = wrap_of(texture.wrap_v);
  out.model.samplers.push_back(sampler);
  return static_cast<int>(out.model.samplers.size()) - 1;
}

}  // namespace

void write_textures(const Scene& scene, Document& out) {
  std::vector<int> images;
  std::map<std::tuple<Texture::Wrap, Texture::Wrap, Texture::Filter>, int> samplers;
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const Texture& texture = scene.textures[i];
    std::size_t same = 0;
    while (same < i && (scene.textures[same].width != texture.width || scene.textures[same].texels != texture.texels)) {
      ++same;
    }
    images.push_back(same < i ? images[same] : add_image(texture, out));
    const auto [sampler, is_new] = samplers.try_emplace({texture.wrap_u, texture.wrap_v, texture.filter}, 0);
    if (is_new) sampler->second = add_sampler(texture, out);
    tinygltf::Texture to;
    to.source = images.back();
    to.sampler = sampler->second;
    out.model.textures.push_back(to);
  }
}

namespace {

constexpr float kCoatShare = 0.08F;  // mirrored by a clear coat of factor 1: twice the reflectance of index 1.5

/// Returns the index of refraction of a dielectric that mirrors `share`, twice its reflectance at normal incidence.
float ior_for_mirror(float share) {
  const float ratio = std::sqrt(0.5F * std::clamp(share, 0.0F, 1.0F));
  return (1 + ratio) / (1 - ratio);
}

float strongest_channel(const glm::vec3& c) { return std::max({c.x, c.y, c.z}); }

/// The values of a glTF material from which the glTF loader derives a surface.
struct Surface {
  glm::vec3 base{1};
  float metallic = 0, roughness = 1;
  float ior = 1.5F;
  float coat = 0;     ///< clear coat factor
  bool thin = false;  ///< a sheet of glass that mirrors like any dielectric and does not refract
};

/// Returns the metallic factor a of a mirror: the least-squares solution of a (base - 1) = mirror (tint - 1).
float metallic_fraction(const Material& m, const glm::vec3& mean_base) {
  const glm::vec3 base = mean_base - 1.0F, tint = m.mirror_tint - 1.0F;
  const float squared = glm::dot(base, base);
  if (!(squared > 1e-12F)) return m.mirror >= 0.5F ? m.mirror : 0;
  return std::clamp(m.mirror * glm::dot(base, tint) / squared, 0.0F, m.mirror);
}

Surface surface_of(const Material& m, const glm::vec3& mean_texture) {
  Surface s;
  s.base = glm::clamp(m.base_colour, 0.0F, 1.0F);
  s.thin = m.transmission > 0 && m.ior <= 1 && m.absorption == glm::vec3(0);
  const bool glass = m.transmission > 0 && !s.thin;
  if (glass) s.ior = std::max(m.ior, 1.0F);
  if (s.thin) s.ior = 1;
  if (m.metal_rough_texture.is_used()) {
    s.metallic = m.metallic;
    s.roughness = m.roughness;
    if (!glass) s.ior = ior_for_mirror(m.dielectric);
    s.coat = std::min(m.coat / kCoatShare, 1.0F);
    return s;
  }
  if (m.transmission > 0) s.roughness = 0;
  if (!(m.mirror > 0)) return s;
  s.roughness = 0;
  if (m.mirror >= 1 && !m.base_texture.is_used()) {
    s.base = glm::clamp(m.mirror_tint, 0.0F, 1.0F);
    s.metallic = 1;
    return s;
  }
  s.metallic = metallic_fraction(m, s.base * mean_texture);
  const float white = m.mirror - s.metallic;
  const float share = s.metallic < 1 ? white / (1 - s.metallic) : 0;
  if (glass) {
    s.coat = std::min(share / kCoatShare, 1.0F);
  } else {
    s.ior = ior_for_mirror(share);
  }
  return s;
}

float to_linear(std::uint32_t encoded) {
  const float c = static_cast<float>(encoded & 255U) / 255;
  return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F);
}

/// Returns the mean linear colour of an sRGB texture.
glm::vec3 mean_colour_of(const Texture& texture) {
  glm::dvec3 sum(0);
  for (const std::uint32_t texel : texture.texels) {
    sum += glm::dvec3(to_linear(texel), to_linear(texel >> 8), to_linear(texel >> 16));
  }
  return glm::vec3(sum / std::max<double>(static_cast<double>(texture.texels.size()), 1));
}

template <class Info>
void write_texture_use(const TextureUse& from, Info& to) {
  if (!from.is_used()) return;
  to.index = static_cast<int>(from.texture);
  to.texCoord = from.second_uv ? 1 : 0;
}

void write_surface(const Material& m, const Surface& s, tinygltf::Material& to, Document& out) {
  to.pbrMetallicRoughness.metallicFactor = double{s.metallic};
  to.pbrMetallicRoughness.roughnessFactor = double{s.roughness};
  if (s.ior != 1.5F) out.add_extension(to.extensions, "KHR_materials_ior", {{"ior", to_value(s.ior)}});
  if (s.coat > 0) out.add_extension(to.extensions, "KHR_materials_clearcoat", {{"clearcoatFactor", to_value(s.coat)}});
  if (m.transmission > 0) {
    out.add_extension(to.extensions, "KHR_materials_transmission", {{"transmissionFactor", to_value(m.transmission)}});
    if (s.thin && s.ior > 1) {
      out.add_extension(to.extensions, "KHR_materials_volume", {{"thicknessFactor", to_value(0)}});
    } else if (const float most = strongest_channel(m.absorption); most > 0) {
      // glTF has one attenuation distance for all channels: the distance at which 1 / e of the most absorbed is left.
      const glm::vec3 colour(std::exp(-m.absorption.x / most), std::exp(-m.absorption.y / most),
                             std::exp(-m.absorption.z / most));
      out.add_extension(to.extensions, "KHR_materials_volume",
                        {{"thicknessFactor", to_value(1)},
                         {"attenuationDistance", to_value(std::min(1 / most, std::numeric_limits<float>::max()))},
                         {"attenuationColor", to_value(colour)}});
    }
  }
}

void write_emission(const Material& m, tinygltf::Material& to, Document& out) {
  const float strength = std::max(strongest_channel(m.emission), 1.0F);
  to.emissiveFactor = to_numbers(m.emission / strength);
  if (strength > 1) {
    out.add_extension(to.extensions, "KHR_materials_emissive_strength", {{"emissiveStrength", to_value(strength)}});
  }
  write_texture_use(m.emission_texture, to.emissiveTexture);
}

void write_alpha(const Material& m, tinygltf::Material& to) {
  if (m.alpha == Material::Alpha::kOpaque) return;
  to.alphaMode = m.alpha == Material::Alpha::kMask ? "MASK" : "BLEND";
  if (m.alpha == Material::Alpha::kMask) to.alphaCutoff = double{m.alpha_cutoff};
  to.pbrMetallicRoughness.baseColorFactor[3] = double{std::clamp(m.opacity, 0.0F, 1.0F)};
}

bool is_unlit(const Material& m) {
  return !m.casts_light && m.base_colour == glm::vec3(0) && m.mirror == 0 && m.transmission == 0 &&
         !m.metal_rough_texture.is_used();
}

tinygltf::Material material_of(const Scene& scene, const Material& m, Document& out) {
  tinygltf::Material to;
  to.name = m.name;
  tinygltf::PbrMetallicRoughness& pbr = to.pbrMetallicRoughness;
  if (is_unlit(m)) {
    out.add_extension(to.extensions, "KHR_materials_unlit", {});
    to.doubleSided = m.double_sided;
    pbr.baseColorFactor = to_numbers(glm::vec4(glm::clamp(m.emission, 0.0F, 1.0F), 1));
    write_texture_use(m.emission_texture.is_used() ? m.emission_texture : m.base_texture, pbr.baseColorTexture);
    write_alpha(m, to);
    return to;
  }
  const bool tinted = m.mirror > 0 && m.base_texture.is_used();
  const Surface s = surface_of(m, tinted ? mean_colour_of(scene.textures[m.base_texture.texture]) : glm::vec3(1));
  pbr.baseColorFactor = to_numbers(glm::vec4(s.base, 1));
  write_texture_use(m.base_texture, pbr.baseColorTexture);
  write_texture_use(m.metal_rough_texture, pbr.metallicRoughnessTexture);
  write_surface(m, s, to, out);
  to.doubleSided = m.double_sided && !to.extensions.contains("KHR_materials_volume");  // a volume has an outside
  write_emission(m, to, out);
  write_alpha(m, to);
  write_texture_use(m.normal_texture, to.normalTexture);
  to.normalTexture.scale = double{m.normal_scale};
  write_texture_use(m.occlusion_texture, to.occlusionTexture);
  to.occlusionTexture.strength = double{m.occlusion_strength};
  return to;
}

}  // namespace

void write_materials(const Scene& scene, Document& out) {
  for (const Material& m : scene.materials) out.model.materials.push_back(material_of(scene, m, out));
}

}  // namespace traces::gltf_export
