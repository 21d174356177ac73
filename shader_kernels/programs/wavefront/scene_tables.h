#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "shader_kernels/kernels/effects.h"
#include "shader_kernels/kernels/reconstruct.h"
#include "shader_kernels/kernels/sampling.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "shader_kernels/records.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/scene.h"

namespace kernels {

CameraUniforms<float> camera_uniforms(const traces::Camera& camera, std::uint32_t width, std::uint32_t height);
/// Returns the ray cones for grid x grid samples per pixel. A cone is as wide as a sample in the middle of the picture.
ConeUniforms<float> cone_uniforms(const CameraUniforms<float>& camera, std::uint32_t samples_per_side);
/// Returns the eye position and viewing direction of a picture, with `depth_scale` units of depth per unit of length.
EyeUniforms<float> eye_uniforms(const CameraUniforms<float>& camera, std::uint32_t width, std::uint32_t height,
                                float depth_scale);
LightUniforms<float> light_uniforms(const traces::Light& light);
/// Returns the linear values of all 256 sRGB codes.
std::vector<SrgbCodeRecord<float>> srgb_code_records();
/// Returns a light source as a disc that faces the surface. `radius` is in scene diagonals; `rays` is the number of
/// rays from a surface.
DiscUniforms<float> disc_uniforms(const traces::Light& light, float radius, float diagonal, std::uint32_t rays);
/// Returns the seed of the jittered sample positions of a frame.
std::uint32_t jitter_seed(std::uint32_t frame);
AxisRecord<float> axis_record(std::uint32_t size, traces::Texture::Wrap wrap, traces::Texture::Filter filter);
/// Returns the parameters with which lookups find the mip level of a texture that has `levels` levels.
LevelRecord<float> level_record(const traces::Texture& texture, std::uint32_t levels, MipFilter mips);

/// A hit of a nearest-hit ray needs a transparency test only if its triangle word (flags in the high bits, index in the
/// low bits) is above this value.
inline constexpr std::uint32_t kSolidNearest = traces::kAlphaFlag - 1;

/// Scene data that kernels do not read from memory: uniforms, and tables in the SRP's own memory. Other members select
/// which kernels the scene needs.
struct SceneTables {
  SceneTables(const traces::MemoryImage& memory_image, const RenderConfig& config);

  const traces::MemoryImage& image;
  std::vector<LightUniforms<float>> lights;
  std::vector<DiscUniforms<float>> discs;  ///< the light sources as discs, if shadows are soft
  std::vector<AxisRecord<float>> axes;     ///< addressing modes of textures, two (u, v) for each one
  std::vector<LevelRecord<float>> levels;  ///< mip parameters, one record per texture; empty without mip maps
  std::vector<SrgbCodeRecord<float>> srgb_codes = srgb_code_records();
  MipFilter mips;  ///< which mip levels lookups read, from the image and RenderConfig::mip_filter
  Vec3<float> background, ambient;
  float epsilon, min_weight, occlusion_distance;
  std::uint32_t depth, layers;
  std::uint32_t width;  ///< number of pixels in a row of the picture
  Effects effects;
  std::uint32_t occlusion_rays;  ///< number of occlusion rays per surface; 0: no ambient occlusion
  std::uint32_t shadow_rays;     ///< number of shadow rays per surface and light; 0: no shadows
  bool has_bounce;               ///< first hits emit a diffuse ray (effect bounce)
  bool is_checkerboard;          ///< effects are traced on a checkerboard (RenderConfig::effect_rate)
  bool has_details;              ///< some surface belongs to a queue that classify_details fills
  bool dma_encodes;              ///< the DMA encodes sRGB (RenderConfig::srgb)
  bool diverges;                 ///< kernels of a material class run over all surfaces (RenderConfig::streams)
  bool fuses;                    ///< fused kernels are used (RenderConfig::fusion)
  bool has_deferred;             ///< some surface must wait for textures before it is lit (kernels/light.h)
  bool has_secondary;            ///< some surface may emit secondary rays
  bool has_textures;             ///< some surface may fail a similarity check because of its textures
  bool has_occlusion;            ///< some surface has an occlusion texture
  bool has_alpha, has_shades;    ///< hits may need a transparency test: of nearest-hit rays, of shadow rays
  std::uint32_t solid_shadow;    ///< largest triangle word of a shadow ray's hit that requires no transparency test
  /// True if ambient light is not occluded and each light casts one shadow ray.
  bool has_plain_lighting() const { return occlusion_rays == 0 && shadow_rays == 1 && discs.empty(); }
  /// Returns the number of light sources, counting ambient light, whose rays may be traced at
  /// only some pixels.
  std::uint32_t low_rate_light_count() const {
    return (occlusion_rays != 0 || has_bounce ? 1 : 0) + static_cast<std::uint32_t>(discs.size());
  }
  /// Returns the number of launches that light a surface from one light source.
  std::uint32_t launches_per_light() const { return std::max(1U, shadow_rays); }
  /// Returns the fraction of a surface's ambient light that one occlusion ray carries.
  float occlusion_share() const { return 1.0F / static_cast<float>(occlusion_rays); }
};

}  // namespace kernels
