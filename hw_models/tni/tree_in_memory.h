#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "hw_models/memory/messages.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// The tree in memory as a traversal unit knows it: where records lie, and how nodes hang together.
struct TreeInMemory {
  Addr nodes = 0;
  std::uint32_t node_bytes = 64;  ///< bytes of a record; it may lie across two lines
  /// The parent of each inner node, for restarts; behind them, in a tree of two levels, the node above each instance.
  std::span<const std::uint32_t> parents{};
  /// The records of the two children of each inner node, where a record holds a single box; empty where it holds both
  /// boxes of a node.
  std::span<const std::array<std::uint32_t, 2>> single_boxes{};
  bool hybrid = false;  ///< fixed-point boxes
  /// Links from node to node, for prefetching.
  std::span<const traces::NodeRecord> links{};
  /// Records of instances in a tree of two levels: where they lie, and what they hold.
  Addr instances = 0;
  std::span<const traces::InstanceRecord> placed{};

  /// Is the record of each node, with both boxes, a line?
  bool node_is_line() const { return single_boxes.empty() && node_bytes == kLineBytes && nodes % kLineBytes == 0; }
  /// The line of a node whose record is one.
  Addr line_of(std::uint32_t node) const { return nodes + Addr{node} * kLineBytes; }
  Addr line_of_instance(std::uint32_t i) const { return instances + Addr{i} * sizeof(traces::InstanceRecord); }

  /// A line that a visit reads.
  struct Line {
    Addr line = 0;
    bool last = true;  ///< there are no more
  };
  /// The lines of a node's records from the first (`index` 0) to the last. With `testers` 2 a visit reads the boxes of
  /// both children, with 1 that of `child`.
  Line line_of_visit(std::uint32_t node, std::uint32_t testers, std::uint32_t child, std::uint32_t index) const;
};

/// Where triangles lie in memory. A triangle may lie across two lines.
struct TrianglesInMemory {
  Addr base = 0;
  std::uint32_t bytes = 48;
};

}  // namespace hw
