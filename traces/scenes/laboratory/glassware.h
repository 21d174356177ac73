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

// Vessels of the laboratory, in metres, about the y axis and with their bottoms at y = 0.

/// Makes a glass vessel with an outer and an inner surface.
Mesh make_vessel(Vessel vessel, const Detail& detail);

/// Makes the liquid in a vessel up to a height, with a small gap to the glass.
Mesh make_filling(Vessel vessel, float height, const Detail& detail);

}  // namespace traces::laboratory
