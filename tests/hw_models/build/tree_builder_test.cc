#include "hw_models/build/tree_builder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "sim/hash.h"
#include "tests/hw_models/build/builder_harness.h"

namespace hw {
namespace {

using test::BuilderHarness;
using test::strip;
using traces::TileWork;

/// Returns a small builder: runs of 16 triangles, four of them merged at the same time.
TreeBuilderConfig small_builder() {
  TreeBuilderConfig config;
  config.run = 16;
  config.ways = 4;
  return config;
}

std::uint64_t all_bytes(const TreeBuilderStats& s) {
  return s.input_bytes + s.record_bytes_read + s.record_bytes_written + s.node_bytes_read + s.tree_bytes_written;
}

TEST(TreeBuilder, TakesItsClocksPerTriangle) {
  for (const std::uint32_t clocks : {6U, 12U, 31U, 150U}) {
    TreeBuilderConfig config;
    config.clocks = clocks;
    constexpr std::uint32_t kTriangles = 400;
    const TileWork tree = strip(kTriangles);
    const std::uint64_t cycles = BuilderHarness(config, true).add(tree).run().cycles();
    EXPECT_GE(cycles, kTriangles * clocks);
    EXPECT_LE(cycles, kTriangles * clocks + 100) << "filling and draining two passes, and the invalidation";
  }
}

TEST(TreeBuilder, ComparesClustersAtTheRateOfItsComparators) {
  TreeBuilderConfig config;
  constexpr std::uint32_t kTriangles = 400, kPerTriangle = 46;
  TileWork tree = strip(kTriangles);
  tree.build[0].comparisons = kTriangles * kPerTriangle;
  const auto cycles = [&](std::uint32_t comparators) {
    config.comparators = comparators;
    BuilderHarness harness(config, true);
    harness.add(tree).run();
    EXPECT_EQ(harness.stats().comparisons, tree.build[0].comparisons);
    return harness.cycles();
  };
  const std::uint64_t hidden = kTriangles * config.clocks;
  EXPECT_NEAR(static_cast<double>(cycles(16)), static_cast<double>(hidden), 100) << "three cycles of six";
  EXPECT_NEAR(static_cast<double>(cycles(2)), static_cast<double>(hidden + kTriangles * (23 - 6)), 100);
}

TEST(TreeBuilder, KeepsRecordsOfOneRunOnChip) {
  const TileWork one_run = strip(16), two_runs = strip(17);
  EXPECT_EQ(BuilderHarness(small_builder()).add(one_run).run().stats().record_bytes_written, 0U);
  BuilderHarness two(small_builder());
  two.add(two_runs).run();
  EXPECT_EQ(two.stats().record_bytes_written, 17U * 8);
  EXPECT_EQ(two.stats().record_bytes_read, 17U * 8);
}

TEST(TreeBuilder, MovesTheBytesOfTheClosedForms) {
  constexpr double kTriangles = 1000;
  const TileWork tree = strip(1000);
  TreeBuilderConfig config;
  config.run = 64;
  // Two triangles per leaf halve the published forms' nodes: 192 and 228 bytes. A strip has a node per triangle.
  constexpr double kMoreNodes = 32;
  const double keys = static_cast<double>(all_bytes(BuilderHarness(config).add(tree).run().stats())) / kTriangles;
  EXPECT_NEAR(keys, 192 + kMoreNodes, 0.1);
  config.record_bytes = 32;
  const double boxes = static_cast<double>(all_bytes(BuilderHarness(config).add(tree).run().stats())) / kTriangles;
  EXPECT_NEAR(boxes, 228 + kMoreNodes, 0.1 * 228);
  const TileWork moved = strip(1000, true);
  const double refit = static_cast<double>(all_bytes(BuilderHarness(config).add(moved).run().stats())) / kTriangles;
  EXPECT_NEAR(refit, 48 + 2 * 64 + 48, 0.2) << "input, nodes read and written, leaves";
}

TEST(TreeBuilder, MergesMoreRunsThanWaysInSeveralPasses) {
  const TreeBuilderConfig config = small_builder();
  for (const std::uint32_t triangles : {64U, 65U, 256U, 257U, 1024U, 1025U}) {
    const TileWork tree = strip(triangles);
    const std::uint32_t merges = triangles <= 64 ? 0 : triangles <= 256 ? 1 : triangles <= 1024 ? 2 : 3;
    EXPECT_EQ(TreeBuilder::intermediate_merges(config, triangles), merges);
    const TreeBuilderStats stats = BuilderHarness(config).add(tree).run().stats();
    EXPECT_EQ(stats.record_bytes_written, std::uint64_t{8} * triangles * (1 + merges)) << triangles;
    EXPECT_EQ(stats.record_bytes_read, std::uint64_t{8} * triangles * (1 + merges)) << triangles;
    EXPECT_EQ(stats.leaves_written, triangles) << "triangles in, leaves out";
  }
}

TEST(TreeBuilder, ComparesOncePerDoublingOfARunAndPerLevelOfTheTournament) {
  struct Expected {
    std::uint32_t run, ways, triangles;
    double sort_levels, merge_levels;  // of a record
  };
  // 400 triangles in 7 runs: 58, 57, 57, ... records of six levels.
  for (const Expected& e :
       {Expected{2048, 128, 2048, 11, 0}, Expected{2048, 128, 16, 4, 0}, Expected{64, 128, 400, 6, 7},
        Expected{64, 16, 400, 6, 4}, Expected{64, 5, 64 * 25, 6, 2 * 3}, Expected{1, 4, 4, 0, 2}}) {
    for (const std::uint32_t bytes : {8U, 12U, 32U, 36U}) {
      TreeBuilderConfig config;
      config.run = e.run;
      config.ways = e.ways;
      config.record_bytes = bytes;
      const TileWork tree = strip(e.triangles);
      const TreeBuilderStats stats = BuilderHarness(config).add(tree).run().stats();
      const double words = e.triangles * std::ceil(bytes / 8.0);
      EXPECT_EQ(static_cast<double>(stats.sort_words), e.sort_levels * words) << e.run << " " << bytes;
      EXPECT_EQ(static_cast<double>(stats.merge_words), e.merge_levels * words) << e.ways << " " << bytes;
    }
  }
  TreeBuilderConfig uneven;
  uneven.run = 4;
  const TileWork tree = strip(9);  // three runs of three records: two levels each
  EXPECT_EQ(BuilderHarness(uneven).add(tree).run().stats().sort_words, 9U * 2);
}

TEST(TreeBuilder, NotifiesObserversOfEachPass) {
  struct Passes final : Observer {
    void on_event(const Event& event) override {
      if (const auto* pass = std::get_if<BuildPassEnded>(&event)) all.push_back(*pass);
    }
    std::vector<BuildPassEnded> all;
  } passes;
  const TileWork tree = strip(100), moved = strip(30, true);
  BuilderHarness harness(small_builder(), false, 20, &passes);
  harness.add(tree).add(moved).run();
  using enum BuildPass;
  const std::vector<BuildPass> expected = {kSort, kMerge, kHierarchy, kInvalidate, kRefit, kInvalidate};
  ASSERT_EQ(passes.all.size(), expected.size());
  sim::Time end = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const BuildPassEnded& pass = passes.all[i];
    EXPECT_EQ(pass.pass, expected[i]);
    EXPECT_EQ(pass.items, i < 4 ? 100U : 30U);
    EXPECT_EQ(pass.runs, i < 2 ? 7U : i == 2 ? 2U : 0U);
    EXPECT_GE(pass.begin, end);
    EXPECT_GT(pass.end, pass.begin);
    end = pass.end;
  }
}

TEST(TreeBuilder, WritesEachByteOfTheTreeOnce) {
  for (const bool refit : {false, true}) {
    const TileWork tree = strip(333, refit);
    BuilderHarness harness(small_builder());
    harness.add(tree).run();
    std::map<Addr, unsigned> sectors;  // by line: sectors written
    std::uint64_t count = 0;
    for (const MemRequest& r : harness.written()) {
      if (r.line >= test::kArrays) continue;
      EXPECT_EQ(sectors[r.line] & r.sectors, 0U) << "a sector is written twice";
      sectors[r.line] |= r.sectors;
      count += static_cast<std::uint64_t>(std::popcount(r.sectors));
    }
    EXPECT_EQ(count * kSectorBytes, harness.stats().tree_bytes_written);
    EXPECT_EQ(harness.stats().tree_bytes_written, 332U * 64 + 333U * 48);
    for (Addr at = test::kTree; at < test::kTree + 332 * 64; at += kSectorBytes) {
      EXPECT_TRUE((sectors[line_of(at)] >> ((at - line_of(at)) / kSectorBytes) & 1U) != 0) << at;
    }
  }
}

TEST(TreeBuilder, ReadsEachLineOfRecordsOncePerPass) {
  for (const std::uint32_t bytes : {8U, 12U, 36U}) {
    const TileWork tree = strip(300);  // 19 runs: one intermediate merge, which leaves five runs; another leaves two
    TreeBuilderConfig config = small_builder();
    config.record_bytes = bytes;
    BuilderHarness harness(config);
    harness.add(tree).run();
    std::map<Addr, int> times;
    for (const Addr line : harness.read()) {
      if (line >= harness.memory_map().records[0]) times[line] += 1;
    }
    // A line at the boundary of two runs belongs to both.
    const auto array = [&](std::size_t i) {
      int lines = 0;
      const Addr begin = harness.memory_map().records[i];
      for (Addr at = begin; at < begin + Addr{300} * bytes; at += kLineBytes) {
        EXPECT_GE(times[at], 1);
        lines += times[at];
      }
      return lines;
    };
    const int lines = static_cast<int>((300 * bytes + 63) / 64);
    EXPECT_LE(array(0), 2 * lines + 19 + 2) << "written by the sort and by the second merge";
    EXPECT_LE(array(1), lines + 5);
  }
}

TEST(TreeBuilder, ReadsFewerLinesIfNeighboursShareVertices) {
  TileWork shared = strip(200), apart = strip(200);
  for (std::uint32_t i = 0; i < 200; ++i) apart.build_triangles[i] = {48 * i, 48 * i + 16, 48 * i + 32};
  const auto lines_read = [](const TileWork& tree) {
    BuilderHarness harness(small_builder());
    return harness.add(tree).run().read().size();
  };
  EXPECT_LT(3 * lines_read(shared), lines_read(apart));
}

TEST(TreeBuilder, BuildsTreesInTheirOrderAndInvalidatesAfterEach) {
  const TileWork first = strip(20), second = strip(30, true);
  BuilderHarness harness(small_builder());
  harness.add(first).add(second).run();
  EXPECT_EQ(harness.stats().trees_built, 1U);
  EXPECT_EQ(harness.stats().trees_refitted, 1U);
  EXPECT_EQ(harness.stats().triangles, 50U);
  EXPECT_EQ(harness.stats().caches_invalidated, 2U);
  EXPECT_EQ(harness.spent(TreeBuilder::CycleReason::kInvalidating), 2U * small_builder().invalidate);
}

TEST(TreeBuilder, ChargesEveryCycleToAReason) {
  const TileWork tree = strip(200), moved = strip(50, true);
  TreeBuilderConfig config = small_builder();
  config.clocks = 20;
  BuilderHarness harness(config, false, 100);
  harness.add(tree).add(moved).run();
  std::uint64_t all = 0;
  for (int why = 0; why < static_cast<int>(TreeBuilder::CycleReason::kCount); ++why) {
    all += harness.spent(static_cast<TreeBuilder::CycleReason>(why));
  }
  EXPECT_EQ(all, harness.end());
  EXPECT_GE(harness.spent(TreeBuilder::CycleReason::kSorting), 200U * 10);
  EXPECT_GE(harness.spent(TreeBuilder::CycleReason::kMerging), 200U);
  EXPECT_GE(harness.spent(TreeBuilder::CycleReason::kEmitting), 200U * 10);
  EXPECT_GE(harness.spent(TreeBuilder::CycleReason::kRefitting), 50U * 10);
  EXPECT_GT(harness.spent(TreeBuilder::CycleReason::kMemory), 100U);
}

TEST(TreeBuilder, IsTheSameForEngineAndOracle) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto draw = [&](std::uint64_t what, std::uint64_t most) {
      return 1 + static_cast<std::uint32_t>(sim::hash(seed, what) % most);
    };
    TreeBuilderConfig config;
    config.clocks = 1 + draw(0, 20);
    config.merge_interval = draw(1, 3);
    config.run = draw(2, 40);
    config.ways = 1 + draw(3, 6);
    config.record_bytes = std::array{8U, 12U, 32U, 36U}[seed % 4];
    config.buffer.mshrs = draw(4, 8);
    config.lookups = draw(5, 3);
    config.window = draw(6, 16);
    config.write_buffer = 1 + draw(7, 4);
    const TileWork tree = strip(1 + draw(8, 150)), moved = strip(1 + draw(9, 60), true);
    BuilderHarness fast(config, false, 5 + draw(10, 90)), oracle(config, false, 5 + draw(10, 90));
    fast.add(tree).add(moved).run();
    oracle.add(tree).add(moved).run<sim::Skip::kOff>();
    EXPECT_EQ(fast.cycles(), oracle.cycles()) << seed;
    for (int why = 0; why < static_cast<int>(TreeBuilder::CycleReason::kCount); ++why) {
      EXPECT_EQ(fast.spent(static_cast<TreeBuilder::CycleReason>(why)),
                oracle.spent(static_cast<TreeBuilder::CycleReason>(why)))
          << seed << ": " << TreeBuilder::kReasons[static_cast<std::size_t>(why)].name;
    }
    EXPECT_EQ(fast.read(), oracle.read()) << seed;
  }
}

}  // namespace
}  // namespace hw
