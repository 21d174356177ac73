#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "hw_models/memory/messages.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// The tree in memory as a traversal unit sees it: addresses of records, and links between nodes.
struct TreeInMemory {
  Addr nodes = 0;
  std::uint32_t node_bytes = 64;  ///< bytes of a record, which may straddle two lines
  /// The parent of each inner node, for restarts; in a two-level tree, followed by the node above each instance.
  std::span<const std::uint32_t> parents{};
  /// The records of the two children of each inner node, if a record holds a single box; empty if it holds both boxes
  /// of a node.
  std::span<const std::array<std::uint32_t, 2>> single_boxes{};
  bool hybrid = false;  ///< fixed-point boxes
  /// The children of each node, for prefetching.
  std::span<const traces::NodeRecord> links{};
  /// Address and contents of the instance records of a two-level tree.
  Addr instances = 0;
  std::span<const traces::InstanceRecord> placed{};

  /// True if each node's record holds both boxes and is exactly one line.
  bool node_is_line() const { return single_boxes.empty() && node_bytes == kLineBytes && nodes % kLineBytes == 0; }
  /// Returns a node's line; only if node_is_line().
  Addr line_of(std::uint32_t node) const { return nodes + Addr{node} * kLineBytes; }
  Addr line_of_instance(std::uint32_t i) const { return instances + Addr{i} * sizeof(traces::InstanceRecord); }

  /// A line that a visit reads.
  struct Line {
    Addr line = 0;
    bool last = true;  ///< no other line follows
  };
  /// Returns line number `index`, from 0, of a visit to the node. With 2 testers a visit reads the boxes of both
  /// children, with 1 only that of `child`.
  Line line_of_visit(std::uint32_t node, std::uint32_t testers, std::uint32_t child, std::uint32_t index) const;
};

/// Addresses of triangles in memory. A triangle may straddle two lines.
struct TrianglesInMemory {
  Addr base = 0;
  std::uint32_t bytes = 48;
};

}  // namespace hw
