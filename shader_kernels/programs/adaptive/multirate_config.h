#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "sim/named.h"

namespace kernels {

/// Decides over a tile's rate.
enum class RateControl : std::uint8_t { kOff, kHysteresis, kAlternate };
constexpr std::array<std::string_view, 3> names_of(RateControl) { return {"off", "hysteresis", "alternate"}; }

/// Multi-rate sampling (Lee et al. 2016). All of it changes the recorded work.
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
    field(NAMED(c.block), "samples", "side of a block, of which one sample is always traced", sim::between(2, 4),
          Affects::kFunction);
    field(NAMED(c.normal), "", "normals are similar if their dot product is at least this; 2: never",
          sim::between(-1, 2), Affects::kFunction);
    field(NAMED(c.texture), "",
          "colours of textured samples are similar up to this distance, sRGB-encoded; 2: not compared",
          sim::between(0, 2), Affects::kFunction);
    field(NAMED(c.secondary_checks), "", "secondary hits are compared too", sim::any(), Affects::kFunction);
    field(NAMED(c.rate_control), "",
          "blocks of 4 where a tile's last frame was similar: both thresholds at once, or one each frame in turn",
          sim::any(), Affects::kFunction);
    field(NAMED(c.rate_up), "", "share of similar samples from which a tile goes over to blocks of 4",
          sim::between(0, 1), Affects::kFunction);
    field(NAMED(c.rate_down), "", "share of similar samples below which it goes back", sim::between(0, 1),
          Affects::kFunction);
    field(NAMED(c.rate_hold), "frames", "how long it then stays there", sim::between(0, 1000), Affects::kFunction);
    field(NAMED(c.rate_texture), "",
          "for the rate alone, textured samples are similar up to this distance of colours; 2: not compared",
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

}  // namespace kernels
