#include "traces/scene/gltf/materials/surface.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include "traces/scene/gltf/values.h"

namespace traces::gltf {
namespace {

float gloss_of(float roughness) { return std::clamp((0.5F - roughness) / 0.4F, 0.0F, 1.0F); }

/// Returns twice the reflectance at normal incidence.
float dielectric_share(float ior) {
  const float ratio = (ior - 1) / (ior + 1);
  return std::min(2 * ratio * ratio, 1.0F);
}

float unit(const Context& context, double value, const std::string& what) {
  return std::clamp(to_float(context, value, what), 0.0F, 1.0F);
}

/// A material's extension with its factors and the means of their textures.
struct Extension {
  Context& context;
  Textures& textures;
  const tinygltf::Value& object;

  glm::vec4 mean(const char* texture, bool srgb) const {
    const int index = object.Has(texture) ? index_or_none(object.Get(texture), "index") : -1;
    return index < 0 ? glm::vec4(1) : textures.mean(index, srgb);
  }
  /// Returns a factor of 0 to 1 times the mean of a channel of its texture.
  float factor(const char* name, float absent, const char* texture, int channel) const {
    const float value = std::clamp(number_or(context, object, name, absent), 0.0F, 1.0F);
    return value > 0 ? value * mean(texture, false)[channel] : 0;
  }
};

void read_volume(const Context& context, const tinygltf::Value& volume, Surface& s) {
  constexpr float kDarkest = 1e-6F;  // avoids the logarithm of 0
  s.thin = !(number_or(context, volume, "thicknessFactor", 0) > 0);
  const float distance = number_or(context, volume, "attenuationDistance", 0);
  if (s.thin || !(distance > 0)) return;
  const glm::vec3 colour = glm::clamp(vec3_or(context, volume, "attenuationColor", glm::vec3(1)), kDarkest, 1.0F);
  s.absorption = glm::min(-glm::log(colour) / distance, 1e9F);
}

}  // namespace

Surface read_surface(Context& context, Textures& textures, const tinygltf::Material& m, const std::string& what) {
  Surface s;
  const tinygltf::PbrMetallicRoughness& pbr = m.pbrMetallicRoughness;
  s.metallic = s.mean_metallic = unit(context, pbr.metallicFactor, what + " metallicFactor");
  s.roughness = s.mean_roughness = unit(context, pbr.roughnessFactor, what + " roughnessFactor");
  if (pbr.metallicRoughnessTexture.index >= 0) {
    const glm::vec4 mean = textures.mean(pbr.metallicRoughnessTexture.index, false);
    s.mean_roughness *= mean.y;
    s.mean_metallic *= mean.z;
  }
  if (const auto* ior = find_extension(m.extensions, "KHR_materials_ior")) {
    s.ior = std::clamp(number_or(context, *ior, "ior", 1.5F), 1.0F, 10.0F);
  }
  if (const auto* object = find_extension(m.extensions, "KHR_materials_transmission")) {
    const Extension glass{context, textures, *object};
    s.transmission = glass.factor("transmissionFactor", 0, "transmissionTexture", 0);
  }
  if (const auto* volume = find_extension(m.extensions, "KHR_materials_volume")) read_volume(context, *volume, s);
  if (const auto* object = find_extension(m.extensions, "KHR_materials_specular")) {
    const Extension specular{context, textures, *object};
    const glm::vec3 colour = glm::max(vec3_or(context, *object, "specularColorFactor", glm::vec3(1)), 0.0F) *
                             glm::vec3(specular.mean("specularColorTexture", true));
    s.specular = specular.factor("specularFactor", 1, "specularTexture", 3) * (colour.x + colour.y + colour.z) / 3;
  }
  if (const auto* object = find_extension(m.extensions, "KHR_materials_clearcoat")) {
    const Extension coat{context, textures, *object};
    s.coat = coat.factor("clearcoatFactor", 0, "clearcoatTexture", 0);
    s.coat_roughness = coat.factor("clearcoatRoughnessFactor", 0, "clearcoatRoughnessTexture", 1);
  }
  return s;
}

void set_surface(Material& out, const Surface& s, const glm::vec3& mean_base) {
  constexpr float kLeast = 0.02F;
  const bool bends = s.transmission > 0 && !s.thin;
  out.metallic = s.metallic;
  out.roughness = s.roughness;
  out.dielectric = bends ? 0 : std::min(dielectric_share(s.ior) * s.specular, 1.0F);
  out.coat = s.coat * gloss_of(s.coat_roughness) * dielectric_share(1.5F);
  out.transmission = s.transmission;
  out.ior = s.transmission > 0 && s.thin ? 1 : s.ior;
  out.absorption = s.absorption;

  const float gloss = gloss_of(s.mean_roughness);
  const float metal = gloss * s.mean_metallic;
  float white = gloss * (1 - s.mean_metallic) * out.dielectric;
  white += (1 - metal - white) * out.coat;
  out.mirror = std::min(metal + white, 1.0F);
  if (out.mirror < kLeast) out.mirror = 0;
  if (out.mirror > 0) out.mirror_tint = (metal * mean_base + white * glm::vec3(1)) / (metal + white);
}

}  // namespace traces::gltf
