#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "hw_models/memory/messages.h"
#include "hw_models/tni/tree_in_memory.h"

namespace hw {

/// The treelets of a scene's trees: connected groups of nodes and leaves that are prefetched together (Chou et al.
/// 2023), and the map from nodes to treelets in memory.
///
///   root of a tree --> nodes and leaves breadth first while their lines fit --> nodes that do not fit are roots
///
/// 1. Each node belongs to one treelet. A treelet belongs to one tree; in two levels, the tree over instances has its
/// own treelets.
/// 2. The size of a treelet counts each line of its nodes and leaves once. A node larger than a treelet is a treelet of
/// its own. A leaf that does not fit belongs to no treelet.
/// 3. Nodes keep their addresses, so the lines of a treelet need not be consecutive.
/// 4. The map has an entry of four bytes for each node, then the lists of all treelets. The entry of a root gives the
/// place of its list: a link of four bytes for each node and leaf below the root, and an end of four bytes.
///
/// Not modelled: how a unit knows that a node is a root. A bit in the link to the node suffices.
class Treelets {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;
  static constexpr std::uint32_t kWordBytes = 4;

  /// No treelets.
  Treelets() = default;
  /// `bytes`: largest size of a treelet. `map`: address of the map, at the start of a line.
  Treelets(const TreeInMemory& tree, const TrianglesInMemory& triangles, std::uint64_t bytes, Addr map = 0);

  /// Returns the number of the treelet whose root is `node`; kNone if the node is no root.
  std::uint32_t treelet_with_root(std::uint32_t node) const { return of_root_[node]; }
  /// Returns links to all nodes and leaves of a treelet except its root, breadth first.
  std::span<const std::uint32_t> links_below_root(std::uint32_t treelet) const {
    return std::span(links_).subspan(begin_[treelet], begin_[treelet + 1] - begin_[treelet]);
  }
  std::uint32_t count() const { return begin_.empty() ? 0 : static_cast<std::uint32_t>(begin_.size() - 1); }
  std::uint32_t treelet_of(std::uint32_t node) const { return of_node_[node]; }

  /// Returns the line of the map that has a node's entry.
  Addr line_of_entry(std::uint32_t node) const { return line_of(map_ + Addr{node} * kWordBytes); }
  /// Cache lines of a treelet's list.
  Addr first_line_of_list(std::uint32_t treelet) const { return line_of(list_at(treelet)); }
  Addr last_line_of_list(std::uint32_t treelet) const { return line_of(list_at(treelet + 1) - kWordBytes); }
  std::uint64_t map_bytes() const { return list_at(count()) - map_; }

 private:
  /// Returns the address of a treelet's list, or of the end of all lists.
  Addr list_at(std::uint32_t treelet) const {
    return map_ + (of_node_.size() + (begin_.empty() ? 0 : begin_[treelet]) + treelet) * kWordBytes;
  }

  Addr map_ = 0;
  std::vector<std::uint32_t> of_node_;  ///< for each node, its treelet
  std::vector<std::uint32_t> of_root_;  ///< for each node, the treelet whose root it is, or kNone
  std::vector<std::uint32_t> begin_;    ///< for each treelet, the index of its first link; then the end
  std::vector<std::uint32_t> links_;
};

/// Appends the lines of a node's record that are not in `lines` yet.
void append_node_lines(const TreeInMemory& tree, std::uint32_t node, std::vector<Addr>& lines);

}  // namespace hw
