#pragma once
#include <array>
#include <cstdint>

#include "traces/scene/scene.h"

namespace traces::laboratory {

/// Indices of the laboratory's materials.
struct Looks {
  std::uint32_t steel, iron, brass, wood, porcelain, plastic, cork, rubber;
  std::uint32_t tiles, floor, plaster, bench, lacquer, shelf, chart, rail, daylight, lamp;
  std::uint32_t page, label, stopper, flame, inner_flame, glass;
  std::uint32_t blue, green, orange, violet, pink, yellow, red, water;  ///< liquids
  std::array<std::uint32_t, 4> bottles;
};

/// Adds all textures and materials.
Looks add_looks(Scene& scene);

}  // namespace traces::laboratory
