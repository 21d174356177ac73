#pragma once
#include <cstdint>

#include "sim/config/field.h"
#include "traces/walk.h"

namespace traces {

/// How the bounding volume hierarchy is built. Any change gives other walks.
struct BvhConfig {
  std::uint32_t leaf_size = 4;
  std::uint32_t max_depth = 64;
  double traversal_cost = 1;
  double intersection_cost = 1;

  static void describe(auto& c, auto&& field) {
    using enum sim::Affects;
    field(c.leaf_size, "leaf_size", "triangles", "largest leaf", sim::between(1, kMaxLeafTriangles), kFunction);
    field(c.max_depth, "max_depth", "levels", "deepest tree; the last eight levels split at the median",
          sim::between(16, 96), kFunction);
    field(c.traversal_cost, "traversal_cost", "", "surface area heuristic: cost of an inner node",
          sim::between(0.01, 100), kFunction);
    field(c.intersection_cost, "intersection_cost", "", "surface area heuristic: cost of a triangle",
          sim::between(0.01, 100), kFunction);
  }
};

}  // namespace traces
