#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "sim/config/field.h"
#include "sim/named.h"
#include "traces/accel/node_format.h"
#include "traces/walk.h"

namespace traces {

/// How the BVH follows an animated scene: the tree is rebuilt, or only its boxes are refitted (traces/accel/build.h).
enum class BvhUpdate : std::uint8_t { kRebuild, kRefit };
constexpr std::array<std::string_view, 2> names_of(BvhUpdate) { return {"rebuild", "refit"}; }

/// How a mesh with several instances is stored.
enum class InstanceLevels : std::uint8_t {
  kFlatten,   ///< one copy of the mesh per instance, in world space, all under one tree
  kTwoLevel,  ///< one copy of the mesh with its own tree, under a tree of instances (traces/accel/build/two_level.h)
};
constexpr std::array<std::string_view, 2> names_of(InstanceLevels) { return {"flatten", "two_level"}; }

/// Configuration keys of the BVH: how it is built, which determines the traversal walks of rays, and its format in
/// memory.
struct BvhConfig {
  std::uint32_t leaf_size = 4;
  std::uint32_t max_depth = 64;
  double traversal_cost = 1;
  double intersection_cost = 1;
  BvhUpdate update = BvhUpdate::kRebuild;
  InstanceLevels instances = InstanceLevels::kFlatten;
  BoxNumbers numbers = BoxNumbers::kFp32;
  BoxRecords boxes = BoxRecords::kPair;
  std::uint32_t triangle_bytes = 48;

  static void describe(auto& c, auto&& field) {
    using enum sim::Affects;
    field(NAMED(c.leaf_size), "triangles", "most triangles in a leaf", sim::between(1, kMaxLeafTriangles), kFunction);
    field(NAMED(c.max_depth), "levels", "deepest tree; the last eight levels split at the median", sim::between(16, 96),
          kFunction);
    field(NAMED(c.traversal_cost), "", "surface area heuristic: cost of an inner node", sim::between(0.01, 100),
          kFunction);
    field(NAMED(c.intersection_cost), "", "surface area heuristic: cost of a triangle", sim::between(0.01, 100),
          kFunction);
    field.not_modelled("width", "every node has two children");
    field.not_modelled("collapse", "every node has two children");
    field.not_modelled("format", "only bvh.numbers and bvh.boxes change the records");
    field.not_modelled("builder", "the host builds the tree by the surface area heuristic, free of charge");
    field.not_modelled("compression", "only bvh.numbers reduces the size of boxes");
    field(NAMED(c.update), "",
          "moving scenes: rebuild the tree for each frame, or refit the boxes of the first frame's tree", sim::any(),
          kFunction);
    field(NAMED(c.instances), "",
          "meshes with several instances: copied for each, under one tree, or stored once with a tree of their own "
          "below a tree of instances",
          sim::any(), kFunction);
    field(NAMED(c.numbers), "",
          "number format of box planes and ray origin: floats, or fixed point with a floating-point reciprocal of the "
          "direction (hybrid)",
          sim::any(), kFunction);
    field(NAMED(c.boxes), "", "a record of the tree holds both child boxes of a node, or a single box", sim::any(),
          kLayout);
    field(NAMED(c.triangle_bytes), "bytes",
          "size of a triangle record: 48, or 36 for the vertices only, with the rest in a separate array",
          sim::between(36, 48), kLayout);
  }
  void check(auto&& complain) const {
    if (triangle_bytes != 36 && triangle_bytes != 48) {
      complain("triangle_bytes", "is " + std::to_string(triangle_bytes) + "; allowed: 36 or 48");
    }
    if (numbers == BoxNumbers::kHybrid && instances == InstanceLevels::kTwoLevel) {
      complain("numbers",
               "hybrid numbers lie on one grid over the scene, and a mesh of instances: two_level does not; "
               "allowed with it: fp32");
    }
  }
};

}  // namespace traces
