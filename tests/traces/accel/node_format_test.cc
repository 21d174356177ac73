#include "traces/accel/node_format.h"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"

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

}  // namespace
}  // namespace traces
