#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "hw_models/memory/messages.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// The BVH in memory as a traversal unit reads it: addresses of node records, and links between nodes.
struct TreeInMemory {
  Addr nodes = 0;
  std::uint32_t node_bytes = 64;  ///< bytes of a record, which may straddle two lines
  /// Parent of each inner node, for restarts. In a two-level BVH, the parent of each instance's root follows.
  std::span<const std::uint32_t> parents{};
  /// For records that hold a single box: the records of the two children of each inner node. Empty if a record holds
  /// both boxes of its node.
  std::span<const std::array<std::uint32_t, 2>> single_boxes{};
  bool hybrid = false;  ///< boxes are in fixed point
  /// The children of each node, for prefetching.
  std::span<const traces::NodeRecord> links{};
  /// Address and contents of the instance records of a two-level BVH.
  Addr instances = 0;
  std::span<const traces::InstanceRecord> placed{};

  /// True if each node's record holds the boxes of both children and is exactly one cache line.
  bool has_one_line_per_node() const {
    return single_boxes.empty() && node_bytes == kLineBytes && nodes % kLineBytes == 0;
  }
  /// Returns the address of a node's cache line. Requires has_one_line_per_node().
  Addr line_of_node(std::uint32_t node) const { return nodes + Addr{node} * kLineBytes; }
  Addr line_of_instance(std::uint32_t instance) const {
    return instances + Addr{instance} * sizeof(traces::InstanceRecord);
  }

  /// A cache line that a visit to a node reads.
  struct Line {
    Addr line = 0;
    bool last = true;  ///< true for the last line of the visit
  };
  /// Returns the cache line with number `index`, from 0, of a visit to a node. With 2 box testers a visit reads the
  /// boxes of both children, with 1 only the box of `child`.
  Line line_of_visit(std::uint32_t node, std::uint32_t testers, std::uint32_t child, std::uint32_t index) const;
};

/// Addresses of the triangles in memory. A triangle may straddle two cache lines.
struct TrianglesInMemory {
  Addr base = 0;
  std::uint32_t bytes = 48;
};

}  // namespace hw
