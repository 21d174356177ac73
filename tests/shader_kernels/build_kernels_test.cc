#include "shader_kernels/programs/build_kernels.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <string_view>

#include <gtest/gtest.h>

#include "traces/accel/build.h"
#include "traces/scenes/library.h"

// Tests of building a tree with kernels.

namespace kernels {
namespace {

constexpr std::uint32_t kSpace = 64 * 1024;

traces::MemoryImage image_of(const char* scene, std::uint32_t leaf_size = 4) {
  traces::BvhConfig bvh;
  bvh.leaf_size = leaf_size;
  return traces::build_memory_image(traces::open_scene(scene), bvh, 1);
}

TEST(BuildKernels, EncodeTheNodesOfTheHost) {
  for (const char* scene : {"cornell", "teapot"}) {
    for (const std::uint32_t leaf_size : {1U, 4U}) {
      const traces::MemoryImage image = image_of(scene, leaf_size);
      const KernelBuildResult built = run_build_kernels(image);
      ASSERT_EQ(built.nodes.size(), image.nodes.size());
      for (std::size_t i = 0; i < built.nodes.size(); ++i) {
        const traces::NodeRecord &kernel = built.nodes[i], &host = image.nodes[i];
        EXPECT_TRUE(std::equal(kernel.x, kernel.x + 4, host.x) && std::equal(kernel.y, kernel.y + 4, host.y) &&
                    std::equal(kernel.z, kernel.z + 4, host.z) &&
                    std::equal(kernel.child, kernel.child + 2, host.child))
            << scene << ", node " << i;
      }
      ASSERT_EQ(built.leaves.size(), image.triangles.size());
      EXPECT_EQ(std::memcmp(built.leaves.data(), image.triangles.data(), 48 * built.leaves.size()), 0) << scene;
      EXPECT_EQ(built.unions, image.triangles.size() - 1) << scene << ": a hierarchy over triangles has one node less";
    }
  }
}

TEST(BuildKernels, SortKeysStably) {
  const KernelBuildResult built = run_build_kernels(image_of("teapot"));
  std::vector<KernelBuildResult::Key> expected = built.keys;
  std::ranges::stable_sort(expected, {}, &KernelBuildResult::Key::key);
  ASSERT_EQ(built.sorted.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(built.sorted[i].key, expected[i].key) << i;
    EXPECT_EQ(built.sorted[i].number, expected[i].number) << i;
  }
  EXPECT_GT(std::ranges::max(built.keys, {}, &KernelBuildResult::Key::key).key, 1U << 20);
  EXPECT_LT(std::ranges::max(built.keys, {}, &KernelBuildResult::Key::key).key, 1U << 24);
}

TEST(BuildKernels, LinkEachNodeToOneParentWithTwoChildren) {
  const KernelBuildResult built = run_build_kernels(image_of("teapot"));
  const std::size_t triangles = built.keys.size();
  EXPECT_EQ(built.links, 2 * (triangles - 1)) << "all triangles and nodes but the root";
  std::multiset<std::uint32_t> parents(built.parents.begin(), built.parents.end());
  for (std::uint32_t boundary = 0; boundary + 1 < triangles; ++boundary)
    EXPECT_EQ(parents.count(boundary), 2U) << boundary;
}

TEST(BuildKernels, MoveTheBytesOfTheClosedForms) {
  const traces::MemoryImage image = image_of("teapot");
  const KernelBuild plan(image, kSpace);
  const double triangles = static_cast<double>(image.triangles.size());
  const auto per_triangle = [&](std::initializer_list<std::string_view> names) {
    std::uint64_t bytes = 0;
    for (const KernelPass& pass : plan.passes()) {
      if (std::ranges::find(names, pass.name) != names.end()) bytes += pass.moved_bytes();
    }
    return static_cast<double>(bytes) / triangles;
  };
  const double nodes = 64 * static_cast<double>(image.nodes.size()) / triangles;
  EXPECT_NEAR(per_triangle({"leaf"}), 48 + 68 + 8, 0.1);
  EXPECT_NEAR(per_triangle({"histogram", "scan", "scatter"}), 56, 5.6);
  EXPECT_NEAR(per_triangle({"link", "fit"}), 128, 12.8);
  EXPECT_NEAR(per_triangle({"encode_nodes", "encode_leaves"}), 68 + 40 + 48 + nodes, 0.1 * (156 + nodes));
  const double all =
      per_triangle({"leaf", "histogram", "scan", "scatter", "link", "fit", "encode_nodes", "encode_leaves"});
  const double unit = 48 + 16 + 48 + 48 + nodes;  // the tree builder with records of 8 bytes
  EXPECT_GE(all / unit, 2.0);
  EXPECT_LE(all / unit, 3.5);
}

TEST(BuildKernels, FitTheirSpaceAndCoverAllItems) {
  const KernelBuild plan(image_of("cornell"), kSpace);
  for (const KernelPass& pass : plan.passes()) {
    std::uint64_t bytes = 0;
    for (const BuildStream& s : pass.streams) bytes += s.by_batch ? s.bytes : s.bytes * pass.batch / pass.items;
    EXPECT_LE(bytes, kSpace) << pass.name;
    for (const BuildStream& s : pass.streams) {
      const std::uint64_t end = s.base + s.bytes * (s.by_batch ? pass.entry_count() : 1);
      EXPECT_LE(end, s.region == traces::Region::kTree ? plan.tree_bytes() : plan.scratch_bytes()) << pass.name;
    }
    EXPECT_GE(std::uint64_t{pass.batch} * pass.entry_count(), pass.items) << pass.name;
  }
}

}  // namespace
}  // namespace kernels
