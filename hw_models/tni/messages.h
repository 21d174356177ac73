#pragma once
#include <cstdint>

#include "hw_models/memory/messages.h"

namespace hw {

/// A ray sent to the T&I unit. `id` is the SRP's handle of the ray, `walk` its recorded walk (traces/walk.h).
struct RayJob {
  const std::uint32_t* walk = nullptr;
  std::uint32_t id = 0;
  TileTag tile = kNoTile;
};

/// A finished ray returned to the SRP.
struct RayDone {
  std::uint32_t id = 0;
  TileTag tile = kNoTile;
};

/// A leaf that a traversal unit sends to the intersection unit.
struct LeafJob {
  std::uint32_t first = 0;   ///< first triangle
  std::uint32_t phases = 0;  ///< exit phase of each triangle's test (traces/walk.h)
  std::uint8_t count = 0;
  std::uint8_t slot = 0;  ///< the ray's slot in its traversal unit, which the answer returns
  TileTag tile = kNoTile;
};

/// The intersection unit's answer: all triangles of a leaf have been tested.
struct LeafDone {
  std::uint8_t slot = 0;
};

}  // namespace hw
