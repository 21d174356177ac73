#include "traces/scene/gltf/materials.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include "sim/io/printable.h"
#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/context.h"
#include "traces/scene/images.h"
#include "traces/scene/texels.h"

namespace traces::gltf {
namespace {

Texture::Wrap wrap_of(int mode) {
  switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return Texture::Wrap::kClamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return Texture::Wrap::kMirror;
    default:
      return Texture::Wrap::kRepeat;
  }
}

}  // namespace

int Textures::source_of(int texture) {
  const tinygltf::Texture& found = context_.at(context_.model.textures, texture, "textures");
  if (found.source < 0)
    context_.add_warning(fmt::format("textures[{}] names no PNG or JPEG image and is left out", texture));
  return found.source;
}

Texture& Textures::decode_image(int index) {
  if (const auto found = images_.find(index); found != images_.end()) return found->second;
  const tinygltf::Image& image = context_.at(context_.model.images, index, "images");
  const std::string name = fmt::format("{}: images[{}]{}{}", context_.file, index, image.name.empty() ? "" : " ",
                                       sim::printable(image.name));
  std::span<const std::byte> bytes;
  if (image.bufferView >= 0) {
    const Bytes view = view_bytes(context_, image.bufferView);
    bytes = std::as_bytes(std::span(view.data, view.size));
  } else {
    bytes = std::as_bytes(std::span(image.image));
  }
  SceneLimits limits = context_.limits;
  limits.pixels = std::min(limits.pixels - pixels_, context_.budget.bytes_left() / (2 * sizeof(std::uint32_t)));
  Texture texture = read_image(bytes, name, limits);
  count_pixels(texture, name);
  context_.budget.take_memory(texture.texels.size(), sizeof(std::uint32_t), name);
  texture.name = sim::printable(image.name);
  return images_.emplace(index, std::move(texture)).first->second;
}

void Textures::count_pixels(const Texture& texture, const std::string& name) {
  if (texture.texels.size() > context_.limits.pixels - pixels_) {
    context_.refuse(
        fmt::format("{}: all images together have more than limits.pixels, {}", name, context_.limits.pixels));
  }
  pixels_ += texture.texels.size();
}

std::uint32_t Textures::find_or_add(int texture, bool srgb) {
  const int source = source_of(texture);
  if (source < 0) return kNoTexture;
  tinygltf::Sampler sampler;
  const int sampler_index = context_.model.textures[static_cast<std::size_t>(texture)].sampler;
  if (sampler_index >= 0) sampler = context_.at(context_.model.samplers, sampler_index, "samplers");
  const bool nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
  const auto [entry, is_new] = added_.try_emplace({source, sampler.wrapS, sampler.wrapT, nearest, srgb},
                                                  static_cast<std::uint32_t>(context_.scene.textures.size()));
  if (is_new) {
    Texture copy = decode_image(source);
    if (!shown_.insert(source).second) count_pixels(copy, copy.name);
    context_.budget.take_memory(copy.texels.size(), sizeof(std::uint32_t), "a texture");
    copy.wrap_u = wrap_of(sampler.wrapS);
    copy.wrap_v = wrap_of(sampler.wrapT);
    copy.filter = nearest ? Texture::Filter::kNearest : Texture::Filter::kLinear;
    copy.srgb = srgb;
    context_.scene.textures.push_back(std::move(copy));
  }
  return entry->second;
}

glm::vec4 Textures::mean_colour_of(int texture, bool srgb) {
  const int source = source_of(texture);
  if (source < 0) return glm::vec4(1);
  const auto [entry, is_new] = means_.try_emplace({source, srgb}, glm::vec4(1));
  if (is_new) {
    decode_image(source).srgb = srgb;
    entry->second = mean_texel(decode_image(source));
  }
  return entry->second;
}

glm::vec2 TexturePlacement::transform_uv(const glm::vec2& uv) const {
  const glm::vec2 scaled = uv * scale;
  const float c = std::cos(rotation), s = std::sin(rotation);
  return offset + glm::vec2(c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y);
}

TexturePlacement read_placement(const Context& context, int set, const tinygltf::ExtensionMap& extensions) {
  TexturePlacement placement;
  placement.set = set;
  const auto* transform = find_extension(extensions, "KHR_texture_transform");
  if (transform == nullptr) return placement;
  const auto pair = [&](const char* key, float absent, int i) {
    if (!transform->Has(key) || !transform->Get(key).IsArray() || transform->Get(key).ArrayLen() != 2) return absent;
    return to_float(context, transform->Get(key).Get(i).GetNumberAsDouble(), key);
  };
  placement.offset = {pair("offset", 0, 0), pair("offset", 0, 1)};
  placement.scale = {pair("scale", 1, 0), pair("scale", 1, 1)};
  placement.rotation = number_or(context, *transform, "rotation", 0);
  if (const int other = index_or_none(*transform, "texCoord"); other >= 0) placement.set = other;
  return placement;
}

bool Placements::uses_second_uv_set(Context& context, const TexturePlacement& placement, const std::string& material) {
  const auto found = std::ranges::find(list_, placement);
  if (found != list_.end()) return found != list_.begin();
  if (list_.size() == 2) {
    context.add_warning(
        fmt::format("{} places its textures in more than two ways; the further ones use the first", material));
    return false;
  }
  list_.push_back(placement);
  return list_.size() == 2;
}

namespace {

/// The numbers of a glTF material and its extensions. Textures of the extensions are replaced by their means.
struct Surface {
  float metallic = 1, roughness = 1;            ///< glTF factors, without textures
  float mean_metallic = 1, mean_roughness = 1;  ///< factors times the mean of their texture
  float ior = 1.5F;
  float specular = 1;  ///< KHR_materials_specular: factor of a dielectric's mirrored light
  float transmission = 0;
  bool thin = false;  ///< KHR_materials_volume with thickness 0: no refraction
  glm::vec3 absorption{0};
  float coat = 0, coat_roughness = 0;
};

float gloss_of(float roughness) { return std::clamp((0.5F - roughness) / 0.4F, 0.0F, 1.0F); }

/// Returns the fraction of light that a dielectric mirrors: twice its reflectance at normal incidence.
float dielectric_share(float ior) {
  const float ratio = (ior - 1) / (ior + 1);
  return std::min(2 * ratio * ratio, 1.0F);
}

float clamp_to_unit(const Context& context, double value, const std::string& what) {
  return std::clamp(to_float(context, value, what), 0.0F, 1.0F);
}

/// One extension of a material, with its factors and the means of their textures.
struct Extension {
  Context& context;
  Textures& textures;
  const tinygltf::Value& object;

  glm::vec4 mean_colour_of(const char* texture, bool srgb) const {
    const int index = object.Has(texture) ? index_or_none(object.Get(texture), "index") : -1;
    return index < 0 ? glm::vec4(1) : textures.mean_colour_of(index, srgb);
  }
  /// Returns a factor of 0 to 1, multiplied with the mean of a channel of its texture.
  float textured_factor(const char* name, float absent, const char* texture, int channel) const {
    const float value = std::clamp(number_or(context, object, name, absent), 0.0F, 1.0F);
    return value > 0 ? value * mean_colour_of(texture, false)[channel] : 0;
  }
};

void read_volume(const Context& context, const tinygltf::Value& volume, Surface& s) {
  constexpr float kDarkest = 1e-6F;  // keeps the logarithm finite
  s.thin = !(number_or(context, volume, "thicknessFactor", 0) > 0);
  const float distance = number_or(context, volume, "attenuationDistance", 0);
  if (s.thin || !(distance > 0)) return;
  const glm::vec3 colour = glm::clamp(vec3_or(context, volume, "attenuationColor", glm::vec3(1)), kDarkest, 1.0F);
  s.absorption = glm::min(-glm::log(colour) / distance, 1e9F);
}

Surface read_surface(Context& context, Textures& textures, const tinygltf::Material& m, const std::string& what) {
  Surface s;
  const tinygltf::PbrMetallicRoughness& pbr = m.pbrMetallicRoughness;
  s.metallic = s.mean_metallic = clamp_to_unit(context, pbr.metallicFactor, what + " metallicFactor");
  s.roughness = s.mean_roughness = clamp_to_unit(context, pbr.roughnessFactor, what + " roughnessFactor");
  if (pbr.metallicRoughnessTexture.index >= 0) {
    const glm::vec4 mean = textures.mean_colour_of(pbr.metallicRoughnessTexture.index, false);
    s.mean_roughness *= mean.y;
    s.mean_metallic *= mean.z;
  }
  if (const auto* ior = find_extension(m.extensions, "KHR_materials_ior")) {
    s.ior = std::clamp(number_or(context, *ior, "ior", 1.5F), 1.0F, 10.0F);
  }
  if (const auto* object = find_extension(m.extensions, "KHR_materials_transmission")) {
    const Extension glass{context, textures, *object};
    s.transmission = glass.textured_factor("transmissionFactor", 0, "transmissionTexture", 0);
  }
  if (const auto* volume = find_extension(m.extensions, "KHR_materials_volume")) read_volume(context, *volume, s);
  if (const auto* object = find_extension(m.extensions, "KHR_materials_specular")) {
    const Extension specular{context, textures, *object};
    const glm::vec3 colour = glm::max(vec3_or(context, *object, "specularColorFactor", glm::vec3(1)), 0.0F) *
                             glm::vec3(specular.mean_colour_of("specularColorTexture", true));
    s.specular =
        specular.textured_factor("specularFactor", 1, "specularTexture", 3) * (colour.x + colour.y + colour.z) / 3;
  }
  if (const auto* object = find_extension(m.extensions, "KHR_materials_clearcoat")) {
    const Extension coat{context, textures, *object};
    s.coat = coat.textured_factor("clearcoatFactor", 0, "clearcoatTexture", 0);
    s.coat_roughness = coat.textured_factor("clearcoatRoughnessFactor", 0, "clearcoatRoughnessTexture", 1);
  }
  return s;
}

/// Sets the mirror, transmission and absorption of `out` by the rule of materials.h. `mean_base` is its base colour
/// times the mean of its texture.
void set_surface(Material& out, const Surface& s, const glm::vec3& mean_base) {
  constexpr float kLeast = 0.02F;
  const bool bends = s.transmission > 0 && !s.thin;
  out.metallic = s.metallic;
  out.roughness = s.roughness;
  out.dielectric = bends ? 0 : std::min(dielectric_share(s.ior) * s.specular, 1.0F);
  out.coat = s.coat * gloss_of(s.coat_roughness) * dielectric_share(1.5F);
  out.facet_mirror = s.metallic * mean_base + (1 - s.metallic) * 0.5F * out.dielectric;
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

/// Converts one glTF material, and records the placements of its textures.
class MaterialReader {
 public:
  MaterialReader(Context& context, Textures& textures, const tinygltf::Material& from, std::string what)
      : context_(context), textures_(textures), from_(from), what_(std::move(what)) {}

  Material read_material() {
    out_.name = sim::printable(from_.name);
    out_.double_sided = from_.doubleSided;
    read_base_colour();
    read_alpha();
    const bool unlit = from_.extensions.contains("KHR_materials_unlit");
    if (unlit) {
      make_unlit();
      return out_;
    }
    set_surface(out_, read_surface(context_, textures_, from_, what_), mean_base_);
    out_.metal_rough_texture = use_texture(from_.pbrMetallicRoughness.metallicRoughnessTexture, false);
    out_.normal_texture = use_texture(from_.normalTexture, false);
    if (out_.normal_texture.is_used()) {
      out_.normal_scale = to_float(context_, from_.normalTexture.scale, what_ + " normalTexture scale");
    }
    out_.occlusion_texture = use_texture(from_.occlusionTexture, false);
    if (out_.occlusion_texture.is_used()) {
      out_.occlusion_strength = std::clamp(
          to_float(context_, from_.occlusionTexture.strength, what_ + " occlusionTexture strength"), 0.0F, 1.0F);
    }
    read_emission();
    return out_;
  }

  Placements texture_placements() const { return placements_; }

 private:
  TextureUse use_texture(const auto& info, bool srgb) {
    TextureUse result;
    if (info.index < 0) return result;
    result.texture = textures_.find_or_add(info.index, srgb);
    if (!result.is_used()) return result;
    const TexturePlacement placement = read_placement(context_, info.texCoord, info.extensions);
    result.second_uv = placements_.uses_second_uv_set(context_, placement, fmt::format("{} '{}'", what_, out_.name));
    return result;
  }

  void read_base_colour() {
    const tinygltf::PbrMetallicRoughness& pbr = from_.pbrMetallicRoughness;
    const glm::vec4 base =
        glm::clamp(to_vec4(context_, pbr.baseColorFactor, glm::vec4(1), what_ + " baseColorFactor"), 0.0F, 1.0F);
    out_.base_colour = glm::vec3(base);
    out_.opacity = base.w;
    out_.base_texture = use_texture(pbr.baseColorTexture, true);
    mean_base_ = out_.base_colour;
    if (out_.base_texture.is_used())
      mean_base_ *= glm::vec3(textures_.mean_colour_of(pbr.baseColorTexture.index, true));
  }

  void read_alpha() {
    if (from_.alphaMode == "BLEND") {
      out_.alpha = Material::Alpha::kBlend;
    } else if (from_.alphaMode == "MASK") {
      out_.alpha = Material::Alpha::kMask;
      out_.alpha_cutoff = std::max(to_float(context_, from_.alphaCutoff, what_ + " alphaCutoff"), 0.0F);
    } else {
      out_.opacity = 1;
    }
  }

  void make_unlit() {
    out_.emission = out_.base_colour;
    out_.emission_texture = out_.base_texture;
    out_.casts_light = false;
    out_.base_colour = glm::vec3(0);
    out_.dielectric = 0;
    if (out_.alpha == Material::Alpha::kOpaque) out_.base_texture = {};  // otherwise its alpha is still used
  }

  void read_emission() {
    glm::vec3 emission =
        glm::clamp(to_vec3(context_, from_.emissiveFactor, glm::vec3(0), what_ + " emissiveFactor"), 0.0F, 1.0F);
    if (const auto* strength = find_extension(from_.extensions, "KHR_materials_emissive_strength")) {
      emission *= std::clamp(number_or(context_, *strength, "emissiveStrength", 1), 0.0F, 1e9F);
    }
    out_.emission = emission;
    if (emission != glm::vec3(0)) out_.emission_texture = use_texture(from_.emissiveTexture, true);
  }

  Context& context_;
  Textures& textures_;
  const tinygltf::Material& from_;
  std::string what_;
  Material out_;
  glm::vec3 mean_base_{1};
  Placements placements_;
};

}  // namespace

std::vector<Placements> read_materials(Context& context, Textures& textures) {
  std::vector<Placements> placements;
  for (std::size_t i = 0; i < context.model.materials.size(); ++i) {
    MaterialReader reader(context, textures, context.model.materials[i], fmt::format("materials[{}]", i));
    context.scene.materials.push_back(reader.read_material());
    placements.push_back(reader.texture_placements());
  }
  return placements;
}

}  // namespace traces::gltf
