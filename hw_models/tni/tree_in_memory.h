#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hw_models/memory/messages.h"
#include "hw_models/tni/tni_config.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// The record of a wide node: its first cache line, counted from the first node, and how many lines it touches and
/// children it has.
struct WideRecord {
  std::uint32_t line = 0;
  std::uint8_t lines = 1;
  std::uint8_t children = 0;
};

/// Memory layout of the BVH for a traversal unit: addresses of node records, and links between nodes.
struct TreeInMemory {
  Addr nodes = 0;
  std::uint32_t node_bytes = 64;  ///< size of a node record, which may straddle two lines
  /// Parent of each inner node, for restarts. In a two-level BVH, entries for the instances follow: the node that is
  /// the parent of the instance.
  std::span<const std::uint32_t> parents{};
  /// If records contain a single box: the records of the two children of each inner node. Empty if the record of a node
  /// contains the boxes of both children.
  std::span<const std::array<std::uint32_t, 2>> single_boxes{};
  bool hybrid = false;  ///< child boxes are stored in fixed point
  /// The children of each BVH node, for prefetching.
  std::span<const traces::NodeRecord> links{};
  /// Address and contents of the instance records of a two-level BVH.
  Addr instances = 0;
  std::span<const traces::InstanceRecord> placed{};
  /// Places of the instance records in units of Layout::kPlaceBytes; empty if they are in the order of their numbers.
  std::span<const std::uint32_t> instance_places{};
  /// Kind of the tree, and the records and links of wide nodes. Empty for binary nodes.
  TreeKind kind{};
  std::shared_ptr<const std::vector<WideRecord>> wide{};
  std::span<const traces::WideNode> wide_links{};
  bool wide_nodes_have_lines = true;  ///< the record of some wide node has several lines
  /// Address of a table with the parent link of each node, 4 bytes, for stacks with parent links.
  Addr parent_links = 0;
  /// The records of nodes contain their parent links, so the table is not read (q12).
  bool parents_in_nodes = false;

  static constexpr std::uint32_t kParentBytes = 4;
  std::size_t node_count() const { return kind.wide ? wide_links.size() : links.size(); }
  /// Returns the size of the table of parent links, which only the stack scheme `parent` reads.
  static std::uint64_t parent_table_bytes(std::size_t nodes, bool parents_in_nodes, StackScheme stack) {
    return stack == StackScheme::kParent && !parents_in_nodes ? std::uint64_t{nodes} * kParentBytes : 0;
  }
  /// Returns the address of the map of treelets, which follows the parent links.
  Addr treelet_map(StackScheme stack) const {
    return round_up_to_lines(parent_links + parent_table_bytes(node_count(), parents_in_nodes, stack));
  }
  Addr line_of_parent_link(std::uint32_t node) const { return hw::line_of(parent_links + Addr{node} * kParentBytes); }
  /// True if each node's record contains the boxes of both children and is exactly one cache line.
  bool has_one_line_per_node() const {
    return single_boxes.empty() && node_bytes == kLineBytes && nodes % kLineBytes == 0;
  }
  /// Returns the address of a node's cache line. Requires has_one_line_per_node().
  Addr line_of_node(std::uint32_t node) const { return nodes + Addr{node} * kLineBytes; }
  Addr line_of_instance(std::uint32_t instance) const {
    if (!instance_places.empty()) return instances + Addr{instance_places[instance]} * traces::Layout::kPlaceBytes;
    return instances + Addr{instance} * sizeof(traces::InstanceRecord);
  }

  /// One of the cache lines that a visit to a BVH node reads.
  struct Line {
    Addr line = 0;
    bool last = true;  ///< true for the last line that the visit reads
  };
  /// Returns the cache line number `index` (from 0) that a visit to a node reads. `testers`: number of box testers.
  /// With 2, a visit reads the boxes of both children, with 1 only that of `child`.
  Line line_of_visit(std::uint32_t node, std::uint32_t testers, std::uint32_t child, std::uint32_t index) const;
  /// Returns the cache line number `index` (from 0) that a visit to a wide node reads.
  Line line_of_wide_visit(WideRecord record, std::uint32_t index) const {
    return {nodes + (Addr{record.line} + index) * kLineBytes, index + 1 == record.lines};
  }
};

/// Addresses of the triangles in memory. A record may straddle cache lines.
struct TrianglesInMemory {
  Addr base = 0;
  std::uint32_t bytes = 48;  ///< size of a record
  /// Places of the triangles' records in units of Layout::kPlaceBytes; empty if each triangle has a record, in order.
  /// Triangles of the same place share a record.
  std::span<const std::uint32_t> places{};
  bool decoded = false;  ///< records are blocks, which are decoded (traces::LeafFormat::kBlock128)

  /// Returns the address of the record that contains a triangle.
  Addr record_of(std::uint32_t triangle) const {
    return base + (places.empty() ? Addr{triangle} * bytes : Addr{places[triangle]} * traces::Layout::kPlaceBytes);
  }
  /// Appends the lines of a leaf's records, each once, in ascending order of the triangles.
  void append_leaf_lines(std::uint32_t first, std::uint32_t count, std::vector<Addr>& lines) const;
};

/// Returns the memory layout of the BVH in an image. `parents`: result of traces::parent_indices().
TreeInMemory tree_in_memory(const traces::MemoryImage& image, std::span<const std::uint32_t> parents);

/// Returns the kind of the trees in an image.
TreeKind tree_kind(const traces::MemoryImage& image);

/// Returns the space after the image for the tables that traversal units read: parent links, and at most the map of
/// treelets (treelets.h).
std::uint64_t tree_table_bytes(const traces::MemoryImage& image, const TrvConfig& config);

}  // namespace hw
