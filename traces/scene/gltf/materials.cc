#include "traces/scene/gltf/materials.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "sim/io/printable.h"
#include "traces/scene/gltf/values.h"

namespace traces::gltf {
namespace {

float gloss_of(float roughness) { return std::clamp((0.5F - roughness) / 0.4F, 0.0F, 1.0F); }

/// Twice the reflectance at normal incidence.
float dielectric_share(float ior) {
  const float ratio = (ior - 1) / (ior + 1);
  return std::min(2 * ratio * ratio, 1.0F);
}

float unit(const Context& context, double value, const std::string& what) {
  return std::clamp(to_float(context, value, what), 0.0F, 1.0F);
}

/// The numbers of a glTF material, textures folded in by their mean.
struct Surface {
  float metallic = 1, roughness = 1;
  float ior = 1.5F;
  float transmission = 0;
  float coat = 0, coat_roughness = 0;
};

Surface read_surface(Context& context, Textures& textures, const tinygltf::Material& m, const std::string& what) {
  Surface s;
  const tinygltf::PbrMetallicRoughness& pbr = m.pbrMetallicRoughness;
  s.metallic = unit(context, pbr.metallicFactor, what + " metallicFactor");
  s.roughness = unit(context, pbr.roughnessFactor, what + " roughnessFactor");
  if (pbr.metallicRoughnessTexture.index >= 0) {
    const glm::vec4 mean = textures.mean(pbr.metallicRoughnessTexture.index, false);
    s.roughness *= mean.y;
    s.metallic *= mean.z;
  }
  if (const auto* ior = find_extension(m.extensions, "KHR_materials_ior")) {
    s.ior = std::clamp(number_or(context, *ior, "ior", 1.5F), 1.0F, 10.0F);
  }
  if (const auto* glass = find_extension(m.extensions, "KHR_materials_transmission")) {
    s.transmission = std::clamp(number_or(context, *glass, "transmissionFactor", 0), 0.0F, 1.0F);
    const int texture =
        glass->Has("transmissionTexture") ? index_or_none(glass->Get("transmissionTexture"), "index") : -1;
    if (texture >= 0) s.transmission *= textures.mean(texture, false).x;
  }
  if (const auto* coat = find_extension(m.extensions, "KHR_materials_clearcoat")) {
    s.coat = std::clamp(number_or(context, *coat, "clearcoatFactor", 0), 0.0F, 1.0F);
    s.coat_roughness = std::clamp(number_or(context, *coat, "clearcoatRoughnessFactor", 0), 0.0F, 1.0F);
  }
  return s;
}

void set_mirror(Material& out, const Surface& s, const glm::vec3& mean_base) {
  constexpr float kLeast = 0.02F;
  const float gloss = gloss_of(s.roughness);
  const float metal = gloss * s.metallic;
  float white = s.transmission > 0 ? 0 : gloss * (1 - s.metallic) * dielectric_share(s.ior);
  white += (1 - metal - white) * s.coat * gloss_of(s.coat_roughness) * dielectric_share(1.5F);
  out.mirror = std::min(metal + white, 1.0F);
  if (out.mirror < kLeast) out.mirror = 0;
  if (out.mirror > 0) out.mirror_tint = (metal * mean_base + white * glm::vec3(1)) / (metal + white);
}

glm::vec3 read_emission(Context& context, Textures& textures, const tinygltf::Material& m, const std::string& what) {
  glm::vec3 emission = glm::max(to_vec3(context, m.emissiveFactor, glm::vec3(0), what + " emissiveFactor"), 0.0F);
  if (const auto* strength = find_extension(m.extensions, "KHR_materials_emissive_strength")) {
    emission *= std::clamp(number_or(context, *strength, "emissiveStrength", 1), 0.0F, 1e9F);
  }
  if (m.emissiveTexture.index >= 0 && emission != glm::vec3(0)) {
    emission *= glm::vec3(textures.mean(m.emissiveTexture.index, true));
  }
  return emission;
}

TexturePlacement read_placement(const Context& context, const tinygltf::TextureInfo& info) {
  TexturePlacement placement;
  placement.set = info.texCoord;
  const auto* transform = find_extension(info.extensions, "KHR_texture_transform");
  if (transform == nullptr) return placement;
  const auto pair = [&](const char* key, float absent, int i) {
    if (!transform->Has(key) || !transform->Get(key).IsArray() || transform->Get(key).ArrayLen() != 2) return absent;
    return to_float(context, transform->Get(key).Get(i).GetNumberAsDouble(), key);
  };
  placement.offset = {pair("offset", 0, 0), pair("offset", 0, 1)};
  placement.scale = {pair("scale", 1, 0), pair("scale", 1, 1)};
  placement.rotation = number_or(context, *transform, "rotation", 0);
  if (const int set = index_or_none(*transform, "texCoord"); set >= 0) placement.set = set;
  return placement;
}

}  // namespace

glm::vec2 TexturePlacement::apply(const glm::vec2& uv) const {
  const glm::vec2 scaled = uv * scale;
  const float c = std::cos(rotation), s = std::sin(rotation);
  return offset + glm::vec2(c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y);
}

std::vector<TexturePlacement> read_materials(Context& context, Textures& textures) {
  std::vector<TexturePlacement> placements;
  for (std::size_t i = 0; i < context.model.materials.size(); ++i) {
    const tinygltf::Material& m = context.model.materials[i];
    const std::string what = fmt::format("materials[{}]", i);
    const tinygltf::TextureInfo& texture = m.pbrMetallicRoughness.baseColorTexture;
    const glm::vec4 base = glm::clamp(
        to_vec4(context, m.pbrMetallicRoughness.baseColorFactor, glm::vec4(1), what + " baseColorFactor"), 0.0F, 1.0F);
    Surface surface = read_surface(context, textures, m, what);
    glm::vec4 mean_base = base;
    Material out;
    out.name = sim::printable(m.name);
    out.base_colour = glm::vec3(base);
    if (texture.index >= 0) {
      out.base_texture.texture = textures.base_colour(texture.index);
      mean_base *= textures.mean(texture.index, true);
    }
    if (m.alphaMode == "BLEND" && mean_base.w < 1 && surface.transmission <= 0) {
      surface.transmission = 1 - mean_base.w;
      surface.ior = 1;
    } else if (m.alphaMode == "MASK") {
      context.warn(fmt::format("{} '{}': cut-outs (alphaMode MASK) are shown solid", what, out.name));
    }
    out.transmission = surface.transmission;
    out.ior = surface.ior;
    set_mirror(out, surface, glm::vec3(mean_base));
    out.emission = read_emission(context, textures, m, what);
    context.scene.materials.push_back(out);
    placements.push_back(read_placement(context, texture));
  }
  return placements;
}

}  // namespace traces::gltf
