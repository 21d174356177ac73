#include "tools/sampling/timed_tiles.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sim/engine.h"
#include "tests/hw_models/machines/gpu_harness.h"

// Tests of simulating blocks of a frame's tiles, with caches warmed by the tiles before each block.

namespace tools {
namespace {

using hw::test::Frame;

const Frame& frame() {
  static const Frame f("cornell", 128, 64, 1, 8);  // 128 tiles
  return f;
}

struct BlockRun {
  std::vector<Mark> marks;
  std::vector<TimedTiles::TimedTile> played;
  std::uint64_t fills = 0, warmed = 0;
  std::vector<sim::UnitReport> units;
};

BlockRun run(const std::vector<TimedBlock>& blocks, const std::vector<std::uint32_t>& tile_indices = {}) {
  hw::GpuConfig config;
  config.cores = 2;
  FrontEnd front_end(frame().program(), frame().tracer(), 0, true, tile_indices);
  std::vector<std::uint32_t> marked = {blocks.front().measured};
  for (std::size_t i = 1; i < blocks.size(); ++i) marked.insert(marked.end(), {blocks[i].first, blocks[i].measured});
  TimedTiles tiles(front_end, blocks, marked);
  hw::Gpu gpu(config, frame().workload(), tiles);
  tiles.set_gpu(gpu);
  gpu.finish(sim::run(gpu));
  tiles.finish_tile_times();
  BlockRun r{{}, tiles.simulated_tiles(), 0, tiles.warmed_tiles(), gpu.unit_reports()};
  for (const std::uint32_t tile : marked) r.marks.push_back(tiles.snapshot_at(tile));
  for (const sim::UnitReport& unit : r.units) {
    for (const sim::CounterReport& counter : unit.counters)
      r.fills += unit.block == "l2" && counter.name == "fills" ? counter.value : 0;
  }
  return r;
}

TEST(TimedTiles, OneBlockOfAllTilesIsThePlainRun) {
  const hw::test::Outcome plain = [] {
    hw::GpuConfig config;
    config.cores = 2;
    return hw::test::play(frame(), config);
  }();
  const BlockRun all = run({{0, 0, 128, 0}});
  ASSERT_EQ(all.units.size(), plain.units.size());
  for (std::size_t u = 0; u < all.units.size(); ++u) {
    for (std::size_t i = 0; i < all.units[u].counters.size(); ++i) {
      EXPECT_EQ(all.units[u].counters[i].value, plain.units[u].counters[i].value) << all.units[u].path;
    }
  }
}

TEST(TimedTiles, TilesOfBlocksAloneArePlayedInOrder) {
  const BlockRun r = run({{0, 0, 4, 0}, {40, 42, 48, 5}, {120, 124, 128, 8}});
  std::vector<std::uint32_t> tiles;
  for (const TimedTiles::TimedTile& tile : r.played) tiles.push_back(tile.tile);
  EXPECT_EQ(tiles, (std::vector<std::uint32_t>{0,  1,  2,   3,   40,  41,  42,  43,  44,  45,
                                               46, 47, 120, 121, 122, 123, 124, 125, 126, 127}));
  EXPECT_EQ(r.warmed, 13U);
}

TEST(TimedTiles, MarksBoundTheMeasuredParts) {
  const BlockRun r = run({{0, 0, 4, 0}, {40, 42, 48, 5}, {120, 124, 128, 8}});
  ASSERT_EQ(r.marks.size(), 5U);
  const auto begin_of = [&](std::uint32_t tile) {
    return std::ranges::find(r.played, tile, &TimedTiles::TimedTile::tile)->begin;
  };
  const std::vector<sim::Time> times = {begin_of(0), begin_of(40), begin_of(42), begin_of(120), begin_of(124)};
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(r.marks[i].time, times[i]) << i;
  for (const TimedTiles::TimedTile& tile : r.played) EXPECT_LT(tile.begin, tile.end) << tile.tile;
}

TEST(TimedTiles, UnneededTilesNeedNotBeExecuted) {
  const std::vector<TimedBlock> blocks = {{0, 0, 4, 0}, {40, 42, 48, 2}, {120, 124, 128, 0}};
  std::vector<std::uint32_t> tile_indices;
  for (std::uint32_t tile = 0; tile < 128; ++tile) {
    if (tile < 4 || (tile >= 38 && tile < 48) || tile >= 120) tile_indices.push_back(tile);
  }
  const BlockRun all = run(blocks), few = run(blocks, tile_indices);
  ASSERT_EQ(all.marks.size(), few.marks.size());
  for (std::size_t i = 0; i < all.marks.size(); ++i) EXPECT_EQ(all.marks[i].time, few.marks[i].time);
  EXPECT_EQ(all.fills, few.fills);
}

TEST(TimedTiles, WarmedCachesReadLessFromMemory) {
  const BlockRun cold = run({{0, 0, 4, 0}, {80, 84, 96, 0}, {124, 126, 128, 0}});
  const BlockRun warm = run({{0, 0, 4, 0}, {80, 84, 96, 16}, {124, 126, 128, 0}});
  EXPECT_LT(warm.fills, cold.fills * 97 / 100);
}

TEST(TimedTiles, ATileThatWasJustWarmedMissesNothingInTheL2) {
  const BlockRun cold = run({{0, 0, 1, 0}});
  // The machine stops after its last block: of two equal tiles, the first warms the caches for the second.
  hw::GpuConfig config;
  config.cores = 1;
  config.l2.cache.size.bytes = 1 << 20;
  const std::vector<traces::TileWork> work = frame().record();
  struct Same final : hw::TileSource {
    const std::vector<traces::TileWork>& work;
    bool given = false;
    hw::Gpu* gpu = nullptr;
    explicit Same(const std::vector<traces::TileWork>& w) : work(w) {}
    const traces::TileWork* next() override { return std::exchange(given, true) ? nullptr : &work[60]; }
    void release_work(const traces::TileWork*) override {}
    void note_dispatched(sim::Time) override { gpu->warm_caches(work[60], 0); }
  } same(work);
  hw::Gpu gpu(config, frame().workload(), same);
  same.gpu = &gpu;
  gpu.finish(sim::run(gpu));
  std::uint64_t fills = 0;
  for (const sim::UnitReport& unit : gpu.unit_reports()) {
    for (const sim::CounterReport& counter : unit.counters)
      fills += unit.block == "l2" && counter.name == "fills" ? counter.value : 0;
  }
  EXPECT_EQ(fills, 0U);
  EXPECT_GT(cold.fills, 0U);
}

}  // namespace
}  // namespace tools
