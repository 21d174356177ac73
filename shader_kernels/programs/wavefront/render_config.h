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
enum class Effect : std::uint8_t { kShadows, kReflections, kRefractions, kOcclusion, kSoftShadows, kCount };
constexpr std::array<std::string_view, static_cast<std::size_t>(Effect::kCount)> names_of(Effect) {
  return {"shadows", "reflections", "refractions", "occlusion", "soft_shadows"};
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
    field(NAMED(c.depth), "rays", "longest path from the eye: 1 is primary rays (and their shadow rays) alone",
          sim::between(1, 16), Affects::kFunction);
    field(NAMED(c.samples), "",
          "where a pixel's samples lie: in the middle of grid cells, anywhere in them, or each alone in its row and "
          "column "
          "of a rotated grid; a lone one is in the middle",
          sim::any(), Affects::kFunction);
    field(NAMED(c.layers), "surfaces",
          "how many holes, blended surfaces or panes of glass a ray may pass; the next one counts as solid",
          sim::between(0, 1024), Affects::kFunction);
    field(NAMED(c.glass_shadows), "",
          "shadow rays that meet glass: blocked, or let through unbent with its transmission and colour", sim::any(),
          Affects::kFunction);
    field(
        NAMED(c.mip_maps), "",
        "textures in memory with mip levels, from which a lookup takes the level that fits the ray's cone, or as they "
        "come",
        sim::any(), Affects::kFunction);
    field(NAMED(c.mip_filter), "",
          "a look-up takes the mip level nearest to the cone's footprint, or blends the two about it (trilinear)",
          sim::any(), Affects::kFunction);
    field(NAMED(c.srgb), "",
          "finished pixels are sRGB-encoded and packed by a kernel, or by a table in the DMA as they leave the tile "
          "buffer",
          sim::any(), Affects::kFunction);
    field(NAMED(c.streams), "",
          "executors run over the items of their class, compacted by an inspector, or (as without inspectors) over all",
          sim::any(), Affects::kFunction);
    field(
        NAMED(c.fusion), "",
        "kernels that follow each other on the same items: launched one by one, or as one loop that keeps in registers "
        "what they leave for each other",
        sim::any(), Affects::kFunction);
    field(NAMED(c.primary), "",
          "what samples see first is found by rays, or by a rasteriser that looks at all triangles before; the picture "
          "is the same",
          sim::any(), Affects::kFunction);
    field.group(NAMED(c.raster), "pieces of a rasteriser's work");
    describe_effects(c, field);
    field(NAMED(c.ray_epsilon), "scene diagonals", "how far from a surface its secondary rays begin",
          sim::between(0, 0.1), Affects::kFunction);
    field(NAMED(c.min_weight), "", "a path goes on while its largest colour weight is above this", sim::between(0, 1),
          Affects::kFunction);
  }
  static void describe_effects(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.effects), "",
          "what rays are traced for behind what samples see first, between commas, or none: shadows, reflections, "
          "refractions, occlusion (of ambient light), soft_shadows (in place of shadows)",
          sim::any(), Affects::kFunction);
    field(
        NAMED(c.effect_rate), "",
        "pixels whose first hits have rays for occlusion and soft_shadows: all, one of 2 x 2, or every other one; the "
        "others take what those around have found, by depth and normal",
        sim::any(), Affects::kFunction);
    field(NAMED(c.occlusion_rays), "rays", "of each diffuse surface, with the effect occlusion", sim::between(1, 64),
          Affects::kFunction);
    field(NAMED(c.occlusion_distance), "scene diagonals", "how far away a surface occludes ambient light",
          sim::between(0, 10), Affects::kFunction);
    field(NAMED(c.shadow_rays), "rays", "of each diffuse surface and light, with the effect soft_shadows",
          sim::between(1, 64), Affects::kFunction);
    field(NAMED(c.light_radius), "scene diagonals",
          "radius of every light's disc, with the effect soft_shadows; directional lights are a diagonal away",
          sim::between(0, 1), Affects::kFunction);
  }
  /// True if the frame has effects that can have a lower rate.
  bool has_low_rate_effects() const {
    const Effects all = parse_effects(effects);
    return all.has(Effect::kOcclusion) || all.has(Effect::kSoftShadows);
  }
  void check(auto&& complain) const {
    try {
      parse_effects(effects);
    } catch (const sim::InputError& error) {
      return complain("effects", error.what());
    }
    if (effect_rate != EffectRate::kFull && !has_low_rate_effects()) {
      complain("effect_rate",
               "is that of occlusion and soft_shadows, and effects has neither; allowed: full, or one of these in "
               "effects");
    }
  }
};

}  // namespace kernels
