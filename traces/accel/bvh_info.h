#pragma once
#include <cstdint>
#include <string>
#include <vector>

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
  std::uint64_t children = 0, slots = 0;  ///< children of all nodes, and how many would fit
  std::uint64_t leaf_triangles = 0;       ///< triangles of all leaves
  double mean_children() const { return ratio(children, nodes); }
  double occupancy() const { return ratio(children, slots); }  ///< share of slots with a child
  double triangles_per_leaf() const { return ratio(leaf_triangles, leaves); }
  double bytes_per_triangle() const { return ratio(bytes, leaf_triangles); }

 private:
  static double ratio(std::uint64_t a, std::uint64_t b) {
    return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b);
  }
};

BvhInfo bvh_info(const MemoryImage& image, const BvhConfig& config = {});

/// Returns BvhInfo::bytes_per_triangle() without a pass over the nodes.
double bytes_per_triangle(const MemoryImage& image);

/// Returns the SAH cost of each tree, in the order of MemoryImage::build_statistics. The cost of a tree over instances
/// includes the trees below.
std::vector<double> tree_costs(const MemoryImage& image, const BvhConfig& config = {});

/// Returns the factor by which the cost of each tree has grown since its build. Both arguments are results of
/// tree_costs(): after the build and after the last refit. A tree of cost 0, for example of one flat box, grows by 1.
std::vector<double> cost_growth(const std::vector<double>& built, const std::vector<double>& refitted);

/// Returns the SHA-256 of the data that traversal reads: nodes, triangles and hybrid grid. The layout is not included.
std::string bvh_hash(const MemoryImage& image);

}  // namespace traces
