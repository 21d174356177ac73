#include "traces/accel/leaf_format.h"

#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"

// Pairs and blocks of triangles: bits, capacity, order.

namespace traces {
namespace {

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

}  // namespace
}  // namespace traces
