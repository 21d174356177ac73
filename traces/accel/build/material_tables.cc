#include "traces/accel/build/material_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "sim/error.h"
#include "traces/scene/texels.h"

namespace traces {
namespace {

void check_material(const Material& m, const std::vector<Texture>& textures) {
  const auto check_use = [&](const TextureUse& use, const char* what, bool srgb) {
    if (!use.is_used()) return;
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

bool emits_light(const Material& m) { return std::max({m.emission.x, m.emission.y, m.emission.z}) > 0; }

/// Returns the flags of a material except kVertexed, which also depends on the meshes.
std::uint32_t material_flags(const Material& m, const MaterialRecord& record) {
  const bool physical = m.metal_rough_texture.is_used();
  const bool has_alpha = m.alpha != Material::Alpha::kOpaque;
  const glm::vec3 diffuse = m.base_colour * record.diffuse_share;
  const bool is_diffuse = std::max({diffuse.x, diffuse.y, diffuse.z}) > 0;
  const bool is_glass = record.entering > 0;
  const bool base = m.base_texture.is_used() && (is_diffuse || physical || has_alpha || is_glass);
  const bool based = base && (physical || is_glass || m.base_texture.second_uv || m.alpha == Material::Alpha::kBlend);
  const glm::vec3 mirrored = record.mirrored;
  std::uint32_t flags = 0;
  const auto set = [&](bool on, std::uint32_t bit) { flags |= on ? bit : 0; };
  set(base && !based && is_diffuse, kTextured);
  set(based, kBased);
  set(is_diffuse && !physical, kDiffuse);
  set(std::max({mirrored.x, mirrored.y, mirrored.z, record.entering}) > 0, kMirror);
  set(is_glass, kGlass);
  set(emits_light(m) && !m.emission_texture.is_used(), kEmissive);
  set(emits_light(m) && m.emission_texture.is_used(), kGlowing);
  set(physical, kPhysical);
  set(m.normal_texture.is_used() && m.normal_scale != 0, kBumped);
  set(m.occlusion_texture.is_used() && m.occlusion_strength > 0 && (is_diffuse || physical), kOccluded);
  set(m.absorption != glm::vec3(0), kAbsorbing);
  set(m.alpha == Material::Alpha::kBlend, kBlended);
  set(m.alpha == Material::Alpha::kMask, kMasked);
  set(!m.double_sided && m.transmission == 0, kSingleSided);
  set(m.base_texture.is_used() && m.base_texture.second_uv, kBaseSecond);
  set(physical && m.metal_rough_texture.second_uv, kMetalRoughSecond);
  set(m.normal_texture.is_used() && m.normal_texture.second_uv, kNormalSecond);
  set(m.occlusion_texture.is_used() && m.occlusion_texture.second_uv, kOcclusionSecond);
  set(m.emission_texture.is_used() && m.emission_texture.second_uv, kEmissionSecond);
  constexpr std::uint32_t kSecond =
      kBaseSecond | kMetalRoughSecond | kNormalSecond | kOcclusionSecond | kEmissionSecond;
  set((flags & (kBumped | kSecond)) != 0, kVertexed);
  return flags;
}

/// Returns the roughness bits of a material: 0 for smooth mirrors, for glass and for scenes that ignore roughness.
std::uint32_t roughness_bits(const Material& m, Roughness roughness) {
  const bool is_smooth = m.roughness < kLeastRoughness || m.transmission > 0;
  if (roughness == Roughness::kOff || !m.facet_mirror || is_smooth) return 0;
  return static_cast<std::uint32_t>(std::lround(m.roughness * 255)) << kRoughnessShift;
}

MaterialRecord material_record(const Material& m, Roughness roughness) {
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
  if (m.metal_rough_texture.is_used()) {
    record.diffuse_share = 1;
    record.mirrored = glm::vec3(0);
    record.entering = m.transmission;
  }
  const std::uint32_t rough = m.metal_rough_texture.is_used() ? 0 : roughness_bits(m, roughness);
  if (rough != 0) {
    record.mirrored = *m.facet_mirror;
    record.diffuse_share = (1 - m.metallic) * (1 - 0.5F * m.dielectric);
  }
  record.flags = material_flags(m, record) | rough;
  return record;
}

MaterialDetailRecord detail_record(const Material& m) {
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

MaterialTables material_tables(const Scene& scene, bool has_mip_maps, Roughness roughness) {
  std::vector<Material> materials = scene.materials;
  if (materials.empty()) materials.emplace_back();
  MaterialTables tables;
  tables.needs_density = has_mip_maps;
  for (const Material& m : materials) {
    check_material(m, scene.textures);
    tables.records.push_back(material_record(m, roughness));
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
  if (has_details) std::ranges::transform(materials, std::back_inserter(tables.details), detail_record);
  return tables;
}

namespace {

constexpr std::size_t kChannels = 4;

/// A texel of four linear channels, R first; 65535 encodes 1.
using WideTexel = std::array<std::uint16_t, kChannels>;
struct WideTexture {
  std::uint32_t width = 0, height = 0;
  std::vector<WideTexel> texels;
};

/// Converts the codes of an 8-bit texture channel to linear values and back.
class Encoding {
 public:
  explicit Encoding(bool srgb) {
    for (std::size_t code = 0; code < values_.size(); ++code) {
      const double stored = static_cast<double>(code) / 255;
      values_[code] = static_cast<std::uint16_t>(std::lround(65535 * (srgb ? srgb_to_linear(stored) : stored)));
    }
  }
  std::uint16_t linear_value(std::uint32_t code) const { return values_[code]; }
  /// Returns the 8-bit code whose linear value is nearest to `value`.
  std::uint32_t nearest_code(std::uint16_t value) const {
    const auto above = std::ranges::lower_bound(values_, value);
    const bool is_below = above != values_.begin() && value - *(above - 1) < *above - value;
    return static_cast<std::uint32_t>(above - values_.begin()) - (is_below ? 1U : 0U);
  }

 private:
  std::array<std::uint16_t, 256> values_{};
};

/// The range of texels along one axis that a texel of the next mip level covers, and their weights.
struct Cover {
  std::uint32_t first = 0;
  std::array<std::uint64_t, 3> weights{};
  std::uint64_t weight_sum() const { return weights[0] + weights[1] + weights[2]; }
};
Cover texel_cover(std::uint32_t size, std::uint32_t i) {
  if (size == 1) return {0, {1, 0, 0}};
  const std::uint32_t half = size / 2;
  if (size % 2 == 0) return {2 * i, {1, 1, 0}};
  return {2 * i, {half - i, half, i + 1}};
}

/// Returns the next mip level of a texture, whose texel (x, y) is `at(x, y)`.
WideTexture halve_texture(std::uint32_t width, std::uint32_t height, auto&& at) {
  WideTexture half{std::max(1U, width / 2), std::max(1U, height / 2), {}};
  half.texels.reserve(std::size_t{half.width} * half.height);
  for (std::uint32_t y = 0; y < half.height; ++y) {
    const Cover rows = texel_cover(height, y);
    for (std::uint32_t x = 0; x < half.width; ++x) {
      const Cover columns = texel_cover(width, x);
      std::array<std::uint64_t, kChannels> sums{};
      for (std::uint32_t j = 0; j < 3; ++j) {
        for (std::uint32_t i = 0; i < 3; ++i) {
          const std::uint64_t weight = rows.weights[j] * columns.weights[i];
          if (weight == 0) continue;
          const WideTexel texel = at(columns.first + i, rows.first + j);
          for (std::size_t k = 0; k < kChannels; ++k) sums[k] += weight * texel[k];
        }
      }
      const std::uint64_t all = rows.weight_sum() * columns.weight_sum();
      WideTexel& mean = half.texels.emplace_back();
      for (std::size_t k = 0; k < kChannels; ++k) mean[k] = static_cast<std::uint16_t>((sums[k] + all / 2) / all);
    }
  }
  return half;
}

/// How a texture encodes its colour channels and its alpha channel.
struct Encodings {
  explicit Encodings(bool srgb) : colour(srgb), alpha(false) {}
  const Encoding& channel_encoding(std::size_t channel) const { return channel < 3 ? colour : alpha; }
  WideTexel decode_texels(std::uint32_t texel) const {
    WideTexel wide;
    for (std::size_t k = 0; k < kChannels; ++k) wide[k] = channel_encoding(k).linear_value((texel >> (8 * k)) & 255U);
    return wide;
  }
  std::uint32_t encode_texels(const WideTexel& wide) const {
    std::uint32_t texel = 0;
    for (std::size_t k = 0; k < kChannels; ++k) texel |= channel_encoding(k).nearest_code(wide[k]) << (8 * k);
    return texel;
  }
  Encoding colour, alpha;
};

}  // namespace

std::vector<Texture> mip_chain(const Texture& texture) {
  static const Encodings kSrgb(true), kLinear(false);
  const Encodings& encodings = texture.srgb ? kSrgb : kLinear;
  std::vector<Texture> chain{texture};
  WideTexture wide;
  while (chain.back().width > 1 || chain.back().height > 1) {
    const Texture& above = chain.back();
    const auto first = [&](std::uint32_t x, std::uint32_t y) {
      return encodings.decode_texels(above.texels[std::size_t{y} * above.width + x]);
    };
    const auto later = [&](std::uint32_t x, std::uint32_t y) { return wide.texels[std::size_t{y} * wide.width + x]; };
    wide = chain.size() == 1 ? halve_texture(above.width, above.height, first)
                             : halve_texture(above.width, above.height, later);
    Texture level{.name = texture.name,
                  .width = wide.width,
                  .height = wide.height,
                  .texels = {},
                  .srgb = texture.srgb,
                  .wrap_u = texture.wrap_u,
                  .wrap_v = texture.wrap_v,
                  .filter = texture.filter};
    level.texels.reserve(wide.texels.size());
    for (const WideTexel& texel : wide.texels) level.texels.push_back(encodings.encode_texels(texel));
    chain.push_back(std::move(level));
  }
  return chain;
}

namespace {

/// Replaces each texture of an image by its mip levels.
void compute_mip_levels(MemoryImage& image) {
  std::vector<Texture> levels;
  for (const Texture& texture : image.textures) {
    std::vector<Texture> chain = mip_chain(texture);
    image.mip_levels.resize(levels.size() + chain.size(), 0);
    image.mip_levels[levels.size()] = static_cast<std::uint32_t>(chain.size());
    std::ranges::move(chain, std::back_inserter(levels));
  }
  if (levels.size() > kMostMipLevels) {
    throw sim::InputError("the scene's textures have " + std::to_string(levels.size()) + " mip levels; at most " +
                          std::to_string(kMostMipLevels) + " are allowed with render.mip_maps: on");
  }
  image.textures = std::move(levels);
}

/// Returns, for each texture, the index of its first mip level among the levels of all textures.
std::vector<std::uint32_t> first_levels(const MemoryImage& image) {
  std::vector<std::uint32_t> first;
  for (std::uint32_t at = 0; at < image.mip_levels.size(); at += image.mip_levels[at]) first.push_back(at);
  return first;
}

}  // namespace

void add_mip_levels(MaterialTables& materials, MemoryImage& image, MemoryImage* earlier) {
  if (earlier != nullptr && first_levels(*earlier).size() == image.textures.size()) {
    image.textures = std::move(earlier->textures);
    image.mip_levels = std::move(earlier->mip_levels);
  } else {
    compute_mip_levels(image);
  }
  const std::vector<std::uint32_t> first = first_levels(image);
  const auto rename = [&](std::uint32_t& texture) {
    if (texture != kNoTexture) texture = first[texture];
  };
  rename(image.white);
  for (MaterialRecord& record : materials.records) rename(record.base_texture);
  for (MaterialDetailRecord& detail : materials.details) {
    rename(detail.normal_texture);
    rename(detail.occlusion_texture);
    rename(detail.metal_rough_texture);
    rename(detail.emission_texture);
  }
}

}  // namespace traces
