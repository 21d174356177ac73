#include "traces/accel/node_format.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/leaf_format.h"
#include "traces/accel/wide_format.h"
#include "traces/scenes/builtin.h"

// Tests of the layout of tree and triangle records in memory.

namespace traces {
namespace {

TEST(NodeFormat, HybridNumbersShrinkBoxesByFortyPercent) {
  EXPECT_EQ(box_bytes(BoxNumbers::kFp32, BoxRecords::kPair), 48U);
  EXPECT_EQ(box_bytes(BoxNumbers::kHybrid, BoxRecords::kPair), 29U);
  EXPECT_EQ(box_bytes(BoxNumbers::kFp32, BoxRecords::kSingle), 24U);
  EXPECT_NEAR(1 - 29.0 / 48, 0.40, 0.005);
}

TEST(NodeFormat, ARecordHoldsItsBoxesLinksAndFlags) {
  for (const BoxNumbers numbers : {BoxNumbers::kFp32, BoxNumbers::kHybrid}) {
    for (const BoxRecords boxes : {BoxRecords::kPair, BoxRecords::kSingle}) {
      const std::uint32_t count = boxes == BoxRecords::kPair ? 2 : 1;
      EXPECT_GE(8 * node_bytes(numbers, boxes), count * (6 * plane_bits(numbers) + 30 + 16));
    }
  }
}

Scene row_of_triangles(std::uint32_t count) {
  Scene scene = one_triangle();
  scene.instances.resize(count, scene.instances[0]);
  for (std::uint32_t i = 0; i < count; ++i) scene.instances[i].to_world[3].x = 10 * static_cast<float>(i);
  return scene;
}

MemoryImage image_of(std::uint32_t triangles, BoxNumbers numbers, BoxRecords boxes, std::uint32_t triangle_bytes = 48) {
  return build_memory_image(row_of_triangles(triangles),
                            {.leaf_size = 1, .numbers = numbers, .boxes = boxes, .triangle_bytes = triangle_bytes});
}

// Four triangles in a row: node 0 has the inner nodes 1 and 2, each with two leaves.
TEST(NodeFormat, PairsAreStoredAtTheirNodesIndex) {
  for (const auto& [numbers, bytes] : {std::pair{BoxNumbers::kFp32, 64U}, {BoxNumbers::kHybrid, 40U}}) {
    const Layout at = image_of(4, numbers, BoxRecords::kPair).layout;
    EXPECT_TRUE(at.single_boxes.empty());
    EXPECT_EQ(at.node_at(2) - at.nodes, 2 * bytes);
    EXPECT_EQ(at.triangles - at.nodes, numbers == BoxNumbers::kFp32 ? 192U : 128U) << "three records, on full lines";
  }
}

// Stored depth first: root 0; node 1 is record 1, its leaves 2 and 3; node 2 is record 4, its leaves 5 and 6.
TEST(NodeFormat, SingleBoxesAreStoredDepthFirstIncludingLeaves) {
  using Children = std::array<std::uint32_t, 2>;
  for (const auto& [numbers, bytes] : {std::pair{BoxNumbers::kFp32, 32U}, {BoxNumbers::kHybrid, 20U}}) {
    const MemoryImage image = image_of(4, numbers, BoxRecords::kSingle);
    ASSERT_EQ(image.nodes.size(), 3U);
    ASSERT_EQ(image.nodes[0].child[0], 1U);
    ASSERT_EQ(image.nodes[0].child[1], 2U);
    const Layout& at = image.layout;
    EXPECT_EQ(at.single_boxes, (std::vector<Children>{{1, 4}, {2, 3}, {5, 6}}));
    EXPECT_EQ(at.node_at(6) - at.nodes, 6 * bytes);
    EXPECT_EQ(image.node_array_bytes(), 7 * bytes);
    EXPECT_EQ(at.triangles - at.nodes, numbers == BoxNumbers::kFp32 ? 256U : 192U);
  }
}

TEST(NodeFormat, EveryRecordOfALargeTreeHasOneParentAndChildZeroFollowsIt) {
  const MemoryImage image = build_memory_image(triangle_soup(5000, 0.1F), {.boxes = BoxRecords::kSingle});
  const auto& children = image.layout.single_boxes;
  std::vector<int> named(2 * image.nodes.size() + 1, 0);
  std::vector<std::uint32_t> own(image.nodes.size(), 0);
  ++named[0];
  for (std::size_t i = 0; i < image.nodes.size(); ++i) {
    EXPECT_EQ(children[i][0], own[i] + 1);
    for (std::size_t c = 0; c < 2; ++c) {
      ++named.at(children[i][c]);
      if (!is_leaf(image.nodes[i].child[c])) own[image.nodes[i].child[c]] = children[i][c];
    }
  }
  EXPECT_EQ(std::ranges::count(named, 1), static_cast<std::ptrdiff_t>(named.size()));
}

TEST(NodeFormat, MissingChildrenHaveASingleBoxBecauseBothAreRead) {
  const MemoryImage one = build_memory_image(one_triangle(), {.boxes = BoxRecords::kSingle});
  EXPECT_EQ(one.layout.single_boxes, (std::vector<std::array<std::uint32_t, 2>>{{1, 2}}));
  EXPECT_EQ(one.node_array_bytes(), 96U);
}

TEST(TriangleFormat, VerticesTakeThirtySixBytesAndLabelsFollowAllTriangles) {
  const Layout wide = image_of(4, BoxNumbers::kFp32, BoxRecords::kPair, 48).layout;
  EXPECT_FALSE(wide.has_labels());
  EXPECT_EQ(wide.triangle_at(3) - wide.triangles, 144U);
  EXPECT_EQ(wide.attributes - wide.triangles, 192U);

  const Layout narrow = image_of(4, BoxNumbers::kFp32, BoxRecords::kPair, 36).layout;
  EXPECT_TRUE(narrow.has_labels());
  EXPECT_EQ(narrow.triangle_at(3) - narrow.triangles, 108U);
  EXPECT_EQ(narrow.labels - narrow.triangles, 192U) << "144 bytes, on full lines";
  EXPECT_EQ(narrow.label_at(3) - narrow.labels, 36U);
  EXPECT_EQ(narrow.attributes - narrow.labels, 64U);
}

TEST(Formats, InMemoryDoNotChangeTheTree) {
  const std::string expected = bvh_hash(build_memory_image(triangle_soup(500, 0.1F)));
  for (const BoxRecords boxes : {BoxRecords::kPair, BoxRecords::kSingle}) {
    for (const std::uint32_t bytes : {36U, 48U}) {
      EXPECT_EQ(bvh_hash(build_memory_image(triangle_soup(500, 0.1F), {.boxes = boxes, .triangle_bytes = bytes})),
                expected);
    }
  }
}

// Quantised nodes: bits, rounding, empty slots.

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

// Pairs and blocks of triangles: bits, capacity, order.

bool same_vertices(const TriangleRecord& a, const TriangleRecord& b) { return std::memcmp(&a.v0, &b.v0, 36) == 0; }

TEST(LeafFormat, RecordsGiveBackEveryBit) {
  for (const Scene& scene :
       {sphere(24, 48), triangle_soup(500, 0.2F), grid_soup(500), with_transparent_triangles(sphere(12, 24))}) {
    for (const LeafFormat format : {LeafFormat::kPair64, LeafFormat::kBlock128}) {
      const MemoryImage image = build_memory_image(scene, {.leaf_size = 8, .leaf = format});
      ASSERT_EQ(image.begins_record.size(), image.triangles.size());
      std::size_t records = 0;
      for (std::size_t first = 0; first < image.triangles.size(); ++records) {
        ASSERT_TRUE(image.begins_record[first]);
        std::size_t end = first + 1;
        while (end < image.triangles.size() && !image.begins_record[end]) ++end;
        const auto triangles = std::span(image.triangles).subspan(first, end - first);
        const auto record = pack_leaf_record(triangles, format);
        ASSERT_TRUE(record.has_value());
        EXPECT_EQ(record->size(), format == LeafFormat::kPair64 ? 64U : 128U);
        const std::vector<TriangleRecord> back = unpack_leaf_record(*record, format);
        ASSERT_EQ(back.size(), triangles.size());
        for (std::size_t i = 0; i < back.size(); ++i) {
          ASSERT_TRUE(same_vertices(back[i], triangles[i]));
          if (format == LeafFormat::kPair64) {
            ASSERT_EQ(std::memcmp(&back[i], &triangles[i], sizeof back[i]), 0);
          } else {
            ASSERT_EQ(back[i].hit_flags(), triangles[i].hit_flags());
          }
        }
        first = end;
      }
      EXPECT_EQ(image.layout.leaf_bytes, records * (format == LeafFormat::kPair64 ? 64 : 128));
    }
  }
}

TEST(LeafFormat, RecordsAreWithinLeaves) {
  const MemoryImage image = build_memory_image(sphere(24, 48), {.width = 4, .leaf = LeafFormat::kPair64});
  const std::vector<std::uint32_t> leaves = triangle_leaves(image);
  EXPECT_EQ(leaves.size(), bvh_info(image).leaves);
  for (const std::uint32_t link : leaves) EXPECT_TRUE(image.begins_record[leaf_first(link)]);
}

TEST(LeafFormat, PairsShareAnEdge) {
  const MemoryImage image = build_memory_image(sphere(24, 48), {.leaf = LeafFormat::kPair64});
  const auto singles = static_cast<double>(std::ranges::count(image.begins_record, true));
  EXPECT_LT(singles, 0.8 * static_cast<double>(image.triangles.size())) << "neighbours of a closed surface";
  TriangleRecord a{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 3, 4, 5}, b{{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, 3, 4, 6};
  EXPECT_TRUE(can_pair(a, b));
  b.v2.x = 0.5F;
  EXPECT_FALSE(can_pair(a, b)) << "one vertex in common";
  b.v2.x = 0;
  b.object = 2;
  EXPECT_FALSE(can_pair(a, b)) << "another object";
  b.object = 3;
  b.source = a.source + 32768;
  EXPECT_FALSE(can_pair(a, b)) << "the difference of the numbers needs 17 bits";
  b.source = a.source - 5;
  EXPECT_TRUE(can_pair(a, b));
}

TEST(LeafFormat, ABlockHasTheStatedSize) {
  // Bits of 1, 2 and 4 differ in the exponent: 0x3f800000, 0x40000000, 0x40800000.
  const TriangleRecord t{{1, 2, 4}, {2, 2, 4}, {1, 4, 4}, 0, 0, 0};
  // 23 trailing zeros. x: bits 23 to 30 differ, 8 stored, 1 in common; y: 0x40000000, 0x40800000 differ in bit 23
  // alone: 1 stored, 8 in common; z: all equal, 1 stored, 8 in common.
  EXPECT_EQ(block_bits({&t, 1}), 28U + 16U + (1 + 8 + 8) + 3 * (8 + 1 + 1));
  Dice dice(3);
  std::vector<TriangleRecord> random(3);
  for (TriangleRecord& r : random) r = {dice.point(), dice.point(), dice.point(), 0, 0, 0};
  EXPECT_LE(block_bits(random), kBlockBits) << "three triangles always fit";
  EXPECT_LE(28 + 3 * 16 + 9 * 96, static_cast<int>(kBlockBits));
}

// Tests that boxes in hybrid number format contain those in floats.

/// Expects that all boxes of `hybrid` are integers of 19 bits, and contain those of `floats` with at most one step of
/// margin on each side.
void expect_around(const MemoryImage& hybrid, const MemoryImage& floats) {
  ASSERT_TRUE(hybrid.grid.has_value());
  const BoxGrid& grid = *hybrid.grid;
  ASSERT_EQ(hybrid.nodes.size(), floats.nodes.size());
  for (std::size_t i = 0; i < floats.nodes.size(); ++i) {
    const NodeRecord &h = hybrid.nodes[i], &f = floats.nodes[i];
    for (int c = 0; c < 2; ++c) {
      ASSERT_EQ(h.child[c], f.child[c]);
      if (f.child[c] == kNoChild) continue;
      const float* planes[2][3] = {{h.x, h.y, h.z}, {f.x, f.y, f.z}};
      for (int a = 0; a < 3; ++a) {
        const float low = planes[0][a][c], high = planes[0][a][2 + c];
        const float lower = planes[1][a][c], upper = planes[1][a][2 + c];
        ASSERT_TRUE(low == std::floor(low) && high == std::floor(high));
        ASSERT_TRUE(low >= 0 && low <= high && high <= 524287) << low << " to " << high;
        ASSERT_LE(grid.plane_position(low, a), lower);
        ASSERT_GE(grid.plane_position(high, a), upper);
        ASSERT_GE(grid.plane_position(low + 1.0, a), lower);
        ASSERT_LE(grid.plane_position(high - 1.0, a), upper);
      }
    }
  }
}

TEST(HybridBoxes, ContainFloatBoxesWithinAStepInBuiltInScenes) {
  for (const BuiltinInfo& info : builtin_scenes()) {
    SCOPED_TRACE(info.name);
    if (info.triangles > 100'000 && info.name != "hairball") continue;  // larger scenes take seconds to build
    const MemoryImage floats = build_memory_image(build_scene(info.name, {.triangles = 20000}));
    MemoryImage hybrid = floats;
    round_boxes_to_grid(hybrid);
    expect_around(hybrid, floats);
  }
}

TEST(HybridBoxes, ContainFloatBoxesInFlatTinyHugeAndFarScenes) {
  for (const glm::vec3 scale : {glm::vec3(1), glm::vec3(1, 0, 1), glm::vec3(0, 3, 0), glm::vec3(1, 1, 1e-7F),
                                glm::vec3(1e-20F), glm::vec3(1e20F, 1, 1)}) {
    for (const float offset : {0.0F, -7.0F, 1e6F, -1e12F}) {
      SCOPED_TRACE(testing::Message() << scale.x << " " << scale.y << " " << scale.z << " at " << offset);
      Scene scene = triangle_soup(300, 0.2F);
      for (glm::vec3& p : scene.meshes[0].positions) p = p * scale + offset;
      expect_around(build_memory_image(scene, {.numbers = BoxNumbers::kHybrid}), build_memory_image(scene));
    }
  }
}

TEST(HybridBoxes, OfAMovedSceneUseAGridOfItsNewBounds) {
  const Scene scene = triangle_soup(500, 0.1F);
  Scene moved = scene;
  for (glm::vec3& p : moved.meshes[0].positions) p = p * glm::vec3(3, 1, 0.5F) + 10.0F;
  const BvhConfig config{.numbers = BoxNumbers::kHybrid};
  MemoryImage hybrid = build_memory_image(scene, config), floats = build_memory_image(scene);
  const BoxGrid before = *hybrid.grid;
  refit_memory_image(moved, hybrid);
  refit_memory_image(moved, floats);
  EXPECT_FALSE(*hybrid.grid == before);
  EXPECT_EQ(hybrid.grid->lower_corner(), hybrid.lower);
  expect_around(hybrid, floats);
  refit_memory_image(scene, hybrid);
  EXPECT_EQ(bvh_hash(hybrid), bvh_hash(build_memory_image(scene, config))) << "and back";
}

TEST(HybridBoxes, HaveAnotherHashAndAboutEqualCost) {
  const Scene scene = triangle_soup(2000, 0.05F);
  const MemoryImage hybrid = build_memory_image(scene, {.numbers = BoxNumbers::kHybrid});
  const MemoryImage floats = build_memory_image(scene);
  EXPECT_NE(bvh_hash(hybrid), bvh_hash(floats));
  MemoryImage elsewhere = hybrid;
  elsewhere.grid = BoxGrid(hybrid.lower - 1.0F, hybrid.upper - 1.0F);
  EXPECT_NE(bvh_hash(hybrid), bvh_hash(elsewhere)) << "the same planes of another grid";
  const double cost = bvh_info(floats).sah_cost;
  EXPECT_GT(bvh_info(hybrid).sah_cost, cost);
  EXPECT_LT(bvh_info(hybrid).sah_cost, 1.001 * cost);
}

TEST(BoxGrid, SpreadsItsPlanesOverTheScene) {
  const BoxGrid grid({-1, 0, 5}, {1, 4, 5});
  EXPECT_EQ(grid.plane_below(-1, 0), 0);
  EXPECT_GE(grid.plane_above(1, 0), 524286) << "of 524287";
  EXPECT_FLOAT_EQ(grid.plane_spacing().x, 2.0F / 524286);
  EXPECT_FLOAT_EQ(grid.plane_spacing().y, 4.0F / 524286);
  EXPECT_FLOAT_EQ(grid.plane_spacing().z, 4.0F / 1024 / 524286) << "flat";
  EXPECT_EQ(grid.plane_below(5, 2), 0);
  EXPECT_EQ(grid.plane_above(5, 2), 0);
  const auto on_plane = static_cast<float>(grid.plane_position(3, 0));
  EXPECT_LE(grid.plane_below(on_plane, 0), 3);
  EXPECT_GE(grid.plane_above(on_plane, 0), 3);
}

}  // namespace
}  // namespace traces
