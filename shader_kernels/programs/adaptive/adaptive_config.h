#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "sim/config/field.h"
#include "sim/named.h"

namespace kernels {

/// Where a tile gets its halo samples from: memory, to which the neighbouring tile writes them, or tracing them again.
enum class Halo : std::uint8_t { kReload, kRetrace };
constexpr std::array<std::string_view, 2> names_of(Halo) { return {"reload", "retrace"}; }

/// Where the samples' attributes are kept until they are compared: the tile buffer or DRAM.
enum class AttributeStorage : std::uint8_t { kTile, kDram };
constexpr std::array<std::string_view, 2> names_of(AttributeStorage) { return {"tile", "dram"}; }

/// Configuration keys that all adaptive sampling methods share.
struct AdaptiveConfig {
  Halo halo = Halo::kReload;
  AttributeStorage attributes = AttributeStorage::kTile;

  static void describe(auto& c, auto&& field) {
    field(NAMED(c.halo), "",
          "samples of neighbouring tiles: read from memory after those tiles have written them, or traced again",
          sim::any(), sim::Affects::kFunction);
    field(NAMED(c.attributes), "",
          "where a tile keeps its attributes until their check: in the tile buffer, or in memory", sim::any(),
          sim::Affects::kFunction);
  }
};

/// How a tile's sampling rate follows from its results: not at all, by two thresholds (hysteresis), or by two
/// thresholds that are used in alternate frames.
enum class RateControl : std::uint8_t { kOff, kHysteresis, kAlternate };
constexpr std::array<std::string_view, 3> names_of(RateControl) { return {"off", "hysteresis", "alternate"}; }

/// Multi-rate sampling (Lee et al. 2016). Every key changes the recorded work.
struct MultirateConfig : AdaptiveConfig {
  std::uint32_t block = 2;
  double normal = 0.9;
  double texture = 2;
  bool secondary_checks = true;
  RateControl rate_control = RateControl::kOff;
  double rate_up = 0.95, rate_down = 0.90;
  std::uint32_t rate_hold = 8;
  double rate_texture = 0.1;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.block), "samples", "side of a block; one of its samples is always traced", sim::between(2, 4),
          Affects::kFunction);
    field(NAMED(c.normal), "", "normals are similar if their dot product is at least this; 2: never",
          sim::between(-1, 2), Affects::kFunction);
    field(NAMED(c.texture), "",
          "colours of textured samples are similar up to this distance, sRGB-encoded; 2: not compared",
          sim::between(0, 2), Affects::kFunction);
    field(NAMED(c.secondary_checks), "", "secondary hits are compared too", sim::any(), Affects::kFunction);
    field(NAMED(c.rate_control), "",
          "tiles that were similar in the last frame get blocks of 4: by two thresholds (hysteresis), or by rate_up "
          "and rate_down in alternate frames",
          sim::any(), Affects::kFunction);
    field(NAMED(c.rate_up), "", "share of similar samples from which a tile changes to blocks of 4", sim::between(0, 1),
          Affects::kFunction);
    field(NAMED(c.rate_down), "", "share of similar samples below which a tile returns to blocks of 2",
          sim::between(0, 1), Affects::kFunction);
    field(NAMED(c.rate_hold), "frames", "frames for which the tile then keeps blocks of 2", sim::between(0, 1000),
          Affects::kFunction);
    field(NAMED(c.rate_texture), "",
          "colour distance above which a textured sample that passed does not count as similar for the rate; 2: not "
          "compared",
          sim::between(0, 2), Affects::kFunction);
    AdaptiveConfig::describe(c, field);
  }
  void check(auto&& complain) const {
    if (rate_up < rate_down) complain("rate_up", "is below rate_down; allowed: rate_down or more");
    if (rate_control != RateControl::kOff && block != 2) {
      complain("block", "is not 2, which rate_control needs: it changes between blocks of 2 and of 4");
    }
  }
};

/// Passes of post-correction: none, two (right, down) or four (also left, up).
enum class Correction : std::uint8_t { kOff, kTwo, kFour };
constexpr std::array<std::string_view, 3> names_of(Correction) { return {"off", "two", "four"}; }

enum class Neighbourhood : std::uint8_t { kFour, kEight };
constexpr std::array<std::string_view, 2> names_of(Neighbourhood) { return {"four", "eight"}; }

/// Adaptive undersampling (Kim et al. 2016). Every key changes the recorded work.
struct UndersampleConfig : AdaptiveConfig {
  std::uint32_t block = 2;
  std::uint32_t samples = 1;
  double position = 0.03, normal = 0.9, texture = 0.3, colour = 0.15;
  Correction correction = Correction::kTwo;
  Neighbourhood neighbours = Neighbourhood::kFour;
  bool correct_shadows = false;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.block), "samples", "side of a block; one of its samples is always traced", sim::between(2, 8),
          Affects::kFunction);
    field(NAMED(c.samples), "", "samples per pixel, a square", sim::between(1, 256), Affects::kFunction);
    field(NAMED(c.position), "scene sizes",
          "largest distance of two similar hits, relative to the scene's longest side", sim::between(0, 1000),
          Affects::kFunction);
    field(NAMED(c.normal), "", "normals are similar if their dot product is at least this; 2: never",
          sim::between(-1, 2), Affects::kFunction);
    field(NAMED(c.texture), "", "texture coordinates wrap if one is below this and the other above 1 minus this",
          sim::between(0, 0.5), Affects::kFunction);
    field(NAMED(c.colour), "", "mirrored and refracted colours are similar up to this distance, sRGB-encoded",
          sim::between(0, 2), Affects::kFunction);
    field(NAMED(c.correction), "scans",
          "post-correction: scans that follow objects from traced into interpolated samples", sim::any(),
          Affects::kFunction);
    field(NAMED(c.neighbours), "",
          "neighbours in post-correction; a scan compares a sample with one (four) or three (eight) earlier ones",
          sim::any(), Affects::kFunction);
    field(NAMED(c.correct_shadows), "", "post-correction follows shadows too, not only objects", sim::any(),
          Affects::kFunction);
    AdaptiveConfig::describe(c, field);
  }
  /// Returns the number of samples along the side of a pixel.
  std::uint32_t pixel_grid_side() const { return static_cast<std::uint32_t>(std::lround(std::sqrt(samples))); }
  void check(auto&& complain) const {
    if (pixel_grid_side() * pixel_grid_side() != samples)
      complain("samples", "is not a square; allowed: 1, 4, 9, 16, ... 256");
  }
};

/// How active sub-pixels are listed for the kernels that sample them: block by block, with atomics, or not at all.
enum class Packing : std::uint8_t { kBlock, kAtomic, kNone };
constexpr std::array<std::string_view, 3> names_of(Packing) { return {"block", "atomic", "none"}; }

/// How inactive sub-pixels get their colour: from the pixel's centre, or interpolated between pixel centres.
enum class SubpixelFilter : std::uint8_t { kNearest, kBilinear };
constexpr std::array<std::string_view, 2> names_of(SubpixelFilter) { return {"nearest", "bilinear"}; }

/// Largest number of propagation rounds per frame. Each round is a pass over the whole frame.
inline constexpr std::uint32_t kMostRounds = 14;

/// Keys of selective and adaptive supersampling (Jin et al. 2009). Each attribute that differs between pixels has a
/// contrast threshold: at 0 every sub-pixel at which it differs is sampled, at 1 none, and -1 excludes the attribute
/// from the comparison. Every key changes the recorded work.
struct SupersampleConfig : AdaptiveConfig {
  double colour = 0.6;
  double object = 0.05, normal = 0.06, shadow = 0.06, texture = 0.6;
  double secondary_object = 0.05, secondary_normal = 0.06, secondary_shadow = 0.06, secondary_texture = 0.6;
  double same_normal = 0.9;
  std::uint32_t propagate = 0;
  Packing packing = Packing::kBlock;
  SubpixelFilter filter = SubpixelFilter::kNearest;
  bool focus = false;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    const auto threshold = [&](auto& value, std::string_view name, std::string_view meaning) {
      field(value, name, "", meaning, sim::between(-1, 1), Affects::kFunction);
    };
    threshold(NAMED(c.colour), "contrast from which a sub-pixel is sampled if no attribute differs; -1: never");
    threshold(NAMED(c.object), "contrast threshold if objects differ; 0: always sampled, 1: never, -1: not compared");
    threshold(NAMED(c.normal), "contrast threshold if normals differ; values as for object");
    threshold(NAMED(c.shadow), "contrast threshold if the number of shadows differs; values as for object");
    threshold(NAMED(c.texture), "contrast threshold if the pixel's surface has a texture; values as for object");
    threshold(NAMED(c.secondary_object), "as object, for the secondary hit with the largest weight");
    threshold(NAMED(c.secondary_normal), "as normal, for that secondary hit");
    threshold(NAMED(c.secondary_shadow), "as shadow, for that secondary hit");
    threshold(NAMED(c.secondary_texture), "as texture, for that secondary hit");
    field(NAMED(c.same_normal), "", "normals differ if their dot product is below this", sim::between(-1, 2),
          Affects::kFunction);
    field(NAMED(c.propagate), "rounds",
          "rounds of propagation: each also samples sub-pixels that differ from a neighbour made active by the round "
          "before",
          sim::between(0, kMostRounds), Affects::kFunction);
    field(
        NAMED(c.packing), "",
        "how active sub-pixels are listed: block by block with pixels kept together, each by an atomic, or not at all",
        sim::any(), Affects::kFunction);
    field(NAMED(c.filter), "",
          "colour of sub-pixels that are not sampled: that of their pixel, or interpolated between four pixels",
          sim::any(), Affects::kFunction);
    field(NAMED(c.focus), "", "attributes disagree only where one of two objects is in focus (glTF: extras.focus)",
          sim::any(), Affects::kFunction);
    AdaptiveConfig::describe(c, field);
  }
  void check(auto&& complain) const {
    const auto each = [&](double value, std::string_view name) {
      if (value < 0 && value != -1) complain(name, "lies between -1 and 0; a threshold is 0 to 1, or -1: not compared");
    };
    each(colour, "colour");
    each(object, "object");
    each(normal, "normal");
    each(shadow, "shadow");
    each(texture, "texture");
    each(secondary_object, "secondary_object");
    each(secondary_normal, "secondary_normal");
    each(secondary_shadow, "secondary_shadow");
    each(secondary_texture, "secondary_texture");
  }
};

/// How the filter of the program reconstruct weighs two normals, with x = 1 minus their clamped dot product:
/// exp(-(sigma x)^2) as printed in the paper, or exp(-(x / sigma)^2).
enum class NormalWeight : std::uint8_t { kFactor, kWidth };
constexpr std::array<std::string_view, 2> names_of(NormalWeight) { return {"factor", "width"}; }

/// Keys of subpixel reconstruction antialiasing (Chiu et al. 2012). Every key changes the recorded work.
struct ReconstructConfig : AdaptiveConfig {
  std::uint32_t radius = 1;
  double depth_factor = 10;
  double scene_side = 30;
  double normal_sigma = 0.25;
  NormalWeight normal_weight = NormalWeight::kWidth;
  double colour = -1;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.radius), "pixels",
          "radius of the filter over shaded samples; 0: each pixel shows its own shaded sample", sim::between(0, 2),
          Affects::kFunction);
    field(NAMED(c.depth_factor), "", "factor of the depth difference x in a shaded sample's weight exp(-x^2)",
          sim::between(0, 1000), Affects::kFunction);
    field(NAMED(c.scene_side), "", "longest side of the scene, in units of depth", sim::between(1e-3, 1e6),
          Affects::kFunction);
    field(NAMED(c.normal_sigma), "", "parameter of the weight's dependence on x = 1 - n.n of the normals",
          sim::between(1e-3, 1e3), Affects::kFunction);
    field(NAMED(c.normal_weight), "",
          "normal_sigma is a factor of x, as printed in the paper: exp(-(sigma x)^2), or a width: exp(-(x / sigma)^2)",
          sim::any(), Affects::kFunction);
    field(
        NAMED(c.colour), "",
        "contrast among similar shaded samples from which all four samples of a pixel are shaded; 0: always, -1: never",
        sim::between(-1, 1), Affects::kFunction);
    AdaptiveConfig::describe(c, field);
  }
  /// Returns how many of the filter's depth units are one unit of length, in a scene whose longest side is
  /// `scene_size`.
  float depth_scale(float scene_size) const { return static_cast<float>(depth_factor * scene_side / scene_size); }
  float bend_factor() const {
    return static_cast<float>(normal_weight == NormalWeight::kFactor ? normal_sigma : 1 / normal_sigma);
  }
  void check(auto&& complain) const {
    if (colour < 0 && colour != -1) complain("colour", "lies between -1 and 0; a threshold is 0 to 1, or -1: never");
    if (colour >= 0 && radius == 0) complain("colour", "compares with shaded samples around: radius must be 1 or 2");
  }
};

}  // namespace kernels
