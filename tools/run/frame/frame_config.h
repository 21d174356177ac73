#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "sim/config/field.h"
#include "sim/named.h"

namespace tools {

/// State of the caches at the start of a frame.
enum class FrameStart : std::uint8_t {
  kCold,  ///< caches are empty
  kWarm,  ///< caches are as the previous frame left them
};
constexpr std::array<std::string_view, 2> names_of(FrameStart) { return {"cold", "warm"}; }

/// Settings of a frame as part of a sequence: start state of the caches, and target frame rate.
struct FrameConfig {
  FrameStart start = FrameStart::kCold;
  double fps = 0;

  static void describe(auto& c, auto&& field) {
    field(NAMED(c.start), "", "caches at the start of a frame: empty, or as the previous frame left them", sim::any(),
          sim::Affects::kTiming);
    field(NAMED(c.fps), "frames/s", "target frame rate of power_at_fps_w and fps_margin; 0: none",
          sim::between(0, 100000), sim::Affects::kEnergy);
  }
};

}  // namespace tools
