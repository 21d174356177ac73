#pragma once
#include <cstdint>
#include <vector>

namespace traces {

/// Sizes of a binary tree as its builder made it, before it is collapsed into a wide tree.
struct BuildStatistics {
  std::uint32_t triangles = 0;    ///< items of the tree: triangles, or instances of a tree over instances
  std::uint32_t leaves = 0;       ///< leaves after small subtrees were merged into leaves
  std::uint32_t inner_nodes = 0;  ///< inner nodes above these leaves; at least 1
  /// Clusters at the start of each round of bvh.builder: ploc. Empty for other builders and for a single item.
  std::vector<std::uint32_t> ploc_clusters;
};

}  // namespace traces
