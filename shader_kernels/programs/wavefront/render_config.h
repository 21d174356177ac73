#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "sim/config/field.h"
#include "sim/error.h"
#include "sim/named.h"
#include "traces/accel/memory_image.h"
#include "traces/raster/raster_config.h"

namespace kernels {

/// Light effects for which surfaces emit rays (docs/design/effects.md).
enum class Effect : std::uint8_t { kShadows, kReflections, kRefractions, kOcclusion, kSoftShadows, kBounce, kCount };
constexpr std::array<std::string_view, static_cast<std::size_t>(Effect::kCount)> names_of(Effect) {
  return {"shadows", "reflections", "refractions", "occlusion", "soft_shadows", "bounce"};
}

class Effects {
 public:
  bool has(Effect effect) const { return (bits_ >> static_cast<std::uint32_t>(effect) & 1U) != 0; }
  void add(Effect effect) { bits_ |= 1U << static_cast<std::uint32_t>(effect); }

 private:
  std::uint32_t bits_ = 0;
};

/// Parses a list of effects such as "shadows, occlusion", or "none". Throws sim::InputError with the allowed effects.
Effects parse_effects(std::string_view text);

/// How primary hits are found: by rays, or by a rasteriser (docs/design/rasteriser.md).
enum class Primary : std::uint8_t { kRays, kRaster };
constexpr std::array<std::string_view, 2> names_of(Primary) { return {"rays", "raster"}; }

enum class SamplePattern : std::uint8_t { kRegular, kJittered, kRotated };
constexpr std::array<std::string_view, 3> names_of(SamplePattern) { return {"regular", "jittered", "rotated"}; }

enum class GlassShadows : std::uint8_t { kOpaque, kTinted };
constexpr std::array<std::string_view, 2> names_of(GlassShadows) { return {"opaque", "tinted"}; }

enum class Streams : std::uint8_t { kCompacted, kDivergent };
constexpr std::array<std::string_view, 2> names_of(Streams) { return {"compacted", "divergent"}; }

/// Mip levels that a texture lookup reads: the nearest one, or a blend of the two nearest.
enum class MipBlend : std::uint8_t { kNearest, kLinear };
constexpr std::array<std::string_view, 2> names_of(MipBlend) { return {"nearest", "linear"}; }

/// What encodes pixels as sRGB: a kernel, or the DMA during the transfer to the frame buffer.
enum class SrgbEncoder : std::uint8_t { kKernel, kDma };
constexpr std::array<std::string_view, 2> names_of(SrgbEncoder) { return {"kernel", "dma"}; }

/// Which pixels' first hits emit rays for occlusion and soft shadows: all, one of 2 x 2, or every other one.
enum class EffectRate : std::uint8_t { kFull, kHalf, kCheckerboard };
constexpr std::array<std::string_view, 3> names_of(EffectRate) { return {"full", "half", "checkerboard"}; }

/// Reflections of rough surfaces: a smooth mirror's that fades with roughness, or those of GGX microfacets.
enum class RoughReflections : std::uint8_t { kMirror, kGgx };
constexpr std::array<std::string_view, 2> names_of(RoughReflections) { return {"mirror", "ggx"}; }

enum class Fusion : std::uint8_t { kOff, kOn };
constexpr std::array<std::string_view, 2> names_of(Fusion) { return {"off", "on"}; }

/// Configuration keys of the picture and its rendering. All of them change the recorded work.
struct RenderConfig {
  std::uint32_t width = 1024, height = 512;
  std::uint32_t tile = 16;
  std::uint32_t depth = 3;
  SamplePattern samples = SamplePattern::kRegular;
  std::uint32_t layers = 32;
  GlassShadows glass_shadows = GlassShadows::kTinted;
  traces::MipMaps mip_maps = traces::MipMaps::kOn;
  MipBlend mip_filter = MipBlend::kNearest;
  SrgbEncoder srgb = SrgbEncoder::kKernel;
  Streams streams = Streams::kCompacted;
  Fusion fusion = Fusion::kOn;
  Primary primary = Primary::kRays;
  traces::RasterConfig raster;
  std::string effects = "shadows, reflections, refractions";
  EffectRate effect_rate = EffectRate::kFull;
  RoughReflections rough_reflections = RoughReflections::kMirror;
  std::uint32_t occlusion_rays = 4;
  double occlusion_distance = 0.1;
  std::uint32_t shadow_rays = 4;
  double light_radius = 0.01;
  double ray_epsilon = 1e-4;
  double min_weight = 0.01;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.width), "pixels", "width of the picture", sim::between(1, 16384), Affects::kFunction);
    field(NAMED(c.height), "pixels", "height of the picture", sim::between(1, 16384), Affects::kFunction);
    field(NAMED(c.tile), "samples", "side of a tile: 16 means 16 x 16 samples", sim::between(1, 128),
          Affects::kFunction);
    field(NAMED(c.depth), "rays", "most rays in a path from the eye, shadow rays not counted; 1: primary rays only",
          sim::between(1, 16), Affects::kFunction);
    field(NAMED(c.samples), "",
          "positions of a pixel's samples: in the middle of grid cells, at random in them, or on a rotated grid with "
          "one sample per row and column; a single sample is in the middle",
          sim::any(), Affects::kFunction);
    field(NAMED(c.layers), "surfaces",
          "most holes, blended surfaces or panes of glass that a ray passes; the next one counts as solid",
          sim::between(0, 1024), Affects::kFunction);
    field(NAMED(c.glass_shadows), "",
          "shadow rays at glass: blocked, or passed unbent, multiplied by its transmission and colour", sim::any(),
          Affects::kFunction);
    field(NAMED(c.mip_maps), "", "on: textures have mip levels, and a look-up reads the level that fits the ray's cone",
          sim::any(), Affects::kFunction);
    field(NAMED(c.mip_filter), "",
          "a look-up reads the mip level nearest to the cone's footprint, or blends the two nearest (trilinear)",
          sim::any(), Affects::kFunction);
    field(NAMED(c.srgb), "",
          "finished pixels are sRGB-encoded and packed by a kernel, or by a table in the DMA during the transfer",
          sim::any(), Affects::kFunction);
    field(NAMED(c.streams), "",
          "executors run over the items of their class, compacted by an inspector, or (divergent) over all items",
          sim::any(), Affects::kFunction);
    field(NAMED(c.fusion), "",
          "on: successive kernels on the same items run as one loop and pass values in registers; off: they are "
          "launched one by one",
          sim::any(), Affects::kFunction);
    field(NAMED(c.primary), "", "primary hits are found by rays, or by a rasteriser; the picture is the same",
          sim::any(), Affects::kFunction);
    field.group(NAMED(c.raster), "units of a rasteriser's work");
    describe_effects(c, field);
    field(NAMED(c.ray_epsilon), "scene diagonals", "distance from a surface at which its secondary rays begin",
          sim::between(0, 0.1), Affects::kFunction);
    field(NAMED(c.min_weight), "", "a path continues while its largest colour weight is above this", sim::between(0, 1),
          Affects::kFunction);
  }
  static void describe_effects(auto& c, auto&& field) {
    using sim::Affects;
    field(
        NAMED(c.effects), "",
        "effects for which rays are traced after the first hit, separated by commas, or none: shadows, reflections, "
        "refractions, occlusion (of ambient light), soft_shadows (instead of shadows), bounce (a diffuse ray from the "
        "first hit, instead of ambient light)",
        sim::any(), Affects::kFunction);
    field(NAMED(c.effect_rate), "",
          "pixels whose first hits emit rays for occlusion, soft_shadows and bounce: all, one of 2 x 2, or every other "
          "one; a "
          "filter by depth and normal supplies the others",
          sim::any(), Affects::kFunction);
    field(NAMED(c.rough_reflections), "",
          "reflections of rough glTF surfaces: a smooth mirror's, which fade with roughness, or one ray by the GGX "
          "distribution",
          sim::any(), Affects::kFunction);
    field(NAMED(c.occlusion_rays), "rays", "occlusion rays per diffuse surface", sim::between(1, 64),
          Affects::kFunction);
    field(NAMED(c.occlusion_distance), "scene diagonals", "distance up to which a surface occludes ambient light",
          sim::between(0, 10), Affects::kFunction);
    field(NAMED(c.shadow_rays), "rays", "rays per diffuse surface and light, with the effect soft_shadows",
          sim::between(1, 64), Affects::kFunction);
    field(NAMED(c.light_radius), "scene diagonals",
          "radius of every light's disc, with the effect soft_shadows; directional lights are one scene diagonal away",
          sim::between(0, 1), Affects::kFunction);
  }
  /// True if the frame has occlusion, soft shadows or a bounce, the effects whose rays may be traced at only some
  /// pixels.
  bool has_low_rate_effects() const {
    const Effects all = parse_effects(effects);
    return all.has(Effect::kOcclusion) || all.has(Effect::kSoftShadows) || all.has(Effect::kBounce);
  }
  traces::Roughness roughness() const {
    return rough_reflections == RoughReflections::kGgx ? traces::Roughness::kOn : traces::Roughness::kOff;
  }
  void check(auto&& complain) const {
    try {
      parse_effects(effects);
    } catch (const sim::InputError& error) {
      return complain("effects", error.what());
    }
    const Effects all = parse_effects(effects);
    if (all.has(Effect::kBounce)) {
      if (all.has(Effect::kOcclusion)) complain("effects", "has bounce and occlusion; allowed: one of them");
      if (effect_rate == EffectRate::kFull) {
        complain("effect_rate", "is full, and effects has bounce; allowed: half, checkerboard, or the program path:N");
      }
      if (depth < 2) complain("depth", "is 1, and effects has bounce; allowed: 2 or more");
    }
    if (effect_rate != EffectRate::kFull && !has_low_rate_effects()) {
      complain("effect_rate",
               "is that of occlusion, soft_shadows and bounce, and effects has none; allowed: full, or one of these in "
               "effects");
    }
  }
};

}  // namespace kernels
