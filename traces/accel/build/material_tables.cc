#include "traces/accel/build/material_tables.h"

#include <algorithm>
#include <string>

#include "sim/error.h"

namespace traces {
namespace {

void check(const Material& m, const std::vector<Texture>& textures) {
  const auto check_use = [&](const TextureUse& use, const char* what, bool srgb) {
    if (!use.used()) return;
    const auto refuse = [&](const std::string& why) {
      throw sim::InputError("material '" + m.name + "': its " + what + " texture " + why);
    };
    if (use.texture >= textures.size()) refuse("is not there");
    if (textures[use.texture].srgb != srgb) refuse(srgb ? "must be sRGB-encoded" : "must be linear");
  };
  check_use(m.base_texture, "base", true);
  check_use(m.emission_texture, "emission", true);
  check_use(m.metal_rough_texture, "metallic-roughness", false);
  check_use(m.normal_texture, "normal", false);
  check_use(m.occlusion_texture, "occlusion", false);
}

bool shines(const Material& m) { return std::max({m.emission.x, m.emission.y, m.emission.z}) > 0; }

/// Returns all flags except kVertexed, which also depends on the meshes.
std::uint32_t flags_of(const Material& m, const MaterialRecord& record) {
  const bool physical = m.metal_rough_texture.used();
  const bool has_alpha = m.alpha != Material::Alpha::kOpaque;
  const glm::vec3 diffuse = m.base_colour * record.diffuse_share;
  const bool is_diffuse = std::max({diffuse.x, diffuse.y, diffuse.z}) > 0;
  const bool is_glass = record.entering > 0;
  const bool base = m.base_texture.used() && (is_diffuse || physical || has_alpha || is_glass);
  const bool based = base && (physical || is_glass || m.base_texture.second_uv || m.alpha == Material::Alpha::kBlend);
  const glm::vec3 mirrored = record.mirrored;
  std::uint32_t flags = 0;
  const auto set = [&](bool on, std::uint32_t bit) { flags |= on ? bit : 0; };
  set(base && !based && is_diffuse, kTextured);
  set(based, kBased);
  set(is_diffuse && !physical, kDiffuse);
  set(std::max({mirrored.x, mirrored.y, mirrored.z, record.entering}) > 0, kMirror);
  set(is_glass, kGlass);
  set(shines(m) && !m.emission_texture.used(), kEmissive);
  set(shines(m) && m.emission_texture.used(), kGlowing);
  set(physical, kPhysical);
  set(m.normal_texture.used() && m.normal_scale != 0, kBumped);
  set(m.occlusion_texture.used() && m.occlusion_strength > 0 && (is_diffuse || physical), kOccluded);
  set(m.absorption != glm::vec3(0), kAbsorbing);
  set(m.alpha == Material::Alpha::kBlend, kBlended);
  set(m.alpha == Material::Alpha::kMask, kMasked);
  set(!m.double_sided && m.transmission == 0, kSingleSided);
  set(m.base_texture.used() && m.base_texture.second_uv, kBaseSecond);
  set(physical && m.metal_rough_texture.second_uv, kMetalRoughSecond);
  set(m.normal_texture.used() && m.normal_texture.second_uv, kNormalSecond);
  set(m.occlusion_texture.used() && m.occlusion_texture.second_uv, kOcclusionSecond);
  set(m.emission_texture.used() && m.emission_texture.second_uv, kEmissionSecond);
  constexpr std::uint32_t kSecond =
      kBaseSecond | kMetalRoughSecond | kNormalSecond | kOcclusionSecond | kEmissionSecond;
  set((flags & (kBumped | kSecond)) != 0, kVertexed);
  return flags;
}

MaterialRecord record_of(const Material& m) {
  const bool has_alpha = m.alpha != Material::Alpha::kOpaque;
  MaterialRecord record{.base_colour = m.base_colour,
                        .diffuse_share = (1 - m.mirror) * (1 - m.transmission),
                        .mirrored = m.mirror_tint * m.mirror,
                        .entering = (1 - m.mirror) * m.transmission,
                        .emission = m.emission,
                        .ior = m.ior,
                        .base_texture = m.base_texture.texture,
                        .flags = 0,
                        .opacity = has_alpha ? m.opacity : 1,
                        .alpha_cutoff = m.alpha == Material::Alpha::kMask ? m.alpha_cutoff : 0};
  if (m.metal_rough_texture.used()) {
    record.diffuse_share = 1;
    record.mirrored = glm::vec3(0);
    record.entering = m.transmission;
  }
  record.flags = flags_of(m, record);
  return record;
}

MaterialDetailRecord detail_of(const Material& m) {
  return {.emission = m.emission,
          .normal_texture = m.normal_texture.texture,
          .absorption = m.absorption,
          .occlusion_texture = m.occlusion_texture.texture,
          .metal_rough_texture = m.metal_rough_texture.texture,
          .emission_texture = m.emission_texture.texture,
          .normal_scale = m.normal_scale,
          .occlusion_strength = m.occlusion_strength,
          .metallic = m.metallic,
          .roughness = m.roughness,
          .dielectric = m.dielectric,
          .coat = m.coat};
}

}  // namespace

std::uint32_t triangle_flags(const MaterialRecord& material) {
  const bool has_alpha = (material.flags & (kBlended | kMasked)) != 0;
  return (has_alpha ? kAlphaFlag : 0) | (material.entering > 0 ? kTintFlag : 0);
}

MaterialTables material_tables(const Scene& scene, bool has_mip_maps) {
  std::vector<Material> materials = scene.materials;
  if (materials.empty()) materials.emplace_back();
  MaterialTables tables;
  tables.needs_density = has_mip_maps;
  for (const Material& m : materials) {
    check(m, scene.textures);
    tables.records.push_back(record_of(m));
  }
  for (const Mesh& mesh : scene.meshes) {
    if (!mesh.colours.empty() && mesh.material < materials.size()) tables.records[mesh.material].flags |= kVertexed;
  }
  constexpr std::uint32_t kDetailed = kPhysical | kBumped | kAbsorbing | kGlowing | kOccluded;
  bool has_details = false;
  for (const MaterialRecord& record : tables.records) {
    has_details |= (record.flags & kDetailed) != 0;
    tables.needs_vertices |= (record.flags & kVertexed) != 0;
    tables.needs_white |= triangle_flags(record) != 0 && record.base_texture == kNoTexture;
  }
  if (has_details) std::ranges::transform(materials, std::back_inserter(tables.details), detail_of);
  return tables;
}

}  // namespace traces
