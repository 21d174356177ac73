#pragma once
#include <cstdint>
#include <vector>

#include "traces/accel/build/bvh_build.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// A wide tree in its final order: each node's inner children are consecutive, and so are the subtrees below them.
struct WideBvh {
  std::vector<WideNode> nodes;
  std::vector<std::uint32_t> order;  ///< input indices of the triangles or boxes, in leaf order
};

/// Collapses a binary tree into one with up to `config.width` children per node.
///
/// 1. Collapse::kArea begins with the root. While a node has room, its inner child of largest surface area (the first
///    of equal ones) is replaced by its two children, which take its place in the slots. Leaves stay as they are.
/// 2. Collapse::kSah minimises the expected cost of the tree over all choices of children (dynamic programme over
///    subtree and number of slots, Ylitie 2017). A subtree of at most `most_merged` triangles may become one leaf.
/// 3. Planes are copied exactly; rounding follows later (round_boxes_to_grid, quantise_nodes).
/// 4. With NodeFormat::kCw80 children are in octant slots, otherwise they fill the first slots.
WideBvh collapse_tree(const FlatBvh& binary, const BvhConfig& config, std::uint32_t most_merged);

/// Returns the most triangles of a leaf that Collapse::kSah may form from a subtree of triangles.
constexpr std::uint32_t max_triangles_of_merged_leaf(const BvhConfig& config) { return config.leaf_size; }

/// Returns the bytes of the records of a leaf with `triangles` triangles, if no leaf record is shared better than
/// average; the collapse's estimate of a leaf's size.
double expected_leaf_bytes(const BvhConfig& config, std::uint32_t triangles);

}  // namespace traces
