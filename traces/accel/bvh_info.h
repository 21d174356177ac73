#pragma once
#include <cstdint>
#include <string>

#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// Size and quality of a scene's BVH.
struct BvhInfo {
  std::uint64_t nodes = 0;  ///< number of inner nodes of all trees
  std::uint64_t leaves = 0;
  std::uint32_t depth = 0;  ///< number of inner nodes on the longest path through the BVH, over both levels
  double sah_cost = 0;      ///< expected cost of a random line through the scene (surface area heuristic)
  std::uint64_t bytes = 0;  ///< bytes of nodes, instances and triangles in memory
};

BvhInfo bvh_info(const MemoryImage& image, const BvhConfig& config = {});

/// Returns the SHA-256 of the data that traversal reads: nodes, triangles and hybrid grid. The layout is not included.
std::string bvh_hash(const MemoryImage& image);

}  // namespace traces
