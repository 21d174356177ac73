#include "traces/accel/wide_format.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "traces/accel/record_bits.h"

namespace traces {
namespace {

constexpr int kLeastExponent = -126, kMostExponent = 127, kBias = 127;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Largest numbers of lower and upper planes. Upper planes of q12 are stored less one, so they begin at 1.
struct NumberRange {
  double most_lower, least_upper, most_upper;
};
constexpr NumberRange range_of(NodeFormat format) {
  return format == NodeFormat::kQ12 ? NumberRange{4095, 1, 4096} : NumberRange{255, 0, 255};
}

/// Returns 2^exponent. The result is exact within the range of exponents.
float step_of(int exponent) { return std::bit_cast<float>(static_cast<std::uint32_t>(exponent + kBias) << 23); }

/// Decodes a plane: the product is exact, the sum is rounded.
float decode_plane(float origin, float step, std::int32_t number) { return origin + static_cast<float>(number) * step; }

/// Rounds a float toward minus infinity to the upper half of its bits.
float round_down_to_16_bits(float x) {
  std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
  const bool exact = (bits & 0xffffU) == 0;
  bits &= 0xffff0000U;
  if (!exact && x < 0) bits += 0x10000U;
  return std::bit_cast<float>(bits);
}

/// Finds the number of a lower plane at `x`. Returns false if none of the range is low enough.
bool find_lower(float x, float origin, float step, const NumberRange& range, std::uint16_t& number) {
  const double steps = std::floor((double{x} - origin) / step);
  auto n = static_cast<std::int32_t>(std::clamp(steps, 0.0, range.most_lower));
  while (n > 0 && decode_plane(origin, step, n) > x) --n;
  number = static_cast<std::uint16_t>(n);
  return decode_plane(origin, step, n) <= x;
}

/// Finds the number of an upper plane at `x`. Returns false if none of the range is high enough.
bool find_upper(float x, float origin, float step, const NumberRange& range, std::uint16_t& number) {
  const double steps = std::ceil((double{x} - origin) / step);
  auto n = static_cast<std::int32_t>(std::clamp(steps, range.least_upper, range.most_upper));
  while (n < range.most_upper && decode_plane(origin, step, n) < x) ++n;
  number = static_cast<std::uint16_t>(n);
  return decode_plane(origin, step, n) >= x;
}

/// Quantises one axis of all children with the given exponent. Returns false if the numbers do not reach far enough.
bool quantise_axis(const WideNode& node, int axis, const NumberRange& range, QuantisedBoxes& out) {
  const float origin = out.origin[axis], step = step_of(out.exponent[axis]);
  for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
    if ((out.used >> i & 1U) == 0) continue;
    if (!find_lower(node.planes[axis][0][i], origin, step, range, out.planes[axis][0][i]) ||
        !find_upper(node.planes[axis][1][i], origin, step, range, out.planes[axis][1][i])) {
      return false;
    }
  }
  return true;
}

/// Returns the smallest exponent with which `steps` steps may cover `extent`.
int first_exponent(double extent, double steps) {
  if (!(extent > 0)) return kLeastExponent;
  int exponent = 0;
  (void)std::frexp(extent / steps, &exponent);  // extent / steps < 2^exponent
  return std::clamp(exponent - 1, kLeastExponent, kMostExponent);
}

/// Calls f(value, bits) for every field of a record, in memory order. The same list serves packing and unpacking, so
/// that they cannot differ.
void for_each_field(NodeFormat format, QuantisedBoxes& boxes, ChildPlaces& children, auto&& f) {
  const auto origin = [&](int axis, std::uint32_t bits) {
    std::uint32_t word = std::bit_cast<std::uint32_t>(boxes.origin[axis]) >> (32 - bits);
    f(word, bits);
    boxes.origin[axis] = std::bit_cast<float>(word << (32 - bits));
  };
  const auto exponent = [&](int axis) {
    auto biased = static_cast<std::uint32_t>(boxes.exponent[axis] + kBias);
    f(biased, 8);
    boxes.exponent[axis] = static_cast<int>(biased) - kBias;
  };
  const auto plane = [&](int axis, int side, std::uint32_t i, std::uint32_t bits, std::uint32_t offset) {
    const std::uint32_t empty = side == 0 ? (1U << bits) - 1 : 0;  // an inverted box
    std::uint32_t number = (boxes.used >> i & 1U) != 0 ? boxes.planes[axis][side][i] - offset : empty;
    f(number, bits);
    if ((boxes.used >> i & 1U) != 0) boxes.planes[axis][side][i] = static_cast<std::uint16_t>(number + offset);
  };
  // The number of children less one; they fill the first slots.
  const auto count = [&](std::uint32_t bits) {
    std::uint32_t less_one = static_cast<std::uint32_t>(std::max(std::popcount(boxes.used), 1)) - 1;
    f(less_one, bits);
    boxes.used = (2U << less_one) - 1;
  };
  const auto records = [&](std::uint32_t i, std::uint32_t bits) {
    std::uint32_t n = children.records[i];
    f(n, bits);
    children.records[i] = static_cast<std::uint8_t>(n);
  };
  std::uint32_t zero = 0;
  switch (format) {
    case NodeFormat::kQ8:
      f(children.inner_base, 27);
      count(3);
      f(zero, 2);
      for (int a = 0; a < 3; ++a) origin(a, 16);
      for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
        for (int side = 0; side < 2; ++side) {
          for (int a = 0; a < 3; ++a) plane(a, side, i, 8, 0);
        }
      }
      for (int a = 0; a < 3; ++a) exponent(a);
      for (std::uint32_t i = 0; i < kMaxWidth; ++i) records(i, 3);
      break;
    case NodeFormat::kQ12:
      f(children.inner_base, 32);
      f(children.leaf_base, 32);
      f(children.parent, 32);
      for (int a = 0; a < 3; ++a) origin(a, 32);
      for (int a = 0; a < 3; ++a) exponent(a);
      f(zero, 4);
      count(4);
      f(zero, 32);  // no oriented boxes
      for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
        plane(0, 0, i, 12, 0);
        plane(1, 0, i, 12, 0);
        f(zero, 8);
        plane(2, 0, i, 12, 0);
        plane(0, 1, i, 12, 1);
        f(zero, 8);
        plane(1, 1, i, 12, 1);
        plane(2, 1, i, 12, 1);
        f(zero, 4);
        records(i, 4);
      }
      break;
    case NodeFormat::kCw80: {
      for (int a = 0; a < 3; ++a) origin(a, 32);
      for (int a = 0; a < 3; ++a) exponent(a);
      std::uint32_t inner = 0;
      for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
        if ((boxes.used >> i & 1U) != 0 && children.records[i] == 0) inner |= 1U << i;
      }
      f(inner, 8);
      f(children.inner_base, 32);
      f(children.leaf_base, 32);
      // A byte per slot: 001 and 24 + slot of an inner child, a leaf's records in unary and the number of the first one
      // within the node, or 0.
      std::uint32_t next = 0, used = 0;
      for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
        const std::uint32_t n = children.records[i];
        std::uint32_t meta = (inner >> i & 1U) != 0 ? 1U << 5 | (24 + i) : n == 0 ? 0 : ((1U << n) - 1) << 5 | next;
        f(meta, 8);
        const bool is_inner = (inner >> i & 1U) != 0;
        children.records[i] = static_cast<std::uint8_t>(is_inner ? 0 : std::popcount(meta >> 5));
        next += children.records[i];
        if (meta != 0) used |= 1U << i;
      }
      boxes.used = used;
      for (int side = 0; side < 2; ++side) {
        for (int a = 0; a < 3; ++a) {
          for (std::uint32_t i = 0; i < kMaxWidth; ++i) plane(a, side, i, 8, 0);
        }
      }
      break;
    }
    case NodeFormat::kFp32:
    case NodeFormat::kHybrid:
      assert(false && "only quantised nodes are packed");
  }
}

}  // namespace

QuantisedBoxes quantise_boxes(const WideNode& node, NodeFormat format) {
  const NumberRange range = range_of(format);
  QuantisedBoxes out;
  for (std::uint32_t i = 0; i < kMaxWidth; ++i) out.used |= node.child[i] != kNoChild ? 1U << i : 0U;
  for (int axis = 0; axis < 3; ++axis) {
    float lower = kInfinity, upper = -kInfinity;
    for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
      if ((out.used >> i & 1U) == 0) continue;
      lower = std::min(lower, node.planes[axis][0][i]);
      upper = std::max(upper, node.planes[axis][1][i]);
    }
    if (out.used == 0) lower = upper = 0;
    out.origin[axis] = format == NodeFormat::kQ8 ? round_down_to_16_bits(lower) : lower;
    out.exponent[axis] = first_exponent(double{upper} - out.origin[axis], range.most_upper);
    while (!quantise_axis(node, axis, range, out)) {
      ++out.exponent[axis];
      assert(out.exponent[axis] <= kMostExponent);
    }
  }
  return out;
}

void decode_boxes(const QuantisedBoxes& boxes, WideNode& node) {
  for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
    const bool used = (boxes.used >> i & 1U) != 0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        node.planes[axis][side][i] =
            used ? decode_plane(boxes.origin[axis], step_of(boxes.exponent[axis]), boxes.planes[axis][side][i])
                 : (side == 0 ? kInfinity : -kInfinity);
      }
    }
  }
}

void quantise_nodes(std::span<WideNode> nodes, NodeFormat format) {
  for (WideNode& node : nodes) decode_boxes(quantise_boxes(node, format), node);
}

std::vector<std::byte> pack_node(const QuantisedBoxes& boxes, const ChildPlaces& children, NodeFormat format) {
  std::vector<std::byte> record(wide_node_bytes(format, kMaxWidth));
  RecordBitWriter to(record);
  QuantisedBoxes b = boxes;
  ChildPlaces c = children;
  for_each_field(format, b, c, [&](std::uint32_t& value, std::uint32_t bits) { to.put(value, bits); });
  return record;
}

void unpack_node(std::span<const std::byte> record, NodeFormat format, QuantisedBoxes& boxes, ChildPlaces& children) {
  boxes = {};
  children = {};
  boxes.used = (1U << kMaxWidth) - 1;  // until the number of children is read
  RecordBitReader from(record);
  for_each_field(format, boxes, children, [&](std::uint32_t& value, std::uint32_t bits) { value = from.get(bits); });
}

std::array<std::uint32_t, kMaxWidth> octant_slots(std::span<const glm::vec3> centre) {
  assert(centre.size() <= kMaxWidth);
  std::array<std::uint32_t, kMaxWidth> slots{};
  std::uint32_t free = (1U << kMaxWidth) - 1, waiting = (1U << centre.size()) - 1;
  while (waiting != 0) {
    float best = -kInfinity;
    std::uint32_t child = 0, slot = 0;
    for (std::uint32_t c = 0; c < centre.size(); ++c) {
      for (std::uint32_t s = 0; (waiting >> c & 1U) != 0 && s < kMaxWidth; ++s) {
        if ((free >> s & 1U) == 0) continue;
        float along = 0;  // how far the child is along a ray of octant s: bit a of s is set for a positive direction
        for (int a = 0; a < 3; ++a) along += (s >> a & 1U) != 0 ? centre[c][a] : -centre[c][a];
        if (along > best) {
          best = along;
          child = c;
          slot = s;
        }
      }
    }
    slots[child] = slot;
    free &= ~(1U << slot);
    waiting &= ~(1U << child);
  }
  return slots;
}

}  // namespace traces
