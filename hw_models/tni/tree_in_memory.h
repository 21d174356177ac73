#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "hw_models/memory/messages.h"
#include "traces/accel/memory_image.h"

namespace hw {

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

  /// True if each node's record contains the boxes of both children and is exactly one cache line.
  bool has_one_line_per_node() const {
    return single_boxes.empty() && node_bytes == kLineBytes && nodes % kLineBytes == 0;
  }
  /// Returns the address of a node's cache line. Requires has_one_line_per_node().
  Addr line_of_node(std::uint32_t node) const { return nodes + Addr{node} * kLineBytes; }
  Addr line_of_instance(std::uint32_t instance) const {
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
};

/// Addresses of the triangles in memory. A triangle may straddle two cache lines.
struct TrianglesInMemory {
  Addr base = 0;
  std::uint32_t bytes = 48;
};

}  // namespace hw
