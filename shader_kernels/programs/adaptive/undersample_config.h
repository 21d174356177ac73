#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "sim/named.h"

namespace kernels {

/// Scans of post-correction: none, to the right and downwards, or also back.
enum class Correction : std::uint8_t { kOff, kTwo, kFour };
constexpr std::array<std::string_view, 3> names_of(Correction) { return {"off", "two", "four"}; }

enum class Neighbourhood : std::uint8_t { kFour, kEight };
constexpr std::array<std::string_view, 2> names_of(Neighbourhood) { return {"four", "eight"}; }

/// Adaptive undersampling (Kim et al. 2016). All of it changes the recorded work.
struct UndersampleConfig : AdaptiveConfig {
  std::uint32_t block = 2;
  std::uint32_t samples = 1;
  double position = 0.03, normal = 0.9, texture = 0.3, colour = 0.15;
  Correction correction = Correction::kTwo;
  Neighbourhood neighbours = Neighbourhood::kFour;
  bool correct_shadows = false;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.block), "samples", "side of a block, of which one sample is always traced", sim::between(2, 8),
          Affects::kFunction);
    field(NAMED(c.samples), "", "samples per pixel, a square", sim::between(1, 256), Affects::kFunction);
    field(NAMED(c.position), "scene sizes",
          "hits are near each other up to this distance; the scene's longest side counts as 1", sim::between(0, 1000),
          Affects::kFunction);
    field(NAMED(c.normal), "", "normals are similar if their dot product is at least this; 2: never",
          sim::between(-1, 2), Affects::kFunction);
    field(NAMED(c.texture), "", "texture coordinates wrap if one is below this and the other above 1 less this",
          sim::between(0, 0.5), Affects::kFunction);
    field(NAMED(c.colour), "", "mirrored and refracted colours are similar up to this distance, sRGB-encoded",
          sim::between(0, 2), Affects::kFunction);
    field(NAMED(c.correction), "scans", "post-correction: scans that follow what was found by chance", sim::any(),
          Affects::kFunction);
    field(NAMED(c.neighbours), "", "of those that a scan looks back at: one, or three", sim::any(), Affects::kFunction);
    field(NAMED(c.correct_shadows), "", "post-correction follows shadows too, not only objects", sim::any(),
          Affects::kFunction);
    AdaptiveConfig::describe(c, field);
  }
  /// Samples along a pixel.
  std::uint32_t grid() const { return static_cast<std::uint32_t>(std::lround(std::sqrt(samples))); }
  void check(auto&& complain) const {
    if (grid() * grid() != samples) complain("samples", "is not a square; allowed: 1, 4, 9, 16, ... 256");
  }
};

}  // namespace kernels
