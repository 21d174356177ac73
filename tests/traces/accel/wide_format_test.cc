#include "traces/accel/wide_format.h"

#include <bit>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"

// Quantised nodes: bits, rounding, empty slots.

namespace traces {
namespace {

constexpr NodeFormat kQuantised[] = {NodeFormat::kQ8, NodeFormat::kQ12, NodeFormat::kCw80};

/// Returns a node with boxes around `centre` of up to `size`; `used` has a bit for each slot with a child.
WideNode random_node(Dice& dice, std::uint32_t used, float centre, float size) {
  WideNode node;
  const glm::vec3 at = dice.point() * centre;
  for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
    node.child[i] = (used >> i & 1U) != 0 ? i : kNoChild;
    for (int a = 0; a < 3; ++a) {
      const float x = at[a] + dice.between(-size, size), y = dice.below(5) == 0 ? x : at[a] + dice.between(-size, size);
      node.planes[a][0][i] = std::min(x, y);
      node.planes[a][1][i] = std::max(x, y);
    }
  }
  return node;
}

std::uint32_t random_slots(Dice& dice, NodeFormat format) {
  return format == NodeFormat::kCw80 ? 1 + dice.below(255) : (2U << dice.below(8)) - 1;
}

TEST(QuantisedNodes, ContainTheExactBoxesUnderTheDecodersArithmetic) {
  Dice dice(21);
  for (const NodeFormat format : kQuantised) {
    for (int i = 0; i < 20000; ++i) {
      // Also nodes that are small and far from the origin, where the decoder's sum rounds.
      const float centre = std::ldexp(1.0F, static_cast<int>(dice.below(60)) - 30);
      const float size = std::ldexp(1.0F, static_cast<int>(dice.below(60)) - 30);
      const std::uint32_t used = random_slots(dice, format);
      const WideNode exact = random_node(dice, used, centre, size);
      WideNode stored = exact;
      decode_boxes(quantise_boxes(exact, format), stored);
      for (int a = 0; a < 3; ++a) {
        for (std::uint32_t s = 0; s < kMaxWidth; ++s) {
          if ((used >> s & 1U) != 0) {
            ASSERT_LE(stored.planes[a][0][s], exact.planes[a][0][s]) << i;
            ASSERT_GE(stored.planes[a][1][s], exact.planes[a][1][s]) << i;
          } else {
            ASSERT_EQ(stored.planes[a][0][s], std::numeric_limits<float>::infinity());
            ASSERT_EQ(stored.planes[a][1][s], -std::numeric_limits<float>::infinity());
          }
        }
      }
    }
  }
}

TEST(QuantisedNodes, AreAtMostTwoStepsLargerOnASide) {
  Dice dice(22);
  for (const NodeFormat format : kQuantised) {
    for (int i = 0; i < 2000; ++i) {
      const WideNode exact = random_node(dice, 255, 1, 1);
      const QuantisedBoxes boxes = quantise_boxes(exact, format);
      WideNode stored = exact;
      decode_boxes(boxes, stored);
      for (int a = 0; a < 3; ++a) {
        const float step = std::ldexp(1.0F, boxes.exponent[a]);
        EXPECT_LE(step, 4.0F * 2 / (format == NodeFormat::kQ12 ? 4096 : 255)) << "a power of two above the extent";
        for (std::uint32_t s = 0; s < kMaxWidth; ++s) {
          ASSERT_GT(stored.planes[a][0][s], exact.planes[a][0][s] - 2 * step);
          ASSERT_LT(stored.planes[a][1][s], exact.planes[a][1][s] + 2 * step);
        }
      }
    }
  }
}

TEST(QuantisedNodes, AreReadAsTheyWerePacked) {
  Dice dice(23);
  for (const NodeFormat format : kQuantised) {
    for (int i = 0; i < 2000; ++i) {
      const std::uint32_t used = random_slots(dice, format);
      const WideNode exact = random_node(dice, used, 8, std::ldexp(1.0F, static_cast<int>(dice.below(30)) - 15));
      const QuantisedBoxes boxes = quantise_boxes(exact, format);
      ChildPlaces places{.inner_base = dice.below(1U << 27), .leaf_base = dice.below(1U << 30), .parent = 77};
      if (format == NodeFormat::kQ8) places.leaf_base = 0;
      if (format != NodeFormat::kQ12) places.parent = 0;
      for (std::uint32_t s = 0; s < kMaxWidth; ++s) {
        if ((used >> s & 1U) != 0) {
          places.records[s] = static_cast<std::uint8_t>(dice.below(most_leaf_records(format) + 1));
        }
      }
      const std::vector<std::byte> record = pack_node(boxes, places, format);
      EXPECT_EQ(record.size(), format == NodeFormat::kQ8 ? 64U : format == NodeFormat::kQ12 ? 128U : 80U);
      QuantisedBoxes read;
      ChildPlaces read_places;
      unpack_node(record, format, read, read_places);
      ASSERT_EQ(read.used, used);
      ASSERT_EQ(read_places, places);
      WideNode expected = exact, found = exact;
      decode_boxes(boxes, expected);
      decode_boxes(read, found);
      ASSERT_EQ(std::memcmp(&expected, &found, sizeof found), 0) << i;
    }
  }
}

TEST(QuantisedNodes, HaveTheFieldsOfAdrenoAtTheirPlaces) {
  WideNode node;
  for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
    node.child[i] = i < 2 ? i : kNoChild;
    for (int a = 0; a < 3; ++a) {
      node.planes[a][0][i] = 1 + static_cast<float>(i);
      node.planes[a][1][i] = 2 + static_cast<float>(i);
    }
  }
  const std::vector<std::byte> record =
      pack_node(quantise_boxes(node, NodeFormat::kQ8), {.inner_base = 9}, NodeFormat::kQ8);
  const auto byte = [&](std::size_t i) { return std::to_integer<unsigned>(record[i]); };
  EXPECT_EQ(byte(0), 9U) << "base of the children";
  EXPECT_EQ(byte(3), 1U << 3) << "children less one, above 27 bits of base";
  EXPECT_EQ(byte(4) | byte(5) << 8, 0x3f80U) << "1.0 without its lower half";
  // From 1 to 3 in steps of 1/64: 128 steps.
  EXPECT_EQ(byte(58), 127U - 6) << "exponent of the step";
  EXPECT_EQ(byte(10), 0U) << "lower x of child 0";
  EXPECT_EQ(byte(13), 64U) << "upper x of child 0";
  EXPECT_EQ(byte(16), 64U) << "lower x of child 1";
  EXPECT_EQ(byte(19), 128U) << "upper x of child 1";
  EXPECT_EQ(byte(22), 255U) << "an empty slot is inverted";
  EXPECT_EQ(byte(25), 0U);
}

TEST(QuantisedNodes, PutChildrenIntoSlotsOfTheirOctants) {
  std::vector<glm::vec3> corners;
  for (std::uint32_t i = 0; i < kMaxWidth; ++i) {
    corners.emplace_back((i & 1U) != 0 ? 1 : -1, (i & 2U) != 0 ? 1 : -1, (i & 4U) != 0 ? 1 : -1);
  }
  const auto slots = octant_slots(corners);
  for (std::uint32_t i = 0; i < kMaxWidth; ++i) EXPECT_EQ(slots[i], i);
}

}  // namespace
}  // namespace traces
