#pragma once
#include <cstdint>

#include "hw_models/memory/messages.h"

namespace hw {

/// A ray on its way into the T&I unit. `id` is the SRP's own handle (its slot in the tile buffer); `walk` the
/// canonical walk (traces/walk.h) that says what the traversal will find.
struct RayJob {
  const std::uint32_t* walk = nullptr;
  std::uint32_t id = 0;
  TileTag owner = kNoTile;
};

/// A finished ray on its way back.
struct RayDone {
  std::uint32_t id = 0;
  TileTag owner = kNoTile;
};

/// A leaf that a traversal unit hands to the intersection unit.
struct LeafJob {
  std::uint32_t first = 0;   ///< first triangle
  std::uint32_t phases = 0;  ///< exit phase of each test, as in walk.h
  std::uint8_t count = 0;
  std::uint8_t slot = 0;  ///< the ray's slot in its traversal unit: also the slot reserved for the answer
  TileTag owner = kNoTile;
};

/// All triangles of a leaf are tested.
struct LeafDone {
  std::uint8_t slot = 0;
};

}  // namespace hw
