#pragma once
#include <cstdint>

#include "hw_models/memory/messages.h"

namespace hw {

/// A ray that a shader core (SRP) sends to the T&I unit. `walk`: the ray's recorded walk through the BVH
/// (traces/walk.h). `id`: the SRP's handle of the ray. `key`: its sort key (traces/ray_key.h).
struct RayJob {
  const std::uint32_t* walk = nullptr;
  std::uint32_t id = 0;
  TileTag tile = kNoTile;
  std::uint32_t key = 0;
  static constexpr std::uint32_t kNoKey = 0xffffffffU;  ///< the work was recorded without sort keys
};

/// A finished ray that the T&I unit returns to the shader core.
struct RayDone {
  std::uint32_t id = 0;
  TileTag tile = kNoTile;
};

/// A leaf of the BVH that a traversal unit sends to the intersection unit.
struct LeafJob {
  std::uint32_t first = 0;   ///< number of the leaf's first triangle
  std::uint32_t phases = 0;  ///< phase with which the test of each triangle ends, encoded as in traces/walk.h
  std::uint8_t count = 0;
  std::uint8_t slot = 0;  ///< slot of the ray in the traversal unit, copied to the answer
  TileTag tile = kNoTile;
};

/// A leaf whose triangles the intersection unit prefetches for a traversal unit.
struct LeafPrefetch {
  std::uint32_t first = 0;  ///< number of the leaf's first triangle
  std::uint8_t count = 0;
  TileTag tile = kNoTile;
};

/// Message from the intersection unit to a traversal unit: all triangles of a leaf have been tested.
struct LeafDone {
  std::uint8_t slot = 0;
};

}  // namespace hw
