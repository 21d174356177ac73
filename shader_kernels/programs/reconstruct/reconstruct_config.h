#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "sim/named.h"

namespace kernels {

/// Readings of the weight of normals, x = 1 - sat(n.n): exp(-(sigma x)^2) as printed, or exp(-(x / sigma)^2).
enum class NormalWeight : std::uint8_t { kFactor, kWidth };
constexpr std::array<std::string_view, 2> names_of(NormalWeight) { return {"factor", "width"}; }

/// Subpixel reconstruction antialiasing for ray tracing (Chiu et al. 2012). All of it changes the recorded work.
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
          "how far shaded samples lie that a sample's colour is made of; 0: each pixel shows its own, and no other is "
          "looked at",
          sim::between(0, 2), Affects::kFunction);
    field(NAMED(c.depth_factor), "",
          "a shaded sample's weight falls with the difference of depths, times this: exp(-x^2)", sim::between(0, 1000),
          Affects::kFunction);
    field(NAMED(c.scene_side), "", "longest side of the scene, in units of depth", sim::between(1e-3, 1e6),
          Affects::kFunction);
    field(NAMED(c.normal_sigma), "", "how it falls with x = 1 - n.n of normals", sim::between(1e-3, 1e3),
          Affects::kFunction);
    field(NAMED(c.normal_weight), "",
          "normal_sigma is a factor of x, as printed: exp(-(sigma x)^2), or its width: exp(-(x / sigma)^2)", sim::any(),
          Affects::kFunction);
    field(NAMED(c.colour), "",
          "contrast of shaded samples that are alike from which on a pixel has all four of its samples shaded, as "
          "supersample.colour; 0: always, -1: never",
          sim::between(-1, 1), Affects::kFunction);
    AdaptiveConfig::describe(c, field);
  }
  /// Depth of a length, in units of the filter.
  float depth_scale(float scene_size) const { return static_cast<float>(depth_factor * scene_side / scene_size); }
  float bend() const {
    return static_cast<float>(normal_weight == NormalWeight::kFactor ? normal_sigma : 1 / normal_sigma);
  }
  void check(auto&& complain) const {
    if (colour < 0 && colour != -1) complain("colour", "lies between -1 and 0; a threshold is 0 to 1, or -1: never");
    if (colour >= 0 && radius == 0) complain("colour", "compares with shaded samples around: radius must be 1 or 2");
  }
};

}  // namespace kernels
