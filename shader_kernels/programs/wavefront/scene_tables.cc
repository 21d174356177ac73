#include "shader_kernels/programs/wavefront/scene_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "shader_kernels/kernels/light.h"
#include "sim/hash.h"
#include "traces/accel/build/material_tables.h"
#include "traces/scene/texels.h"

namespace kernels {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Vec3<float> to_vec3(const glm::vec3& v) { return {v.x, v.y, v.z}; }

}  // namespace

CameraUniforms<float> camera_uniforms(const traces::Camera& camera, std::uint32_t width, std::uint32_t height) {
  const glm::vec3 right = glm::normalize(glm::vec3(camera.to_world[0]));
  const glm::vec3 up = glm::normalize(glm::vec3(camera.to_world[1]));
  const glm::vec3 back = glm::normalize(glm::vec3(camera.to_world[2]));
  const float half_height = std::tan(0.5F * camera.vertical_fov);
  const float pixel = 2.0F * half_height / static_cast<float>(height);
  const float half_width = 0.5F * pixel * static_cast<float>(width);
  return {to_vec3(glm::vec3(camera.to_world[3])), to_vec3(up * half_height - right * half_width - back),
          to_vec3(right * pixel), to_vec3(-up * pixel)};
}

ConeUniforms<float> cone_uniforms(const CameraUniforms<float>& camera, std::uint32_t samples_per_side) {
  return {camera.origin, sqrt(dot(camera.down, camera.down)) / static_cast<float>(samples_per_side)};
}

EyeUniforms<float> eye_uniforms(const CameraUniforms<float>& camera, std::uint32_t width, std::uint32_t height,
                                float depth_scale) {
  const Vec3<float> forward = camera.corner + camera.right * (0.5F * static_cast<float>(width)) +
                              camera.down * (0.5F * static_cast<float>(height));
  return {camera.origin, unit_vector(forward) * depth_scale};
}

LightUniforms<float> light_uniforms(const traces::Light& light) {
  using Kind = traces::Light::Kind;
  const bool local = light.kind != Kind::kDirectional;
  LightUniforms<float> u{.position = to_vec3(local ? light.position : -light.direction),
                         .direction = to_vec3(light.direction),
                         .intensity = to_vec3(light.intensity),
                         .local = local ? 1.0F : 0.0F,
                         .reach = local ? 1.0F : kInfinity,
                         .cone_scale = 0,
                         .cone_offset = 1,
                         .inverse_range_squared = 0};
  if (local && light.range > 0) u.inverse_range_squared = 1.0F / (light.range * light.range);
  if (light.kind == Kind::kSpot) {
    u.cone_scale = 1.0F / std::max(0.001F, light.cos_inner - light.cos_outer);
    u.cone_offset = -light.cos_outer * u.cone_scale;
  }
  return u;
}

DiscUniforms<float> disc_uniforms(const traces::Light& light, float radius, float diagonal, std::uint32_t rays) {
  const glm::vec3 axis = glm::normalize(light.direction);
  const glm::vec3 other = std::abs(axis.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 across = glm::normalize(glm::cross(other, axis));
  const float reach = light.kind == traces::Light::Kind::kDirectional ? radius : radius * diagonal;
  return {to_vec3(across * reach), to_vec3(glm::cross(axis, across) * reach), reach, 1.0F / static_cast<float>(rays)};
}

std::uint32_t jitter_seed(std::uint32_t frame) { return static_cast<std::uint32_t>(sim::hash(frame)); }

AxisRecord<float> axis_record(std::uint32_t size, traces::Texture::Wrap wrap, traces::Texture::Filter filter) {
  using Wrap = traces::Texture::Wrap;
  const auto texels = static_cast<float>(size);
  const float last = texels - 1.0F;
  AxisRecord<float> axis{texels, last, -kInfinity, kInfinity, 2.0F, 0.5F, 0.0F, 0.5F};
  switch (wrap) {
    case Wrap::kRepeat:
      axis.period = axis.inverse_period = 1.0F;
      axis.below = last;
      break;
    case Wrap::kMirror:
      break;
    case Wrap::kClamp:
      axis.low = 0.0F;
      axis.high = 1.0F;
      break;
  }
  if (filter == traces::Texture::Filter::kNearest) {
    axis.size = std::nextafter(texels, 0.0F);
    axis.offset = 0.0F;
  }
  return axis;
}

LevelRecord<float> level_record(const traces::Texture& texture, std::uint32_t levels, MipFilter mips) {
  const float texels = static_cast<float>(texture.width) * static_cast<float>(texture.height);
  const auto highest = static_cast<float>(1U << (std::max(levels, 1U) - 1));
  return {std::sqrt(mips == MipFilter::kNearest ? 2 * texels : texels), highest};
}

std::vector<SrgbCodeRecord<float>> srgb_code_records() {
  std::vector<SrgbCodeRecord<float>> records;
  for (int code = 0; code < 256; ++code) {
    records.push_back({static_cast<float>(traces::srgb_to_linear(code / 255.0))});
  }
  return records;
}

SceneTables::SceneTables(const traces::MemoryImage& memory_image, const RenderConfig& config)
    : image(memory_image),
      background(to_vec3(memory_image.background)),
      ambient(to_vec3(memory_image.ambient)),
      epsilon(static_cast<float>(config.ray_epsilon) * memory_image.diagonal()),
      min_weight(static_cast<float>(config.min_weight)),
      occlusion_distance(static_cast<float>(config.occlusion_distance) * memory_image.diagonal()),
      depth(config.depth),
      layers(config.layers),
      width(config.width),
      effects(parse_effects(config.effects)) {
  std::uint32_t flags = 0, shades = 0;
  for (const traces::MaterialRecord& material : image.materials) {
    flags |= material.flags;
    shades |= traces::triangle_flags(material);
  }
  has_details = (flags & traces::kDetailStreams) != 0;
  fuses = config.fusion == Fusion::kOn;
  has_deferred = (flags & kDeferredClasses) != 0;
  const bool reflects = effects.has(Effect::kReflections), refracts = effects.has(Effect::kRefractions);
  has_secondary = (flags & traces::kBlended) != 0 || (refracts && (flags & traces::kGlass) != 0) ||
                  (reflects && (flags & (traces::kMirror | traces::kGlass | traces::kPhysical)) != 0);
  occlusion_rays = effects.has(Effect::kOcclusion) ? config.occlusion_rays : 0;
  has_bounce = effects.has(Effect::kBounce);
  is_checkerboard = config.effect_rate == EffectRate::kCheckerboard;
  const bool is_soft = effects.has(Effect::kSoftShadows);
  shadow_rays = is_soft ? config.shadow_rays : effects.has(Effect::kShadows) ? 1 : 0;
  has_textures = (flags & (traces::kTextured | traces::kOccluded)) != 0;
  has_occlusion = (flags & traces::kOccluded) != 0;
  const bool is_trilinear = config.mip_filter == MipBlend::kLinear;
  mips = !image.has_mip_maps() ? MipFilter::kNone : is_trilinear ? MipFilter::kLinear : MipFilter::kNearest;
  dma_encodes = config.srgb == SrgbEncoder::kDma;
  diverges = config.streams == Streams::kDivergent;
  has_alpha = (shades & traces::kAlphaFlag) != 0;
  const bool is_tinted = config.glass_shadows == GlassShadows::kTinted;
  has_shades = has_alpha || (is_tinted && shades != 0);
  solid_shadow = is_tinted ? traces::kTriangleMask : kSolidNearest;
  for (const traces::Light& light : image.lights) lights.push_back(light_uniforms(light));
  for (const traces::Light& light : image.lights) {
    if (!is_soft) break;
    discs.push_back(disc_uniforms(light, static_cast<float>(config.light_radius), image.diagonal(), shadow_rays));
  }
  for (const traces::Texture& texture : image.textures) {
    axes.push_back(axis_record(texture.width, texture.wrap_u, texture.filter));
    axes.push_back(axis_record(texture.height, texture.wrap_v, texture.filter));
  }
  for (std::size_t i = 0; i < image.mip_levels.size(); ++i) {
    levels.push_back(level_record(image.textures[i], image.mip_levels[i], mips));
  }
}

}  // namespace kernels
