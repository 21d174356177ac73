#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/full_size.h"
#include "tests/hw_models/machines/conservation.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"
#include "traces/accel/tree_builds.h"
#include "traces/scenes/library.h"

// Tests of frames whose trees the machine builds.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Method;
using test::Outcome;
using test::play;

kernels::RenderConfig small(std::uint32_t width = 32, std::uint32_t height = 16) {
  kernels::RenderConfig render;
  render.width = width;
  render.height = height;
  render.tile = 16;
  return render;
}

Method method(const traces::BvhConfig& bvh = {}, const char* scene = "cornell") {
  return {traces::open_scene(scene), "full:1", {}, small(), bvh};
}

std::uint64_t of_builder(const Outcome& run, const char* counter) { return run.sum("tree_builder", counter); }

constexpr traces::PoseWork kPose{.skinned_vertices = 3000, .joints = 20, .rigid_vertices = 2000, .rigid_instances = 3};

traces::BvhConfig two_levels() {
  traces::BvhConfig bvh;
  bvh.instances = traces::InstanceLevels::kTwoLevel;
  return bvh;
}

std::vector<traces::BvhConfig> formats() {
  std::vector<traces::BvhConfig> all(6);
  all[1].boxes = traces::BoxRecords::kSingle;
  all[2].triangle_bytes = 36;
  all[3].width = 8;
  all[3].format = traces::NodeFormat::kQ8;
  all[3].leaf_size = 1;
  all[4].leaf = traces::LeafFormat::kPair64;
  all[5] = two_levels();
  return all;
}

/// Checks that the builder takes all triangles or instances of an image and writes all bytes of its trees.
void expect_whole_tree(const Outcome& run, const traces::MemoryImage& image) {
  std::uint64_t bytes = image.layout.tree_bytes, triangles = image.triangles.size(), instances = 0;
  if (image.layout.has_labels()) bytes += triangles * traces::Layout::kLabelBytes;
  if (!image.trees.empty()) {
    // Shared meshes do not move: the tree over instances and the instances remain.
    instances = image.instances.size();
    bytes = image.trees.front().first_node * sizeof(traces::NodeRecord) + instances * sizeof(traces::InstanceRecord);
    triangles = 0;
  }
  EXPECT_EQ(of_builder(run, "tree_bytes_written"), bytes);
  EXPECT_EQ(of_builder(run, "triangles"), triangles);
  EXPECT_EQ(of_builder(run, "instances"), instances);
  EXPECT_EQ(of_builder(run, "leaves_written"), triangles + instances);
}

TEST(BuiltTrees, AreWrittenToTheLastByte) {
  for (const traces::BvhConfig& bvh : formats()) {
    const Method plain = method(bvh);
    Method built = method(bvh);
    const Outcome run = play(built.build_trees(), {});
    expect_whole_tree(run, built.image());
    test::expect_machine_conserved(run, {});
    const Outcome without = play(plain, {});
    EXPECT_EQ(run.function.rgb, without.function.rgb);
    EXPECT_GT(run.cycles, without.cycles);
  }
}

TEST(BuiltTrees, DelayTheTilesOrOverlapThem) {
  TreeBuilderConfig slow;
  slow.clocks = 1000;
  GpuConfig config;
  config.tree_builder = slow;
  const Method plain = method({}, "teapot");
  Method before = method({}, "teapot"), during = method({}, "teapot");
  const std::uint64_t tiles = play(plain, config).cycles;
  const Outcome first = play(before.build_trees(), config), both = play(during.build_trees(false, true), config);
  const std::uint64_t build = before.image().triangles.size() * slow.clocks;
  EXPECT_GT(first.cycles, build + tiles / 4) << "rays find the tree in the L2";
  EXPECT_LT(both.cycles, first.cycles - tiles / 8);
  EXPECT_GE(both.cycles, build);
  EXPECT_EQ(of_builder(first, "tree_bytes_written"), of_builder(both, "tree_bytes_written"));
  EXPECT_EQ(first.function.rgb, both.function.rgb);
}

TEST(BuiltTrees, AreInTheL2WhenRaysReadThem) {
  const Method plain = method();
  Method built = method();
  GpuConfig config;
  config.l2.cache.size.bytes = 4 << 20;  // holds all that the builder writes
  const auto miss_latency = [](const Outcome& run) {
    return static_cast<double>(run.sum("trv", "l1_miss_cycles")) / static_cast<double>(run.sum("trv", "l1_fills"));
  };
  EXPECT_LT(miss_latency(play(built.build_trees(), config)), 0.9 * miss_latency(play(plain, config)));
}

TEST(BuiltTrees, InvalidateTheFirstLevelCachesOfAWarmFrame) {
  Method built = method();
  const auto program = built.build_trees().make();
  TileSource no_tiles;
  Gpu warmed({}, built.workload(), no_tiles);
  for (std::uint32_t tile = static_cast<std::uint32_t>(built.builds().trees.size()); tile < program->tiles(); ++tile) {
    kernels::TileResult result;
    program->run_tile(tile, built.tracer(), true, result);
    warmed.warm_caches(result.work, 0);
  }
  warmed.invalidate_first_level();
  const CacheContents contents = warmed.cache_contents();
  for (const CacheTags& tags : contents.first_level) {
    for (const traces::BuildWork::Range& range : built.builds().trees.front().job.output) {
      for (Addr at = 0; at < range.bytes; at += kLineBytes) {
        EXPECT_FALSE(tags.has_line(built.image().layout.nodes + range.offset + at));
      }
    }
  }
  std::uint64_t lines = 0;
  for (const sim::UnitReport& unit : warmed.unit_reports()) {
    for (const sim::CounterReport& counter : unit.counters) {
      if (counter.name == std::string("lines_invalidated")) lines += counter.value;
    }
  }
  EXPECT_GT(lines, 10U);
}

TEST(BuiltTrees, AFrameWithoutMotionTakesNoTime) {
  const Method plain = method();
  Method still = method();
  still.build_nothing();
  const Outcome with_unit = play(still, {});
  EXPECT_EQ(with_unit.cycles, play(plain, {}).cycles);
  EXPECT_EQ(of_builder(with_unit, "writes"), 0U);
}

TEST(TreesOfKernels, AreWrittenToTheLastByteAndMoveMoreThanTheBuilder) {
  const Method plain = method({}, "teapot");
  Method kernels = method({}, "teapot"), unit = method({}, "teapot");
  kernels.build_trees(false, false, traces::BuildEngine::kSrp);
  const Outcome run = play(kernels, {}), by_unit = play(unit.build_trees(), {}), host = play(plain, {});
  EXPECT_EQ(run.function.rgb, host.function.rgb);
  const auto lines = [](const Outcome& o) { return o.sum("dma", "lines_written") + o.sum("dma", "lines_read"); };
  const double by_kernels = 64.0 * static_cast<double>(lines(run) - lines(host));
  std::uint64_t bytes = 0;
  for (const char* counter :
       {"input_bytes", "record_bytes_written", "record_bytes_read", "node_bytes_read", "tree_bytes_written"}) {
    bytes += of_builder(by_unit, counter);
  }
  EXPECT_GT(by_kernels / static_cast<double>(bytes), 2.0);
  EXPECT_LT(by_kernels / static_cast<double>(bytes), 3.5);
  const auto written = run.sum("dma", "lines_written") - host.sum("dma", "lines_written");
  EXPECT_GE(64 * written, kernels.image().layout.tree_bytes);
}

TEST(BuiltTrees, FollowThePosesOfTheirGeometry) {
  for (const traces::BuildEngine engine : {traces::BuildEngine::kUnit, traces::BuildEngine::kSrp}) {
    Method still = method(), moved = method();
    still.build_trees(false, false, engine);
    moved.build_trees(false, false, engine).pose(kPose);
    const Outcome plain = play(still, {}), posed = play(moved, {});
    EXPECT_EQ(plain.function.rgb, posed.function.rgb);
    EXPECT_GT(posed.cycles, plain.cycles);
    const auto lines = [&](const char* counter) { return posed.sum("dma", counter) - plain.sum("dma", counter); };
    const std::uint64_t read = 3000 * 36 + 20 * 48 + 2000 * 12 + 3 * 48 + 40 * 56;
    const std::uint64_t written = 3000 * 12 + 2000 * 12 + 40 * 64;
    EXPECT_NEAR(static_cast<double>(64 * lines("lines_read")), read, 0.1 * read);
    EXPECT_NEAR(static_cast<double>(64 * lines("lines_written")), written, 0.1 * written);
  }
}

TEST(TreesOfKernels, MoveLessByRefitsThanByBuilds) {
  const Method plain = method({}, "teapot");
  Method built = method({}, "teapot"), refitted = method({}, "teapot");
  built.build_trees(false, false, traces::BuildEngine::kSrp);
  refitted.build_trees(true, false, traces::BuildEngine::kSrp);
  const Outcome host = play(plain, {}), build = play(built, {}), refit = play(refitted, {});
  EXPECT_EQ(refit.function.rgb, host.function.rgb);
  const auto lines = [&](const Outcome& o) {
    const auto of = [](const Outcome& run) { return run.sum("dma", "lines_written") + run.sum("dma", "lines_read"); };
    return static_cast<double>(of(o) - of(host));
  };
  EXPECT_GT(lines(build) / lines(refit), 1.6);
  EXPECT_LT(lines(build) / lines(refit), 5);
  EXPECT_LT(refit.cycles, build.cycles);
}

TEST(TreesOfKernels, AreTheSameOnAnyEngine) {
  const std::uint64_t machines = ::test::is_full_size() ? 30 : 3;
  for (std::uint64_t seed = 0; seed < machines; ++seed) {
    Method built = method(seed % 3 == 2 ? two_levels() : traces::BvhConfig{});
    built.build_trees(seed % 3 == 1, false, traces::BuildEngine::kSrp).pose(kPose);
    const GpuConfig config = test::random_config(2000 + seed);
    const Outcome fast = play(built, config);
    EXPECT_EQ(difference(fast, play(built, config, Engine::kOracle)), "") << seed;
    EXPECT_EQ(difference(fast, play(built, config, Engine::kShuffled, seed)), "") << seed;
    EXPECT_EQ(difference(fast, play(built, config, Engine::kFast, 0, 2)), "") << seed;
  }
}

TEST(BuiltTrees, AreTheSameOnAnyEngine) {
  const std::uint64_t machines = ::test::is_full_size() ? 30 : 4;
  for (std::uint64_t seed = 0; seed < machines; ++seed) {
    Method built = method(seed % 3 == 2 ? two_levels() : traces::BvhConfig{});
    built.build_trees(seed % 2 == 1, seed % 4 == 3);
    if (seed % 2 == 0) built.pose(kPose);
    const GpuConfig config = test::random_config(1000 + seed);
    const Outcome fast = play(built, config);
    EXPECT_EQ(difference(fast, play(built, config, Engine::kOracle)), "") << seed;
    EXPECT_EQ(difference(fast, play(built, config, Engine::kShuffled, seed)), "") << seed;
    EXPECT_EQ(difference(fast, play(built, config, Engine::kFast, 0, 2)), "") << seed;
    test::expect_machine_conserved(fast, config);
    expect_whole_tree(fast, built.image());
  }
}

}  // namespace
}  // namespace hw
