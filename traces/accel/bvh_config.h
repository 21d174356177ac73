#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "sim/config/field.h"
#include "traces/walk.h"

namespace traces {

/// What is done with the tree when the scene has moved: made anew, or its boxes drawn around where things are now
/// (traces/accel/refit.h).
enum class BvhUpdate : std::uint8_t { kRebuild, kRefit };
constexpr std::array<std::string_view, 2> names_of(BvhUpdate) { return {"rebuild", "refit"}; }

/// How the bounding volume hierarchy is built. Any change gives other walks.
struct BvhConfig {
  std::uint32_t leaf_size = 4;
  std::uint32_t max_depth = 64;
  double traversal_cost = 1;
  double intersection_cost = 1;
  BvhUpdate update = BvhUpdate::kRebuild;

  static void describe(auto& c, auto&& field) {
    using enum sim::Affects;
    field(c.leaf_size, "leaf_size", "triangles", "largest leaf", sim::between(1, kMaxLeafTriangles), kFunction);
    field(c.max_depth, "max_depth", "levels", "deepest tree; the last eight levels split at the median",
          sim::between(16, 96), kFunction);
    field(c.traversal_cost, "traversal_cost", "", "surface area heuristic: cost of an inner node",
          sim::between(0.01, 100), kFunction);
    field(c.intersection_cost, "intersection_cost", "", "surface area heuristic: cost of a triangle",
          sim::between(0.01, 100), kFunction);
    field(c.update, "update", "",
          "moving scenes: build the tree anew for each frame, or refit the boxes of the first frame's tree", sim::any(),
          kFunction);
  }
};

}  // namespace traces
