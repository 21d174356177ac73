#include "traces/scene/gltf/materials/materials.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "sim/io/printable.h"
#include "traces/scene/gltf/materials/surface.h"
#include "traces/scene/gltf/values.h"

namespace traces::gltf {
namespace {

/// Fills one Material and records how its textures are placed.
class Reader {
 public:
  Reader(Context& context, Textures& textures, const tinygltf::Material& from, std::string what)
      : context_(context), textures_(textures), from_(from), what_(std::move(what)) {}

  Material read() {
    out_.name = sim::printable(from_.name);
    out_.double_sided = from_.doubleSided;
    read_base();
    read_alpha();
    const bool unlit = from_.extensions.contains("KHR_materials_unlit");
    if (unlit) {
      make_unlit();
      return out_;
    }
    set_surface(out_, read_surface(context_, textures_, from_, what_), mean_base_);
    out_.metal_rough_texture = use(from_.pbrMetallicRoughness.metallicRoughnessTexture, false);
    out_.normal_texture = use(from_.normalTexture, false);
    if (out_.normal_texture.used()) {
      out_.normal_scale = to_float(context_, from_.normalTexture.scale, what_ + " normalTexture scale");
    }
    out_.occlusion_texture = use(from_.occlusionTexture, false);
    if (out_.occlusion_texture.used()) {
      out_.occlusion_strength = std::clamp(
          to_float(context_, from_.occlusionTexture.strength, what_ + " occlusionTexture strength"), 0.0F, 1.0F);
    }
    read_emission();
    return out_;
  }

  Placements placements() const { return placements_; }

 private:
  TextureUse use(const auto& info, bool srgb) {
    TextureUse result;
    if (info.index < 0) return result;
    result.texture = textures_.use(info.index, srgb);
    if (!result.used()) return result;
    const TexturePlacement placement = read_placement(context_, info.texCoord, info.extensions);
    result.second_uv = placements_.is_second(context_, placement, fmt::format("{} '{}'", what_, out_.name));
    return result;
  }

  void read_base() {
    const tinygltf::PbrMetallicRoughness& pbr = from_.pbrMetallicRoughness;
    const glm::vec4 base =
        glm::clamp(to_vec4(context_, pbr.baseColorFactor, glm::vec4(1), what_ + " baseColorFactor"), 0.0F, 1.0F);
    out_.base_colour = glm::vec3(base);
    out_.opacity = base.w;
    out_.base_texture = use(pbr.baseColorTexture, true);
    mean_base_ = out_.base_colour;
    if (out_.base_texture.used()) mean_base_ *= glm::vec3(textures_.mean(pbr.baseColorTexture.index, true));
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
    if (emission != glm::vec3(0)) out_.emission_texture = use(from_.emissiveTexture, true);
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
    Reader reader(context, textures, context.model.materials[i], fmt::format("materials[{}]", i));
    context.scene.materials.push_back(reader.read());
    placements.push_back(reader.placements());
  }
  return placements;
}

}  // namespace traces::gltf
