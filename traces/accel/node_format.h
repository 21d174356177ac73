#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include <glm/vec3.hpp>

#include "traces/walk.h"

namespace traces {

/// Number format of box planes: 32-bit floats, or 19-bit plane numbers of a BoxGrid (hybrid).
enum class BoxNumbers : std::uint8_t { kFp32, kHybrid };
constexpr std::array<std::string_view, 2> names_of(BoxNumbers) { return {"fp32", "hybrid"}; }

/// What a BVH record contains: both child boxes of an inner node, or one box with its link.
enum class BoxRecords : std::uint8_t { kPair, kSingle };
constexpr std::array<std::string_view, 2> names_of(BoxRecords) { return {"pair", "single"}; }

/// Format of the nodes of a tree (wide_format.h): boxes in floats or hybrid numbers, which a tree of any width has, or
/// planes of a few bits on a grid of each node's own.
enum class NodeFormat : std::uint8_t {
  kFp32,
  kHybrid,
  kQ8,    ///< 64 bytes, 8-bit planes, one base for all children, as Adreno's
  kQ12,   ///< 128 bytes, 12-bit planes, as RDNA4's
  kCw80,  ///< 80 bytes, 8-bit planes, children in octant slots (Ylitie 2017)
};
constexpr std::array<std::string_view, 5> names_of(NodeFormat) { return {"fp32", "hybrid", "q8", "q12", "cw80"}; }

constexpr bool is_quantised(NodeFormat format) { return format >= NodeFormat::kQ8; }

/// Returns the largest number of records of a leaf. q8 stores it in 3 bits, where 0 is an inner child, q12 in 4 bits;
/// cw80 counts to 3 in unary.
constexpr std::uint32_t most_leaf_records(NodeFormat format) {
  return format == NodeFormat::kQ8 ? 7 : format == NodeFormat::kCw80 ? 3 : kMaxLeafTriangles;
}

/// Returns the size in bytes of a node with up to `width` children. Float nodes have 24 bytes of box and 46 bits of
/// link and flags per child and fill whole lines; hybrid nodes have 20 bytes per child.
constexpr std::uint32_t wide_node_bytes(NodeFormat format, std::uint32_t width) {
  switch (format) {
    case NodeFormat::kFp32:
      return (width * (24 * 8 + 46) + 511) / 512 * 64;
    case NodeFormat::kHybrid:
      return 20 * width;
    case NodeFormat::kQ8:
      return 64;
    case NodeFormat::kQ12:
      return 128;
    case NodeFormat::kCw80:
      return 80;
  }
  return 0;
}

/// How the children of wide nodes are chosen from the binary tree (build/collapse.h).
enum class Collapse : std::uint8_t { kArea, kSah };
constexpr std::array<std::string_view, 2> names_of(Collapse) { return {"area", "sah"}; }

/// What the dynamic programme of Collapse::kSah minimises.
enum class CollapseCost : std::uint8_t { kTests, kBytes };
constexpr std::array<std::string_view, 2> names_of(CollapseCost) { return {"tests", "bytes"}; }

/// Order in which a ray visits the hit children of a wide node.
enum class ChildOrder : std::uint8_t {
  kSort,     ///< by entry distance; of equal distances the lower slot first
  kNearest,  ///< the nearest first, the others by slot
  kOctant,   ///< by slot, as the octant of the ray's direction selects (wide_format.h), whatever the distances
};
constexpr std::array<std::string_view, 3> names_of(ChildOrder) { return {"sort", "nearest", "octant"}; }

/// Record of the triangles of a leaf (leaf_format.h): one record per triangle, two triangles in 64 bytes, or a block of
/// 128 bytes whose vertices share leading bits.
enum class LeafFormat : std::uint8_t { kTriangles, kPair64, kBlock128 };
constexpr std::array<std::string_view, 3> names_of(LeafFormat) { return {"triangles", "pair64", "block128"}; }

/// Bits of a box plane in the hybrid number format. Twelve planes of 19 bits take 29 bytes, against 48 bytes as floats.
/// This is the saving of 40 % reported by "hybrid number representations" (2015, doi 10.1145/2818427.2818446).
inline constexpr std::uint32_t kPlaneBits = 19;

constexpr std::uint32_t plane_bits(BoxNumbers numbers) { return numbers == BoxNumbers::kHybrid ? kPlaneBits : 32; }

/// Returns the bytes that the boxes of a BVH record take, rounded up.
constexpr std::uint32_t box_bytes(BoxNumbers numbers, BoxRecords boxes) {
  return ((boxes == BoxRecords::kPair ? 12 : 6) * plane_bits(numbers) + 7) / 8;
}

/// Returns the size in bytes of a BVH record: its boxes and, for each box, 30 bits of link and 16 bits of flags. A
/// link is a leaf bit and either a node, or the number of triangles less one and the first triangle. A leaf has two
/// flag bits per triangle, for triangle formats without flags. The size is rounded up to words; a pair of float boxes
/// fills a line.
constexpr std::uint32_t node_bytes(BoxNumbers numbers, BoxRecords boxes) {
  if (numbers == BoxNumbers::kHybrid) return boxes == BoxRecords::kPair ? 40 : 20;
  return boxes == BoxRecords::kPair ? 64 : 32;
}
inline constexpr std::uint32_t kLinkBits = 1 + 3 + 26, kFlagBits = 2 * kMaxLeafTriangles;
static_assert(kMaxTriangles == 1U << 26 && kMaxLeafTriangles == 1U << 3 && 2 * kMaxNodes < 1U << (kLinkBits - 1));
static_assert(6 * kPlaneBits + kLinkBits + kFlagBits == 8 * node_bytes(BoxNumbers::kHybrid, BoxRecords::kSingle));

/// Returns the number of BVH records of `trees` trees that have `inner` inner nodes together. With single boxes each
/// node has two child records, and each root has a record too.
constexpr std::uint64_t node_records(std::uint64_t inner, BoxRecords boxes, std::uint64_t trees = 1) {
  return boxes == BoxRecords::kPair ? inner : 2 * inner + trees;
}

/// The grid on which hybrid numbers place box planes (US patent 9,830,733). Each axis has 2^19 planes spread over the
/// scene; plane p is at lower + p * step.
class BoxGrid {
 public:
  static constexpr std::uint32_t kLastPlane = (1U << kPlaneBits) - 1;

  /// Spreads the grid over the scene's bounds. On an axis where the scene is nearly flat, the step is at least 1/1024
  /// of that of the longest axis, because box tests resolve no finer distances (ray_tests.h).
  BoxGrid(const glm::vec3& lower, const glm::vec3& upper);

  /// Return the number of the last grid plane not above `x`, and of the first not below `x`. `x` must be within the
  /// bounds.
  float plane_below(float x, int axis) const;
  float plane_above(float x, int axis) const;
  /// Returns the coordinate of grid plane `p`.
  double plane_position(double p, int axis) const { return lower_[axis] + p * step_[axis]; }

  const glm::vec3& lower_corner() const { return lower_; }
  const glm::vec3& plane_spacing() const { return step_; }
  friend bool operator==(const BoxGrid&, const BoxGrid&) = default;

 private:
  glm::vec3 lower_, step_;
};

struct MemoryImage;

/// Converts the boxes of an image to hybrid numbers: spreads a grid over its bounds and rounds all planes outward.
void round_boxes_to_grid(MemoryImage& image);

}  // namespace traces
