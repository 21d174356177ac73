#include "shader_kernels/programs/build_kernels.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <string_view>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/kernels/collapse.h"
#include "traces/accel/build.h"
#include "traces/accel/build/morton_order.h"
#include "traces/scene/animation.h"
#include "traces/scenes/library.h"

// Tests of building and refitting trees with kernels.

namespace kernels {
namespace {

constexpr std::uint32_t kSpace = 64 * 1024, kBits = 30;

traces::MemoryImage image_of(const char* scene, std::uint32_t leaf_size = 4) {
  traces::BvhConfig bvh;
  bvh.leaf_size = leaf_size;
  return traces::build_memory_image(traces::open_scene(scene), bvh, 1);
}

/// Passes that build or refit the trees of an image.
struct Plan {
  explicit Plan(const traces::MemoryImage& image, bool refit = false, std::uint32_t bits = kBits)
      : builds(traces::tree_builds(image, refit, false)), passes(kSpace, 0) {
    builds.morton_bits = bits;
    add_build_passes(image, builds, passes);
  }
  /// Returns the bytes of the passes with one of these names, or of all passes.
  double bytes(std::initializer_list<std::string_view> names = {}) const {
    std::uint64_t sum = 0;
    for (const KernelPass& pass : passes.passes()) {
      if (names.size() == 0 || std::ranges::find(names, pass.name) != names.end()) sum += pass.moved_bytes();
    }
    return static_cast<double>(sum);
  }
  /// Records all entries.
  std::vector<traces::TileWork> record() const {
    std::vector<traces::TileWork> works(passes.entry_count());
    std::vector<traces::WorkNode> spare;
    for (std::uint32_t entry = 0; entry < works.size(); ++entry) {
      StreamBuilder stream(works[entry], spare, true);
      passes.record_entry(entry, stream, works[entry]);
      stream.finish();
    }
    return works;
  }
  traces::TreeBuilds builds;
  KernelPasses passes;
};

void expect_nodes(const KernelBuildResult& built, const traces::MemoryImage& image, const std::string& what) {
  ASSERT_EQ(built.nodes.size(), image.nodes.size());
  for (std::size_t i = 0; i < built.nodes.size(); ++i) {
    const traces::NodeRecord &kernel = built.nodes[i], &host = image.nodes[i];
    EXPECT_TRUE(std::equal(kernel.x, kernel.x + 4, host.x) && std::equal(kernel.y, kernel.y + 4, host.y) &&
                std::equal(kernel.z, kernel.z + 4, host.z) && std::equal(kernel.child, kernel.child + 2, host.child))
        << what << ", node " << i;
  }
  ASSERT_EQ(built.leaves.size(), image.triangles.size());
  EXPECT_EQ(std::memcmp(built.leaves.data(), image.triangles.data(), 48 * built.leaves.size()), 0) << what;
}

TEST(BuildKernels, EncodeTheNodesOfTheHost) {
  for (const char* scene : {"cornell", "teapot"}) {
    for (const std::uint32_t leaf_size : {1U, 4U}) {
      const traces::MemoryImage image = image_of(scene, leaf_size);
      const KernelBuildResult built = run_build_kernels(image, kBits);
      expect_nodes(built, image, scene);
      EXPECT_EQ(built.unions, image.triangles.size() - 1) << scene << ": a hierarchy over triangles has one node less";
    }
  }
}

TEST(BuildKernels, RefitTheNodesOfTheHost) {
  for (const std::uint32_t leaf_size : {1U, 4U}) {
    traces::BvhConfig bvh;
    bvh.leaf_size = leaf_size;
    traces::Scene scene = traces::open_scene("crowd", {.triangles = 10000});
    traces::MemoryImage image = traces::build_memory_image(scene, bvh, 1);
    ASSERT_TRUE(traces::pose_scene(scene, 1.0).geometry);
    traces::refit_memory_image(scene, image);
    expect_nodes(run_refit_kernels(image), image, "crowd");
  }
}

TEST(BuildKernels, SortKeysStably) {
  for (const std::uint32_t bits : {24U, 30U}) {
    const KernelBuildResult built = run_build_kernels(image_of("teapot"), bits);
    std::vector<KernelBuildResult::Key> expected = built.keys;
    std::ranges::stable_sort(expected, {}, &KernelBuildResult::Key::key);
    ASSERT_EQ(built.sorted.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(built.sorted[i].key, expected[i].key) << i;
      EXPECT_EQ(built.sorted[i].number, expected[i].number) << i;
    }
    EXPECT_GT(std::ranges::max(built.keys, {}, &KernelBuildResult::Key::key).key, 1U << (bits - 4));
    EXPECT_LT(std::ranges::max(built.keys, {}, &KernelBuildResult::Key::key).key, 1U << bits);
  }
}

TEST(BuildKernels, UseTheMortonGridOfTheHost) {
  const traces::MemoryImage image = image_of("teapot");
  std::vector<traces::Bounds> boxes(image.triangles.size());
  for (const traces::TriangleRecord& t : image.triangles) {
    boxes[t.source] = {glm::min(glm::min(t.v0, t.v1), t.v2), glm::max(glm::max(t.v0, t.v1), t.v2)};
  }
  for (const std::uint32_t bits : {24U, 30U}) {
    const traces::MortonOrder host = traces::morton_order(boxes, bits);
    const KernelBuildResult built = run_build_kernels(image, bits);
    std::size_t equal = 0;
    for (std::size_t i = 0; i < host.items.size(); ++i) equal += built.keys[host.items[i]].key == host.codes[i];
    EXPECT_GE(static_cast<double>(equal), 0.995 * static_cast<double>(boxes.size()))
        << "floats of kernels round to another cell only at its border";
  }
}

TEST(BuildKernels, LinkEachNodeToOneParentWithTwoChildren) {
  const KernelBuildResult built = run_build_kernels(image_of("teapot"), kBits);
  const std::size_t triangles = built.keys.size();
  EXPECT_EQ(built.links, 2 * (triangles - 1)) << "all triangles and nodes but the root";
  std::multiset<std::uint32_t> parents(built.parents.begin(), built.parents.end());
  for (std::uint32_t boundary = 0; boundary + 1 < triangles; ++boundary)
    EXPECT_EQ(parents.count(boundary), 2U) << boundary;
}

TEST(BuildKernels, MoveTheBytesOfTheClosedForms) {
  const traces::MemoryImage image = image_of("teapot");
  const double triangles = static_cast<double>(image.triangles.size());
  const double nodes = 64 * static_cast<double>(image.nodes.size()) / triangles;
  for (const std::uint32_t bits : {24U, 30U}) {
    const Plan plan(image, false, bits);
    const auto per_triangle = [&](std::initializer_list<std::string_view> names) {
      return plan.bytes(names) / triangles;
    };
    const double digits = bits == 24 ? 3 : 4;
    EXPECT_NEAR(per_triangle({"leaf"}), 56 + 24 + 48, 0.5);
    EXPECT_NEAR(per_triangle({"bounds"}), 0, 0.1) << "a box per batch";
    EXPECT_NEAR(per_triangle({"code"}), 24 + 8, 0.5);
    EXPECT_NEAR(per_triangle({"histogram", "scan", "scatter"}), 8 + 16 * digits, 0.1 * (8 + 16 * digits));
    EXPECT_NEAR(per_triangle({"link", "fit"}), 128, 12.8);
    EXPECT_NEAR(per_triangle({"encode_nodes", "encode_leaves"}), 8 + 48 + 40 + 48 + nodes, 0.1 * (144 + nodes));
    const double unit = 48 + 16 + 48 + 48 + nodes;  // the tree builder with records of 8 bytes
    EXPECT_GE(per_triangle({}) / unit, 2.0);
    EXPECT_LE(per_triangle({}) / unit, 3.5);
  }
}

TEST(BuildKernels, RefitWithTheBytesOfTheClosedForm) {
  const traces::MemoryImage image = image_of("teapot");
  const double triangles = static_cast<double>(image.triangles.size()), nodes = static_cast<double>(image.nodes.size());
  const Plan plan(image, true);
  EXPECT_NEAR(plan.bytes({"refit_leaves"}), triangles * (48 + 48 + 48) + (nodes + 1) * 24, 100);
  EXPECT_NEAR(plan.bytes({"refit_nodes"}), nodes * (64 + 2 * 24 + 64 + 24), 100);
  EXPECT_LT(1.8 * plan.bytes(), Plan(image).bytes());
}

std::vector<traces::BvhConfig> formats() {
  std::vector<traces::BvhConfig> all(5);
  all[1].width = 4;
  all[2].width = 8, all[2].format = traces::NodeFormat::kQ8, all[2].leaf_size = 1;
  all[3].width = 8, all[3].format = traces::NodeFormat::kCw80, all[3].leaf_size = 3;
  all[4].instances = traces::InstanceLevels::kTwoLevel;
  return all;
}

TEST(BuildKernels, WriteEachByteOfTheTreesOnce) {
  for (const traces::BvhConfig& bvh : formats()) {
    const traces::MemoryImage image = traces::build_memory_image(traces::open_scene("cornell"), bvh, 1);
    for (const bool refit : {false, true}) {
      const Plan plan(image, refit);
      std::uint64_t expected = 0, items = 0, written = 0, leaves = 0;
      for (const traces::TreeBuild& build : plan.builds.trees) {
        for (const traces::BuildWork::Range& range : build.job.output) expected += range.bytes;
        items += build.items;
      }
      std::set<std::uint64_t> places;
      for (const traces::TileWork& work : plan.record()) {
        for (const traces::WorkNode& node : work.nodes) {
          const bool is_leaf = node.kind == traces::WorkNode::Kind::kLaunch &&
                               (node.kernel == kKernelId<EncodeLeaf> || node.kernel == kKernelId<PoseInstance> ||
                                node.kernel == kKernelId<RefitLeaf>);
          if (is_leaf) leaves += node.items;
          if (node.kind != traces::WorkNode::Kind::kTransfer || node.region != traces::Region::kTree) continue;
          EXPECT_LE(node.offset + node.items, end_of_trees(plan.builds));
          if (!node.to_memory) continue;
          written += node.items;
          EXPECT_TRUE(places.insert(node.offset).second) << node.offset;
        }
      }
      EXPECT_EQ(written, expected);
      EXPECT_EQ(leaves, items) << "as many leaves as triangles and instances";
    }
  }
}

TEST(BuildKernels, CollapseWithTheBytesOfTheClosedForm) {
  traces::BvhConfig bvh;
  bvh.width = 8;
  const traces::MemoryImage image = traces::build_memory_image(traces::open_scene("teapot"), bvh, 1);
  const auto nodes = static_cast<double>(image.wide_nodes.size());
  double children = 0;
  for (const traces::WideNode& node : image.wide_nodes) {
    for (const std::uint32_t link : node.child) children += link == traces::kNoChild ? 0 : 1;
  }
  const double leaves = children - nodes + 1, node_bytes = static_cast<double>(image.layout.node_bytes) * nodes;
  const Plan plan(image), refit(image, true);
  EXPECT_NEAR(plan.bytes({"collapse"}), 40 * (leaves - 1) + 24 * leaves + 4 * children, 100);
  EXPECT_NEAR(plan.bytes({"encode_nodes"}), 28 * children + node_bytes, 100);
  EXPECT_NEAR(refit.bytes({"refit_nodes"}), 2 * node_bytes + 24 * children + 24 * nodes, 100);
}

TEST(BuildKernels, CollapseTheLargestInnerChild) {
  // Node 0 has nodes 1 and 2, node 1 leaves 3 and 4, node 2 node 5 and leaf 6, node 5 leaves 7 and 8. Boxes are cubes.
  constexpr std::uint32_t kLeaf = 1U << 31;
  std::vector<BuildNodeRecord<float>> nodes(6);
  std::vector<BoxRecord<float>> boxes;
  for (const float side : {9.0F, 3.0F, 8.0F, 7.0F, 7.0F, 5.0F, 7.0F, 1.0F, 1.0F}) {
    boxes.push_back({{0, 0, 0}, {side, side, side}});
  }
  nodes[0] = {{}, {}, 1, 2, 1, 2};
  nodes[1] = {{}, {}, 3, 4, kLeaf | 3, kLeaf | 4};
  nodes[2] = {{}, {}, 5, 6, 5, kLeaf | 6};
  nodes[5] = {{}, {}, 7, 8, kLeaf | 7, kLeaf | 8};
  WideChildren<float> wide{};
  wide.area0 = 1, wide.count = 1;
  CountRecord<float> number{};
  CollapseNode::Ports<float> ports;
  ports.wide_numbers.bind(&number);
  ports.wide_children.bind(&wide);
  ports.nodes.bind(nodes.data());
  ports.boxes.bind(boxes.data());
  const auto children = [&] {
    std::vector<std::uint32_t> all = {wide.child0, wide.child1, wide.child2, wide.child3, wide.child4};
    all.resize(wide.count);
    return all;
  };
  const std::vector<std::vector<std::uint32_t>> expected = {{1, 2}, {1, 5, 6}, {1, 7, 6, 8}, {3, 7, 6, 8, 4}};
  for (const std::vector<std::uint32_t>& after : expected) {
    CollapseNode::body<float>(0U, ports);
    EXPECT_EQ(children(), after);
  }
}

TEST(BuildKernels, QuantiseBoxesOutward) {
  NodeGrid<float> grid{{1, 2, 3}, {16, 8, 4}, 255};
  BoxRecord<float> box{{1.5F, 2.01F, 3}, {2.53F, 4, 66.7F}};
  CountRecord<float> wide{};
  QuantisedChild<float> planes{};
  QuantiseChild::Ports<float> ports;
  ports.boxes.bind(&box);
  ports.wide_numbers.bind(&wide);
  ports.node_grids.bind(&grid);
  ports.quantised.bind(&planes);
  QuantiseChild::body<float>(0U, ports);
  EXPECT_EQ(planes.x, 8U | 25U << 16) << "0.5 and 1.53 of 1/16";
  EXPECT_EQ(planes.y, 0U | 16U << 16);
  EXPECT_EQ(planes.z, 0U | 255U << 16);
}

TEST(BuildKernels, ScatterKeysToTheirPlaces) {
  const Plan plan(image_of("teapot"));
  std::uint32_t passes = 0;
  for (const KernelPass& pass : plan.passes.passes()) {
    if (std::string_view(pass.name) != "scatter") continue;
    const PassStream& sorted = pass.streams.back();
    ASSERT_EQ(sorted.first_piece.size(), pass.entry_count() + 1U);
    std::vector<MemoryPiece> pieces = sorted.pieces;
    // The lowest digit is random, so most batches write a run for each of its values.
    if (passes++ == 0) {
      EXPECT_GT(pieces.size(), 128U * (pass.entry_count() - 1));
    }
    std::ranges::sort(pieces, {}, &MemoryPiece::begin);
    std::uint64_t end = 0;
    for (const MemoryPiece& piece : pieces) {
      EXPECT_EQ(piece.begin, end);
      end = piece.end;
    }
    EXPECT_EQ(end, 8 * pass.items) << "all places are written once";
  }
  EXPECT_EQ(passes, 4U);
}

TEST(BuildKernels, GatherRecordsInTheOrderOfLeaves) {
  const Plan plan(image_of("cornell"));
  const std::vector<std::uint32_t>& order = plan.builds.trees.front().order;
  std::size_t item = 0;
  std::uint64_t records = 0;
  for (const KernelPass& pass : plan.passes.passes()) {
    if (!pass.gather.numbers.empty()) records = pass.gather.base;
  }
  for (const traces::TileWork& work : plan.record()) {
    for (const traces::WorkNode& node : work.nodes) {
      if (!node.has_accesses) continue;
      EXPECT_EQ(node.kernel, kKernelId<EncodeLeaf>);
      for (std::uint32_t i = 0; i < node.items; ++i, ++item) {
        const std::uint64_t begin = records + 48 * std::uint64_t{order[item]}, last = begin + 47;
        const std::uint32_t first = work.access_begin[node.first + i], end = work.access_begin[node.first + i + 1];
        ASSERT_EQ(end - first, last / 64 - begin / 64 + 1) << "lines of the record";
        EXPECT_EQ(4 * std::uint64_t{work.accesses[first].element}, begin);
        EXPECT_EQ(work.accesses[end - 1].element / 16, last / 64);
      }
    }
  }
  EXPECT_EQ(item, order.size());
}

TEST(BuildKernels, FitTheirSpaceAndCoverAllItems) {
  const Plan plan(image_of("cornell"));
  for (const KernelPass& pass : plan.passes.passes()) {
    std::uint64_t bytes = 0;
    for (const PassStream& s : pass.streams) {
      const bool by_batch = s.share == PassStream::Share::kBatch || s.share == PassStream::Share::kAll;
      bytes += by_batch ? s.bytes : s.bytes * pass.batch / pass.items;
      const std::uint64_t end = s.base + s.bytes * (s.share == PassStream::Share::kBatch ? pass.entry_count() : 1);
      EXPECT_LE(end, s.region == traces::Region::kTree ? end_of_trees(plan.builds) : plan.passes.scratch_bytes())
          << pass.name;
    }
    EXPECT_LE(bytes, kSpace) << pass.name;
    EXPECT_GE(std::uint64_t{pass.batch} * pass.entry_count(), pass.items) << pass.name;
  }
}

traces::MemoryImage crowd_in_two_levels() {
  traces::BvhConfig bvh;
  bvh.instances = traces::InstanceLevels::kTwoLevel;
  return traces::build_memory_image(traces::open_scene("crowd", {.triangles = 10000}), bvh, 1);
}

TEST(BuildKernels, RunAPassOfAllTreesTogether) {
  const traces::MemoryImage image = crowd_in_two_levels();
  const Plan plan(image);
  ASSERT_GT(plan.builds.trees.size(), 100U);
  std::uint32_t barriers = 0;
  for (const traces::TileWork& work : plan.record()) barriers += work.after_all ? 1 : 0;
  EXPECT_EQ(barriers, 11U) << "leaf, bounds, code, histogram, scan, 4 scatters, link, fit, encode";
}

}  // namespace
}  // namespace kernels
