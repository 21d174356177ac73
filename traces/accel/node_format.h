#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "traces/walk.h"

namespace traces {

/// Number format of box planes.
enum class BoxNumbers : std::uint8_t { kFp32, kHybrid };
constexpr std::array<std::string_view, 2> names_of(BoxNumbers) { return {"fp32", "hybrid"}; }

/// Contents of a tree record: both child boxes of an inner node, or one box with its link.
enum class BoxRecords : std::uint8_t { kPair, kSingle };
constexpr std::array<std::string_view, 2> names_of(BoxRecords) { return {"pair", "single"}; }

/// Bits of a plane in hybrid numbers. Twelve planes of 19 bits take 29 bytes, against 48 bytes as floats. This is the
/// saving of 40 % reported by "hybrid number representations" (2015, doi 10.1145/2818427.2818446).
inline constexpr std::uint32_t kPlaneBits = 19;

constexpr std::uint32_t plane_bits(BoxNumbers numbers) { return numbers == BoxNumbers::kHybrid ? kPlaneBits : 32; }

/// Returns the bytes of a record's boxes, rounded up.
constexpr std::uint32_t box_bytes(BoxNumbers numbers, BoxRecords boxes) {
  return ((boxes == BoxRecords::kPair ? 12 : 6) * plane_bits(numbers) + 7) / 8;
}

/// Returns the bytes of a record: its boxes and, for each box, 30 bits of link and 16 bits of flags. A link is a leaf
/// bit and either a node, or the number of triangles less one and the first triangle. A leaf has two flag bits per
/// triangle, for triangle formats without flags. The size is rounded up to words; a pair of float boxes fills a line.
constexpr std::uint32_t node_bytes(BoxNumbers numbers, BoxRecords boxes) {
  if (numbers == BoxNumbers::kHybrid) return boxes == BoxRecords::kPair ? 40 : 20;
  return boxes == BoxRecords::kPair ? 64 : 32;
}
inline constexpr std::uint32_t kLinkBits = 1 + 3 + 26, kFlagBits = 2 * kMaxLeafTriangles;
static_assert(kMaxTriangles == 1U << 26 && kMaxLeafTriangles == 1U << 3 && 2 * kMaxNodes < 1U << (kLinkBits - 1));
static_assert(6 * kPlaneBits + kLinkBits + kFlagBits == 8 * node_bytes(BoxNumbers::kHybrid, BoxRecords::kSingle));

/// Returns the number of records of trees with `inner` inner nodes in total. With single boxes each node has two child
/// records, and each root has a record too.
constexpr std::uint64_t node_records(std::uint64_t inner, BoxRecords boxes, std::uint64_t trees = 1) {
  return boxes == BoxRecords::kPair ? inner : 2 * inner + trees;
}

}  // namespace traces
