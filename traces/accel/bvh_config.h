#pragma once
#include <algorithm>
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

/// Algorithm that builds binary trees (traces/accel/build/bvh_build.h).
enum class TreeBuilder : std::uint8_t {
  kEmbree,  ///< Embree's binned SAH
  kLbvh,    ///< splits at the highest differing bit of Morton codes
  kPloc,    ///< merges neighbours in Morton order
};
constexpr std::array<std::string_view, 3> names_of(TreeBuilder) { return {"embree", "lbvh", "ploc"}; }

/// Configuration keys of the BVH: how it is built, which determines the traversal walks of rays, and its format in
/// memory.
struct BvhConfig {
  TreeBuilder builder = TreeBuilder::kEmbree;
  std::uint32_t morton_bits = 30;
  std::uint32_t ploc_radius = 16;
  std::uint32_t leaf_size = 4;
  std::uint32_t max_depth = 64;
  double traversal_cost = 1;
  double intersection_cost = 1;
  BvhUpdate update = BvhUpdate::kRebuild;
  InstanceLevels instances = InstanceLevels::kFlatten;
  BoxNumbers numbers = BoxNumbers::kFp32;
  BoxRecords boxes = BoxRecords::kPair;
  std::uint32_t triangle_bytes = 48;
  std::uint32_t width = 2;
  Collapse collapse = Collapse::kArea;
  CollapseCost collapse_cost = CollapseCost::kTests;
  NodeFormat format = NodeFormat::kFp32;
  LeafFormat leaf = LeafFormat::kTriangles;
  ChildOrder order = ChildOrder::kSort;

  /// Returns the format of nodes. `numbers: hybrid` and `format: hybrid` mean the same.
  NodeFormat node_format() const {
    return format == NodeFormat::kFp32 && numbers == BoxNumbers::kHybrid ? NodeFormat::kHybrid : format;
  }
  BoxNumbers box_numbers() const {
    return node_format() == NodeFormat::kHybrid ? BoxNumbers::kHybrid : BoxNumbers::kFp32;
  }
  /// True if trees have wide nodes: more than two children, or quantised boxes.
  bool is_wide() const { return width > 2 || is_quantised(format); }
  /// Returns the most triangles in a leaf that the formats of nodes and leaves can store.
  std::uint32_t most_leaf_triangles() const {
    const std::uint32_t records = most_leaf_records(format);
    // A block has room for three triangles even if they share neither vertices nor leading bits.
    const std::uint32_t triangles = leaf == LeafFormat::kBlock128 ? 3 * records : records;
    return std::min(triangles, kMaxLeafTriangles);
  }

  static void describe(auto& c, auto&& field) {
    using enum sim::Affects;
    field(
        NAMED(c.builder), "",
        "algorithm that builds binary trees: Embree's binned surface area heuristic, splits of Morton codes (lbvh), or "
        "merging of neighbours in Morton order (ploc)",
        sim::any(), kFunction);
    field(NAMED(c.morton_bits), "bits", "lbvh and ploc: bits of a Morton code: 24, 30 or 63", sim::between(24, 63),
          kFunction);
    field(NAMED(c.ploc_radius), "clusters",
          "ploc: how far a cluster searches along the Morton order, each way: 8 or 16", sim::between(8, 16), kFunction);
    field(NAMED(c.leaf_size), "triangles", "most triangles in a leaf", sim::between(1, kMaxLeafTriangles), kFunction);
    field(NAMED(c.max_depth), "levels", "deepest tree; a tree that would be deeper gets splits at the median",
          sim::between(16, 96), kFunction);
    field(NAMED(c.traversal_cost), "", "surface area heuristic: cost of an inner node", sim::between(0.01, 100),
          kFunction);
    field(NAMED(c.intersection_cost), "", "surface area heuristic: cost of a triangle", sim::between(0.01, 100),
          kFunction);
    field.not_modelled("compression", "bvh.format and bvh.leaf reduce the size of nodes and leaves");
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
    field(NAMED(c.width), "children", "most children of a node: 2, 4, 6 or 8; wider trees are collapsed binary trees",
          sim::between(2, kMaxWidth), kFunction);
    field(NAMED(c.collapse), "",
          "choice of a wide node's children: open the inner child of largest area while there is room, or minimise the "
          "expected cost of the tree",
          sim::any(), kFunction);
    field(NAMED(c.collapse_cost), "",
          "cost that collapse: sah minimises: node visits and triangle tests, or bytes of the records read", sim::any(),
          kFunction);
    field(
        NAMED(c.format), "",
        "format of nodes: floats, hybrid numbers, or planes of 8 bits (q8: 64 bytes, cw80: 80 bytes) or 12 bits (q12: "
        "128 bytes) on a grid of the node's own",
        sim::any(), kFunction);
    field(NAMED(c.leaf), "",
          "format of leaves: a record per triangle, 64-byte records of two triangles that share an edge, or 128-byte "
          "blocks whose vertices share leading bits",
          sim::any(), kFunction);
    field(
        NAMED(c.order), "",
        "order in which a ray visits the hit children of a wide node: by distance, the nearest first and the others by "
        "slot, or by slots that suit the ray's octant (cw80)",
        sim::any(), kFunction);
  }
  void check(auto&& complain) const {
    if (morton_bits != 24 && morton_bits != 30 && morton_bits != 63) {
      complain("morton_bits", "is " + std::to_string(morton_bits) + "; allowed: 24, 30, 63");
    }
    if (ploc_radius != 8 && ploc_radius != 16) {
      complain("ploc_radius", "is " + std::to_string(ploc_radius) + "; allowed: 8, 16");
    }
    if (triangle_bytes != 36 && triangle_bytes != 48) {
      complain("triangle_bytes", "is " + std::to_string(triangle_bytes) + "; allowed: 36 or 48");
    }
    if (width % 2 != 0) complain("width", "is " + std::to_string(width) + "; allowed: 2, 4, 6, 8");
    if (numbers == BoxNumbers::kHybrid && is_quantised(format)) {
      complain("numbers", "is hybrid, but the format has numbers of its own; allowed with it: fp32");
    }
    if (is_wide() && boxes == BoxRecords::kSingle) {
      complain("boxes", "is single; allowed with wide nodes: pair");
    }
    if (order == ChildOrder::kOctant && format != NodeFormat::kCw80) {
      complain("order", "is octant, which needs octant slots; allowed with it: bvh.format=cw80");
    }
    if (triangle_bytes == 36 && (is_quantised(format) || leaf != LeafFormat::kTriangles)) {
      complain("triangle_bytes",
               "is 36, which needs flags in nodes; allowed with quantised nodes, pairs and blocks: 48");
    }
    if (leaf_size > most_leaf_triangles()) {
      complain("leaf_size", "is " + std::to_string(leaf_size) +
                                "; allowed with these formats of nodes and leaves: 1 to " +
                                std::to_string(most_leaf_triangles()));
    }
    if (box_numbers() == BoxNumbers::kHybrid && instances == InstanceLevels::kTwoLevel) {
      complain(numbers == BoxNumbers::kHybrid ? "numbers" : "format",
               "hybrid numbers lie on one grid over the scene, and a mesh of instances: two_level does not; "
               "allowed with it: fp32");
    }
  }
};

}  // namespace traces
