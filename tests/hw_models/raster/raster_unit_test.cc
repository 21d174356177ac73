#include "hw_models/raster/raster_unit.h"

#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hw_models/raster/raster_harness.h"

namespace hw {
namespace {

using test::batch;
using test::RasterHarness;
using test::tile_of;
using test::triangles;
using test::wave;
using traces::RasterTriangle;
using traces::TileWork;
using traces::WorkNode;

std::uint64_t cycles(const RasterUnitConfig& config, const TileWork& work) {
  return RasterHarness(config).add(work).run().cycles();
}

/// Returns the additional cycles that a hundred more triangles take.
std::uint64_t of_hundred(const RasterUnitConfig& config, const std::function<TileWork(std::uint32_t)>& make) {
  const TileWork few = make(100), many = make(200);
  return cycles(config, many) - cycles(config, few);
}

/// Returns a rasteriser configuration in which fetching is never the bottleneck.
RasterUnitConfig quick_fetch() {
  RasterUnitConfig config;
  config.lookups = 8;
  return config;
}

TEST(RasterUnitConfig, AWaveLargerThanTheDepthBufferTakesPartsAndTheLastMayBeSmaller) {
  RasterUnitConfig config;
  config.depth_bytes = 8;
  config.depth_buffer = {800};
  EXPECT_EQ(config.depth_buffer_parts(1), 1U);
  EXPECT_EQ(config.depth_buffer_parts(100), 1U);
  EXPECT_EQ(config.depth_buffer_parts(101), 2U);
  EXPECT_EQ(config.depth_buffer_parts(200), 2U);
}

TEST(RasterUnit, CoversABlockAndAQuadACycle) {
  EXPECT_EQ(of_hundred(quick_fetch(), [](std::uint32_t n) { return wave(n, 3, 7); }), 100U * (3 + 7));
  RasterUnitConfig slow = quick_fetch();
  slow.block_interval = 2;
  slow.quad_interval = 3;
  EXPECT_EQ(of_hundred(slow, [](std::uint32_t n) { return wave(n, 3, 7); }), 100U * (3 * 2 + 7 * 3));
}

TEST(RasterUnit, TakesTurnsAtPixelsOfMoreSamplesThanItTestsAtOnce) {
  EXPECT_EQ(of_hundred(quick_fetch(), [](std::uint32_t n) { return wave(n, 1, 4, 64, 4); }), 100U * (1 + 4));
  EXPECT_EQ(of_hundred(quick_fetch(), [](std::uint32_t n) { return wave(n, 1, 4, 64, 16); }), 100U * (1 + 4 * 4));
}

TEST(RasterUnit, SetsUpATriangleEachInterval) {
  RasterUnitConfig config = quick_fetch();
  config.setup_interval = 9;
  EXPECT_EQ(of_hundred(config, [](std::uint32_t n) { return wave(n, 1, 1); }), 100U * 9);
}

TEST(RasterUnit, SetsTrianglesUpAgainForEachPartThatItsDepthBufferHolds) {
  RasterUnitConfig config = quick_fetch();
  config.setup_interval = 9;
  config.depth_buffer.bytes = 64 * config.depth_bytes;
  EXPECT_EQ(of_hundred(config, [](std::uint32_t n) { return wave(n, 1, 1, 129); }), 100U * 9 * 3);
}

TEST(RasterUnit, PutsAnEntryIntoAListACycle) {
  EXPECT_EQ(of_hundred(quick_fetch(), [](std::uint32_t n) { return batch(n, 16); }), 100U * 16 + 100)
      << "and writes a line of 16 entries a cycle";
  EXPECT_EQ(of_hundred(quick_fetch(), [](std::uint32_t n) { return batch(n, 0); }), 100U) << "culls one a cycle";
}

TEST(RasterUnit, TransformsAVertexEachInterval) {
  RasterUnitConfig config = quick_fetch();
  config.vertex_interval = 4;
  const auto strangers = [](std::uint32_t n) {
    std::vector<RasterTriangle> all = triangles(n, {});
    for (std::uint32_t i = 0; i < n; ++i) all[i].vertices = {48 * i, 48 * i + 16, 48 * i + 32};
    return tile_of(WorkNode::Kind::kBin, n, all);
  };
  EXPECT_EQ(of_hundred(config, strangers), 100U * 3 * 4);
  const TileWork work = strangers(100);
  RasterHarness harness(config);
  harness.add(work).run();
  EXPECT_EQ(harness.stats().vertices_transformed, 300U);
  EXPECT_EQ(harness.written().size(), 300U) << "each in a line of its own";
}

TEST(RasterUnit, LooksUpItsNumberOfLinesPerCycle) {
  RasterUnitConfig config;
  config.lookups = 1;
  // Lines of an entry, of a triangle's vertex numbers, and of three vertices.
  EXPECT_EQ(of_hundred(config, [](std::uint32_t n) { return wave(n, 1, 1); }), 100U * 5);
}

TEST(RasterUnit, WritesHitsOfAWaveAtItsWidth) {
  const RasterUnitConfig config;
  EXPECT_EQ(cycles(config, wave(1, 1, 1, 512)) - cycles(config, wave(1, 1, 1, 256)), 256U * 16 / 64);
  EXPECT_EQ(cycles(config, wave(0, 0, 0, 512)) - cycles(config, wave(0, 0, 0, 256)), 256U * 16 / 64);
}

TEST(RasterUnit, ReusesRecentlyTransformedVertices) {
  const TileWork work = batch(100, 1);
  RasterHarness harness(RasterUnitConfig{});
  harness.add(work).run();
  EXPECT_EQ(harness.stats().vertices_transformed, 3U);
  EXPECT_EQ(harness.stats().vertices_reused, 297U);
  EXPECT_EQ(harness.stats().triangles, 100U);
  EXPECT_EQ(harness.stats().triangles_culled, 0U);
}

TEST(RasterUnit, WritesEachEntryOnce) {
  const TileWork work = batch(100, 3);
  RasterHarness harness(RasterUnitConfig{});
  harness.add(work).run();
  EXPECT_EQ(harness.stats().entries_written, 300U);
  // 3 vertices of 16 bytes in 3 lines; 300 entries of 4 bytes in 19 lines.
  EXPECT_EQ(harness.written().size(), 3U + 19U);
  EXPECT_EQ(harness.stats().writes, harness.written().size());
}

TEST(RasterUnit, SkipsHiddenQuadsWithHierarchicalZ) {
  TileWork work = wave(10, 4, 8);
  for (RasterTriangle& t : work.raster_triangles) {
    t.hidden_blocks = 2;
    t.hidden_quads = 5;
    t.hidden_samples = 20;
  }
  RasterUnitConfig config;
  RasterHarness with(config);
  with.add(work).run();
  config.hierarchical_z = false;
  RasterHarness without(config);
  without.add(work).run();
  EXPECT_EQ(with.stats().quads, 30U);
  EXPECT_EQ(without.stats().quads, 80U);
  EXPECT_EQ(with.stats().samples_hidden, 200U);
  EXPECT_EQ(without.stats().samples_hidden, 0U);
  EXPECT_EQ(without.cycles() - with.cycles(), 50U);
  EXPECT_EQ(with.stats().samples_failed + 200, without.stats().samples_failed);
}

TEST(RasterUnit, FetchesListsOfTheNextWaveWhileItCoversOne) {
  const TileWork one = wave(50, 10, 10), other = wave(50, 10, 10);
  RasterHarness alone(RasterUnitConfig{}, false, 100), both(RasterUnitConfig{}, false, 100);
  alone.add(one).run();
  both.add(one).add(other).run();
  // The second wave's lines are cached, so it adds only its coverage and its hits.
  EXPECT_LE(both.cycles() - alone.cycles(), 50U * 20 + 64 * 16 / 64 + 4);
}

TEST(RasterUnit, ChargesEveryCycleToAReason) {
  const TileWork first = batch(40, 20), second = wave(30, 2, 3), third = wave(0, 0, 0);
  RasterUnitConfig config;
  config.window = 4;
  config.l1.mshrs = 2;
  RasterHarness harness(config, false, 50);
  harness.add(first).add(second).add(third).run();
  std::uint64_t all = 0;
  for (int why = 0; why < static_cast<int>(RasterUnit::CycleReason::kCount); ++why) {
    all += harness.spent(static_cast<RasterUnit::CycleReason>(why));
  }
  EXPECT_EQ(all, harness.end());
  EXPECT_GT(harness.spent(RasterUnit::CycleReason::kMemory), 50U);
  EXPECT_GT(harness.spent(RasterUnit::CycleReason::kListing), 40U * 19);
  EXPECT_GE(harness.spent(RasterUnit::CycleReason::kCovering), 30U * 5);
}

TEST(RasterUnit, IsTheSameForEngineAndOracle) {
  const TileWork first = batch(40, 20), second = wave(30, 2, 3), third = wave(0, 0, 0);
  for (const std::uint32_t small : {1U, 3U}) {
    RasterUnitConfig config;
    config.window = config.l1.mshrs = config.queue = config.jobs = small;
    config.write_buffer = 4;
    RasterHarness fast(config, false, 30), oracle(config, false, 30);
    fast.add(first).add(second).add(third).add(second).run();
    oracle.add(first).add(second).add(third).add(second).run<sim::Skip::kOff>();
    EXPECT_EQ(fast.cycles(), oracle.cycles());
    for (int why = 0; why < static_cast<int>(RasterUnit::CycleReason::kCount); ++why) {
      EXPECT_EQ(fast.spent(static_cast<RasterUnit::CycleReason>(why)),
                oracle.spent(static_cast<RasterUnit::CycleReason>(why)))
          << RasterUnit::kReasons[static_cast<std::size_t>(why)].name;
    }
    EXPECT_EQ(fast.read(), oracle.read());
  }
}

}  // namespace
}  // namespace hw
