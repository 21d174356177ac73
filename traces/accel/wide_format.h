#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "traces/accel/memory_image.h"
#include "traces/accel/node_format.h"

namespace traces {

// Quantised nodes: q8, q12 and cw80.
//
// 1. A plane is origin + number * 2^exponent, per axis, with one origin and one exponent for all children. The decoder
//    multiplies exactly and rounds the sum once, to the nearest float.
// 2. The encoder applies the decoder to each number and moves the number outward until the decoded plane does not cut
//    the exact box. So every stored box contains its exact box under the decoder's own arithmetic.
// 3. The exponent is the smallest that reaches the node's upper planes.
// 4. An empty slot is marked outside the planes; the decoder gives it an inverted box without end, which no ray hits.

/// Numbers of a quantised node, before they are packed into a record.
struct QuantisedBoxes {
  float origin[3] = {};
  int exponent[3] = {};  ///< of the step between neighbouring planes, as a power of two
  std::uint16_t planes[3][2][kMaxWidth] = {};
  std::uint32_t used = 0;  ///< bit i is set if slot i has a child
};

/// Returns the smallest numbers, of a format, whose boxes contain the boxes of all children of a node.
QuantisedBoxes quantise_boxes(const WideNode& node, NodeFormat format);
/// Writes the decoded planes of `boxes` into a node; slots without a child become inverted boxes.
void decode_boxes(const QuantisedBoxes& boxes, WideNode& node);

/// Replaces the exact planes of nodes [first, end) by those that a quantised format stores.
void quantise_nodes(std::span<WideNode> nodes, NodeFormat format);

/// Where a quantised node's children are. Inner children have consecutive records, and so have the leaves' records.
struct ChildPlaces {
  std::uint32_t inner_base = 0;  ///< number of the first inner child's record; for q8 of its 64-byte slot
  std::uint32_t leaf_base =
      0;                     ///< number of the first leaf record; not stored in q8, where leaves follow inner children
  std::uint32_t parent = 0;  ///< number of the parent's record; stored in q12 only
  std::array<std::uint8_t, kMaxWidth> records{};  ///< number of records of a leaf in a slot; 0 for an inner child
  friend bool operator==(const ChildPlaces&, const ChildPlaces&) = default;
};

/// Packs a node into the bytes of its record; unpack_node() is the inverse.
std::vector<std::byte> pack_node(const QuantisedBoxes& boxes, const ChildPlaces& children, NodeFormat format);
void unpack_node(std::span<const std::byte> record, NodeFormat format, QuantisedBoxes& boxes, ChildPlaces& children);

/// Puts children into octant slots: slot s contains the child that a ray of octant s should enter last and a ray of the
/// opposite octant first. `centre[i]` is the centre of child i relative to the node's. Returns the slot of each child.
/// Children choose slots in the order of their preference (greedy assignment, Ylitie 2017).
std::array<std::uint32_t, kMaxWidth> octant_slots(std::span<const glm::vec3> centre);

}  // namespace traces
