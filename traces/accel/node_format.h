#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "traces/walk.h"

namespace traces {

/// Number format of box planes.
enum class BoxNumbers : std::uint8_t { kFp32, kHybrid };
constexpr std::array<std::string_view, 2> names_of(BoxNumbers) { return {"fp32", "hybrid"}; }

/// Contents of a record of the tree: both child boxes of an inner node, or one box with what is below it.
enum class BoxRecords : std::uint8_t { kPair, kSingle };
constexpr std::array<std::string_view, 2> names_of(BoxRecords) { return {"pair", "single"}; }

/// Bits of a plane in hybrid numbers. Twelve planes of 19 bits take 29 bytes where floats take 48: the 40 % less that
/// "hybrid number representations" (2015, doi 10.1145/2818427.2818446) give.
inline constexpr std::uint32_t kPlaneBits = 19;

constexpr std::uint32_t plane_bits(BoxNumbers numbers) { return numbers == BoxNumbers::kHybrid ? kPlaneBits : 32; }

/// Bytes that the boxes alone take, both of a node or one, rounded up.
constexpr std::uint32_t box_bytes(BoxNumbers numbers, BoxRecords boxes) {
  return ((boxes == BoxRecords::kPair ? 12 : 6) * plane_bits(numbers) + 7) / 8;
}

/// Bytes of a record: its boxes and, for each, a link of 30 bits (leaf or not, and either the triangles less one and
/// the first of them or a node) and 16 bits of flags, two for each triangle of a leaf, for triangles that have none of
/// their own. Filled up to words, a pair of floats to a whole line.
constexpr std::uint32_t node_bytes(BoxNumbers numbers, BoxRecords boxes) {
  if (numbers == BoxNumbers::kHybrid) return boxes == BoxRecords::kPair ? 40 : 20;
  return boxes == BoxRecords::kPair ? 64 : 32;
}
inline constexpr std::uint32_t kLinkBits = 1 + 3 + 26, kFlagBits = 2 * kMaxLeafTriangles;
static_assert(kMaxTriangles == 1U << 26 && kMaxLeafTriangles == 1U << 3 && 2 * kMaxNodes < 1U << (kLinkBits - 1));
static_assert(6 * kPlaneBits + kLinkBits + kFlagBits == 8 * node_bytes(BoxNumbers::kHybrid, BoxRecords::kSingle));

/// Records of trees of `inner` inner nodes. Single boxes: each has two children, and a tree's root has a box too.
constexpr std::uint64_t node_records(std::uint64_t inner, BoxRecords boxes, std::uint64_t trees = 1) {
  return boxes == BoxRecords::kPair ? inner : 2 * inner + trees;
}

}  // namespace traces
