#pragma once
#include <cstdint>
#include <vector>

#include "traces/accel/build/bvh_build.h"
#include "traces/accel/bvh_config.h"

namespace traces {

/// A binary tree with one item per leaf, as builders that sort items by Morton codes make it.
struct BinaryTree {
  struct Node {
    Bounds box;
    std::uint32_t child[2];  ///< index of a node, or leaf_link(position, 1) of the item at a position in Morton order
  };
  std::vector<std::uint32_t> items;  ///< input index of each item, in Morton order
  std::vector<Bounds> boxes;         ///< box of each item, in Morton order
  std::vector<Node> nodes;           ///< one node fewer than items; children precede their parent, the root is last

  /// Returns the box of a child named by a link word.
  const Bounds& box_of(std::uint32_t link) const { return is_leaf(link) ? boxes[leaf_first(link)] : nodes[link].box; }
  /// Appends the parent of two children.
  void add_parent(std::uint32_t first, std::uint32_t second);
};

/// Converts a tree with leaves of one item into the final form.
///
/// 1. A subtree of at most `config.leaf_size` items becomes a leaf if this does not raise its SAH cost.
/// 2. If the tree is then deeper than `config.max_depth`, the smallest subtrees that contain the deep paths and fit
///    after a rebuild are rebuilt: their items, in Morton order, are split at the median down to full leaves.
/// 3. The items are in the leaves by input index; the child of larger area is first.
///
/// Throws InputError if even median splits give a tree that is too deep. `tree` is changed by rule 2.
FlatBvh flatten_tree(BinaryTree& tree, const BvhConfig& config);

}  // namespace traces
