#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "hw_models/memory/messages.h"
#include "hw_models/tni/tree_in_memory.h"

namespace hw {

/// The treelets of a scene's trees: connected groups of nodes that are prefetched together (Chou et al. 2023).
///
///   root of a tree --> nodes breadth first while their lines fit --> children that do not fit are roots of treelets
///
/// 1. Each node belongs to one treelet. A treelet belongs to one tree; in two levels, the tree over instances has its
/// own treelets.
/// 2. The size of a treelet counts each line of its nodes once. A node larger than a treelet is a treelet of its own.
/// 3. Nodes keep their addresses, so the lines of a treelet need not be consecutive.
///
/// Not modelled: reads of the map from nodes to treelets.
class Treelets {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  /// No treelets.
  Treelets() = default;
  /// `bytes`: largest size of a treelet.
  Treelets(const TreeInMemory& tree, std::uint64_t bytes);

  /// Returns the number of the treelet whose root is `node`; kNone if the node is no root.
  std::uint32_t treelet_with_root(std::uint32_t node) const { return of_root_[node]; }
  /// Returns the lines of a treelet, except those of its root node, in breadth-first order of their nodes.
  std::span<const Addr> lines_below_root(std::uint32_t treelet) const {
    return std::span(lines_).subspan(begin_[treelet], begin_[treelet + 1] - begin_[treelet]);
  }
  std::uint32_t count() const { return begin_.empty() ? 0 : static_cast<std::uint32_t>(begin_.size() - 1); }
  std::uint32_t treelet_of(std::uint32_t node) const { return of_node_[node]; }

 private:
  std::vector<std::uint32_t> of_node_;  ///< for each node, its treelet
  std::vector<std::uint32_t> of_root_;  ///< for each node, the treelet whose root it is, or kNone
  std::vector<std::uint32_t> begin_;    ///< for each treelet, the index of its first line; then the end
  std::vector<Addr> lines_;
};

/// Appends the lines of a node's record that are not in `lines` yet.
void append_node_lines(const TreeInMemory& tree, std::uint32_t node, std::vector<Addr>& lines);

}  // namespace hw
