#pragma once
#include <cstdint>

#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::laboratory {

enum class Vessel : std::uint8_t {
  kBeaker,
  kErlenmeyer,
  kRound,
  kTestTube,
  kBurette,
  kCylinder,
  kVolumetric,
  kBottle,
  kDish
};

// In metres, standing on y = 0 about the y axis.

/// Glass with an outer and an inner surface.
Mesh make_vessel(Vessel vessel, const Detail& detail);

/// Liquid up to that height, a little away from the glass.
Mesh make_filling(Vessel vessel, float height, const Detail& detail);

}  // namespace traces::laboratory
