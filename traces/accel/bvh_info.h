#pragma once
#include <cstdint>
#include <string>

#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// Statistics of a tree.
struct BvhInfo {
  std::uint64_t nodes = 0;  ///< inner nodes, of all trees
  std::uint64_t leaves = 0;
  std::uint32_t depth = 0;  ///< inner nodes on the longest way down, into instances too
  double sah_cost = 0;      ///< expected cost of a random line through the scene
  std::uint64_t bytes = 0;  ///< nodes, instances and triangles
};

BvhInfo bvh_info(const MemoryImage& image, const BvhConfig& config = {});

/// SHA-256 of what the traversal reads: nodes, triangles and, in hybrid numbers, the grid; where and how all that lies
/// in memory has no part in it.
std::string bvh_hash(const MemoryImage& image);

}  // namespace traces
