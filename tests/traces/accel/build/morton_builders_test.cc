#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/traces/accel/support.h"
#include "traces/accel/build/lbvh.h"
#include "traces/accel/build/morton_order.h"
#include "traces/accel/build/ploc.h"

// Tests of the Morton order and of the trees of lbvh and ploc, compared with definitions written as plain loops.

namespace traces {
namespace {

std::vector<Bounds> random_boxes(std::uint32_t count, float size, std::uint64_t seed = 1) {
  Dice dice(seed);
  std::vector<Bounds> boxes(count);
  for (Bounds& box : boxes) {
    box.lower = dice.point();
    box.upper = box.lower + dice.point(0, size);
  }
  return boxes;
}

/// Returns boxes. Many of them have equal centres or sizes.
std::vector<Bounds> grid_boxes(std::uint32_t count) {
  Dice dice(3);
  std::vector<Bounds> boxes(count);
  for (Bounds& box : boxes) {
    const glm::vec3 at(dice.below(4), dice.below(4), dice.below(4));
    box = {at, at + glm::vec3(1 + dice.below(2), 1, 1)};
  }
  return boxes;
}

TEST(MortonCode, InterleavesTheBitsOfTheAxes) {
  EXPECT_EQ(morton_code(1, 0, 0, 24), 0b100U);
  EXPECT_EQ(morton_code(0, 1, 0, 24), 0b010U);
  EXPECT_EQ(morton_code(0, 0, 1, 24), 0b001U);
  EXPECT_EQ(morton_code(0b11, 0b01, 0b10, 24), 0b101110U);
  for (const std::uint32_t bits : {24U, 30U, 63U}) {
    const std::uint32_t most = (1U << (bits / 3)) - 1;
    EXPECT_EQ(morton_code(most, most, most, bits), (std::uint64_t{1} << bits) - 1);
    EXPECT_EQ(morton_code(most ^ most >> 1, 0, 0, bits), std::uint64_t{1} << (bits - 1)) << "x is highest";
  }
}

TEST(MortonOrder, SortsByCodeAndThenByInputIndex) {
  for (const std::uint32_t bits : {24U, 30U, 63U}) {
    for (const std::uint32_t mask_bits : {bits, 3U}) {
      Dice dice(bits);
      MortonOrder order;
      for (std::uint32_t i = 0; i < 3000; ++i) {
        order.items.push_back(i);
        order.codes.push_back(sim::hash(bits, i) & ((std::uint64_t{1} << mask_bits) - 1));
      }
      MortonOrder expected = order;
      std::ranges::stable_sort(expected.items, {}, [&](std::uint32_t i) { return order.codes[i]; });
      std::ranges::sort(expected.codes);
      sort_by_code(order, bits);
      EXPECT_EQ(order.items, expected.items);
      EXPECT_EQ(order.codes, expected.codes);
    }
  }
}

TEST(MortonOrder, PlacesCentresOnACubicGrid) {
  // Centres from 0 to 256 along x and 0 to 128 along y: cells of size 1 with 24 bits.
  const auto box_at = [](float x, float y) { return Bounds{{x - 1, y - 1, 0}, {x + 1, y + 1, 0}}; };
  const std::vector<Bounds> boxes = {box_at(256, 128), box_at(0, 0), box_at(3.5F, 1.25F), box_at(200, 0)};
  const MortonOrder order = morton_order(boxes, 24);
  EXPECT_EQ(order.items, (std::vector<std::uint32_t>{1, 2, 3, 0}));
  EXPECT_EQ(order.codes, (std::vector<std::uint64_t>{0, morton_code(3, 1, 0, 24), morton_code(200, 0, 0, 24),
                                                     morton_code(255, 128, 0, 24)}));
}

TEST(MortonOrder, HasOneCodeForEqualCentresAndStaysDefinedForNumbersWithoutLimit) {
  EXPECT_EQ(morton_order(std::vector<Bounds>(9, Bounds{{1, 2, 3}, {4, 5, 6}}), 63).codes,
            std::vector<std::uint64_t>(9, 0));
  constexpr float kHuge = 3e38F, kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Bounds> odd = {
      {{kHuge, 0, 0}, {kHuge, 0, 0}}, {{-kHuge, 0, 0}, {-kHuge, 0, 0}}, {{kNan, 0, 0}, {kNan, 0, 0}}};
  std::vector<std::uint32_t> items = morton_order(odd, 30).items;
  std::ranges::sort(items);
  EXPECT_EQ(items, (std::vector<std::uint32_t>{0, 1, 2}));
}

/// Returns the smallest box around a tree's positions, and fails unless children and boxes fit.
Bounds box_of_positions(const BinaryTree& tree, std::span<const std::uint32_t> positions) {
  Bounds box;
  for (const std::uint32_t i : positions) {
    box.add(tree.boxes[i].lower);
    box.add(tree.boxes[i].upper);
  }
  return box;
}

/// Fails unless the subtree `link` covers positions [first, end) with splits at the highest differing bit.
void expect_lbvh_subtree(const BinaryTree& tree, const std::vector<std::uint64_t>& codes, std::uint32_t link,
                         std::uint32_t first, std::uint32_t end) {
  if (end - first == 1) {
    EXPECT_EQ(link, leaf_link(first, 1));
    return;
  }
  ASSERT_FALSE(is_leaf(link));
  // The first position with the highest differing bit set. Positions are the lower part of the key.
  const bool equal = codes[first] == codes[end - 1];
  const auto key = [&](std::uint32_t i) { return equal ? i : codes[i]; };
  std::uint64_t bit = 1;
  while ((key(first) ^ key(end - 1)) >= 2 * bit) bit *= 2;
  std::uint32_t split = first;
  while ((key(split) & bit) == 0) ++split;
  std::vector<std::uint32_t> positions(end - first);
  std::iota(positions.begin(), positions.end(), first);
  EXPECT_EQ(tree.nodes[link].box.lower, box_of_positions(tree, positions).lower);
  EXPECT_EQ(tree.nodes[link].box.upper, box_of_positions(tree, positions).upper);
  expect_lbvh_subtree(tree, codes, tree.nodes[link].child[0], first, split);
  expect_lbvh_subtree(tree, codes, tree.nodes[link].child[1], split, end);
}

TEST(Lbvh, SplitsAtTheHighestDifferingBitOfCodeAndPosition) {
  for (const std::vector<Bounds>& boxes :
       {random_boxes(1000, 0.1F), grid_boxes(1000), random_boxes(1, 1), random_boxes(2, 1),
        std::vector<Bounds>(777, Bounds{{0, 0, 0}, {1, 1, 1}})}) {
    for (const std::uint32_t bits : {24U, 63U}) {
      const BinaryTree tree = build_lbvh(boxes, {.morton_bits = bits}, nullptr);
      const MortonOrder order = morton_order(boxes, bits);
      EXPECT_EQ(tree.items, order.items);
      const auto count = static_cast<std::uint32_t>(boxes.size());
      ASSERT_EQ(tree.nodes.size(), count - 1);
      expect_lbvh_subtree(tree, order.codes, count == 1 ? leaf_link(0, 1) : count - 2, 0, count);
    }
  }
}

float merged_half_area(Bounds a, const Bounds& b) {
  a.add(b.lower);
  a.add(b.upper);
  const glm::vec3 d = a.upper - a.lower;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

/// PLOC as its rules define it: every cluster tries every neighbour.
struct PlainPloc {
  std::vector<BinaryTree::Node> nodes;
  std::vector<std::uint32_t> clusters;
};
PlainPloc run_plain_ploc(const BinaryTree& input, std::uint32_t radius) {
  PlainPloc out;
  struct Cluster {
    std::uint32_t link;
    Bounds box;
  };
  std::vector<Cluster> active;
  for (std::uint32_t i = 0; i < input.items.size(); ++i) active.push_back({leaf_link(i, 1), input.boxes[i]});
  while (active.size() > 1) {
    const auto count = static_cast<std::uint32_t>(active.size());
    out.clusters.push_back(count);
    const auto partner_of = [&](std::uint32_t i) {
      std::optional<std::uint32_t> best;
      // Order of rules 2 and 3: area, distance, pairs that begin at an even position, earlier position.
      const auto rank = [&](std::uint32_t j) {
        const std::uint32_t low = std::min(i, j);
        return std::tuple(merged_half_area(active[i].box, active[j].box), std::max(i, j) - low, low % 2, low);
      };
      for (std::uint32_t j = i - std::min(i, radius); j <= std::min(i + radius, count - 1); ++j) {
        if (j != i && (!best || rank(j) < rank(*best))) best = j;
      }
      return *best;
    };
    std::vector<std::uint32_t> partners;
    for (std::uint32_t i = 0; i < count; ++i) partners.push_back(partner_of(i));
    std::uint32_t pairs = 0;
    for (std::uint32_t i = 0; i < count; ++i) pairs += partners[i] > i && partners[partners[i]] == i ? 1 : 0;
    if (count >= 256 && 64 * pairs < count) {
      for (std::uint32_t i = 0; i < count; ++i) partners[i] = (i ^ 1U) < count ? i ^ 1U : i;
    }
    std::vector<Cluster> next;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t j = partners[i];
      if (j == i || partners[j] != i) {
        next.push_back(active[i]);
      } else if (i < j) {
        Bounds box = active[i].box;
        box.add(active[j].box.lower);
        box.add(active[j].box.upper);
        out.nodes.push_back({box, {active[i].link, active[j].link}});
        next.push_back({static_cast<std::uint32_t>(out.nodes.size()) - 1, box});
      }
    }
    active = next;
  }
  return out;
}

std::vector<Bounds> nested_boxes(std::uint32_t count) {
  std::vector<Bounds> boxes(count);
  for (std::uint32_t i = 0; i < count; ++i)
    boxes[i] = {glm::vec3(-1.0F - static_cast<float>(i)), glm::vec3(1.0F + static_cast<float>(i))};
  return boxes;
}

TEST(Ploc, MergesTheClustersThatAPlainSearchMerges) {
  // More clusters than a block of the search, fewer than the radius, equal areas, rounds with few pairs.
  for (const std::vector<Bounds>& boxes :
       {random_boxes(1500, 0.1F), random_boxes(513, 0.5F), grid_boxes(1100), random_boxes(5, 1), random_boxes(2, 1),
        random_boxes(1, 1), nested_boxes(600), std::vector<Bounds>(555, Bounds{{0, 0, 0}, {1, 1, 1}})}) {
    for (const std::uint32_t radius : {8U, 16U}) {
      std::vector<std::uint32_t> clusters;
      const BinaryTree tree = build_ploc(boxes, {.ploc_radius = radius}, nullptr, clusters);
      const PlainPloc expected = run_plain_ploc(tree, radius);
      EXPECT_EQ(clusters, expected.clusters);
      EXPECT_EQ(tree.items, morton_order(boxes, 30).items);
      ASSERT_EQ(tree.nodes.size(), expected.nodes.size());
      for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        EXPECT_EQ(tree.nodes[i].child[0], expected.nodes[i].child[0]);
        EXPECT_EQ(tree.nodes[i].child[1], expected.nodes[i].child[1]);
        EXPECT_EQ(tree.nodes[i].box.lower, expected.nodes[i].box.lower);
        EXPECT_EQ(tree.nodes[i].box.upper, expected.nodes[i].box.upper);
      }
    }
  }
}

TEST(Ploc, HalvesEqualBoxesInEachRound) {
  std::vector<std::uint32_t> clusters;
  build_ploc(std::vector<Bounds>(100'000, Bounds{{0, 0, 0}, {1, 1, 1}}), {}, nullptr, clusters);
  ASSERT_EQ(clusters.size(), 17U);
  for (std::size_t i = 1; i < clusters.size(); ++i) EXPECT_EQ(clusters[i], (clusters[i - 1] + 1) / 2);
}

TEST(Ploc, MergesAPairPer64ClustersUntilFewAreLeft) {
  for (const std::vector<Bounds>& boxes : {nested_boxes(20'000), random_boxes(20'000, 0.01F), grid_boxes(20'000)}) {
    std::vector<std::uint32_t> clusters;
    build_ploc(boxes, {}, nullptr, clusters);
    for (std::size_t i = 1; i < clusters.size(); ++i) {
      EXPECT_LT(clusters[i], clusters[i - 1]);
      if (clusters[i - 1] >= 256) {
        EXPECT_LE(64 * clusters[i], 63 * clusters[i - 1] + 63);
      }
    }
    EXPECT_LE(std::accumulate(clusters.begin(), clusters.end(), std::uint64_t{0}), 64 * boxes.size() + 256 * 256 / 2);
  }
}

TEST(Ploc, StopsWhenItIsCancelled) {
  std::vector<std::uint32_t> clusters;
  const std::vector<Bounds> boxes = random_boxes(100, 0.1F);
  EXPECT_THROW(build_ploc(
                   boxes, {}, [] { return true; }, clusters),
               sim::Cancelled);
  EXPECT_THROW(build_lbvh(boxes, {}, [] { return true; }), sim::Cancelled);
}

}  // namespace
}  // namespace traces
