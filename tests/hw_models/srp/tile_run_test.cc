#include "hw_models/srp/tile_run.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hw_models/srp/srp_harness.h"

namespace hw {
namespace {

using test::TileBuilder;

constexpr std::uint32_t kNone = TileRun::kNone;
constexpr traces::KernelId kKernel = 0;

/// A TileRun, and the tile's work to which it refers.
struct Tile {
  explicit Tile(TileBuilder builder, std::uint32_t chunk = 256) : work(builder.build()) { run.start_tile(work, chunk); }
  std::uint32_t next() const {
    return run.next_launch([](std::uint32_t) { return true; });
  }
  traces::TileWork work;
  TileRun run;
};

TEST(TileRun, AnEachEdgeReleasesAChunkWhenItsOwnItemsAreDone) {
  TileBuilder builder;
  builder.launch(kKernel, 10, {TileBuilder::each(builder.launch(kKernel, 10))});
  Tile tile(builder, 4);
  EXPECT_EQ(tile.next(), 0U);
  EXPECT_EQ(tile.run.next_chunk_size(0), 4U);
  tile.run.finish_items(0, 3);
  EXPECT_EQ(tile.next(), 0U) << "three items are no chunk";
  tile.run.finish_items(0, 1);
  EXPECT_EQ(tile.next(), 1U) << "consumers before producers";
  tile.run.finish_items(1, 4);
  EXPECT_EQ(tile.next(), 0U);
}

TEST(TileRun, AnAllEdgeWaitsForTheLastItem) {
  TileBuilder builder;
  builder.launch(kKernel, 10, {TileBuilder::all(builder.launch(kKernel, 10))});
  Tile tile(builder, 4);
  tile.run.finish_items(0, 8);
  EXPECT_EQ(tile.next(), 0U);
  EXPECT_EQ(tile.run.next_chunk_size(0), 2U) << "the last chunk is what is left";
  tile.run.finish_items(0, 2);
  EXPECT_EQ(tile.next(), 1U);
}

TEST(TileRun, MappedItemsWaitForTheirSources) {
  TileBuilder builder;
  const auto producer = builder.launch(kKernel, 12);
  const auto consumer = builder.launch(kKernel, 4, {TileBuilder::each(producer)});
  builder.map(consumer, {0, 3, 7, 11});
  Tile tile(builder, 2);
  tile.run.finish_items(producer, 2);
  EXPECT_EQ(tile.next(), producer) << "item 1 comes from item 3";
  tile.run.finish_items(producer, 2);
  EXPECT_EQ(tile.next(), consumer);
  tile.run.finish_items(consumer, 2);
  tile.run.finish_items(producer, 6);
  EXPECT_EQ(tile.next(), producer) << "item 3 comes from item 11";
  tile.run.finish_items(producer, 2);
  EXPECT_EQ(tile.next(), consumer);
}

TEST(TileRun, AnUnusableLaunchIsSkipped) {
  TileBuilder builder;
  builder.launch(kKernel, 4);
  builder.launch(kKernel, 4);
  Tile tile(builder);
  EXPECT_EQ(tile.run.next_launch([](std::uint32_t n) { return n != 1; }), 0U);
  EXPECT_EQ(tile.run.next_launch([](std::uint32_t) { return false; }), kNone);
}

TEST(TileRun, RaysReturningInAnyOrderReleaseTheirChunkWithTheLast) {
  TileBuilder builder;
  const auto rays = builder.rays(builder.launch(kKernel, 8), 8);
  const auto shade = builder.launch(kKernel, 8, {TileBuilder::each(rays)});
  Tile tile(builder, 4);
  tile.run.finish_items(0, 8);
  for (const std::uint32_t ray : {7U, 5U, 6U}) EXPECT_FALSE(tile.run.finish_ray(ray));
  EXPECT_FALSE(tile.run.finish_ray(4)) << "the second chunk is in, but the first is not";
  EXPECT_EQ(tile.next(), kNone);
  for (const std::uint32_t ray : {0U, 2U, 3U}) EXPECT_FALSE(tile.run.finish_ray(ray));
  EXPECT_TRUE(tile.run.finish_ray(1));
  EXPECT_TRUE(tile.run.is_complete(rays));
  EXPECT_EQ(tile.next(), shade);
  tile.run.finish_items(shade, 4);
  EXPECT_EQ(tile.next(), shade) << "the second chunk had been in all the time";
}

TEST(TileRun, SlotsAreFreedWhenTheLastReaderIsDone) {
  TileBuilder builder;
  const auto rays = builder.rays(builder.launch(kKernel, 6), 6);
  const auto first = builder.launch(kKernel, 6, {TileBuilder::each(rays)});
  const auto second = builder.launch(kKernel, 6, {TileBuilder::all(rays), TileBuilder::all(first)});
  Tile tile(builder);
  EXPECT_EQ(tile.run.finish_items(0, 6), 0U);
  for (std::uint32_t r = 0; r < 6; ++r) tile.run.finish_ray(r);
  EXPECT_EQ(tile.run.finish_items(first, 6), 0U) << "the second launch still reads them";
  EXPECT_EQ(tile.run.finish_items(second, 4), 0U) << "and is not through";
  EXPECT_EQ(tile.run.finish_items(second, 2), 6U);
}

TEST(TileRun, RaysMadeByAChunkAreThoseWithSourcesInIt) {
  TileBuilder builder;
  const auto launch = builder.launch(kKernel, 10);
  builder.rays(launch, 3, {1, 4, 8});
  builder.rays(launch, 2, {0, 9});
  Tile tile(builder);
  EXPECT_EQ(tile.run.count_produced_rays(launch, 0, 10), 5U);
  EXPECT_EQ(tile.run.count_produced_rays(launch, 0, 4), 2U);
  EXPECT_EQ(tile.run.count_produced_rays(launch, 4, 4), 1U);
  EXPECT_EQ(tile.run.count_produced_rays(launch, 8, 2), 2U);
  EXPECT_TRUE(std::ranges::equal(tile.run.batches_of(launch), std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(tile.run.source_item(1, 2), 8U);
  EXPECT_EQ(tile.run.batch_of(3), 2U);

  TileBuilder each;
  each.rays(each.launch(kKernel, 10), 10);
  EXPECT_EQ(Tile(each).run.count_produced_rays(0, 4, 3), 3U) << "a ray an item";
}

TEST(TileRun, IsCompleteWhenLaunchesRaysAndTransfersAre) {
  TileBuilder builder;
  const auto rays = builder.rays(builder.launch(kKernel, 2), 2);
  const auto shade = builder.launch(kKernel, 2, {TileBuilder::each(rays)});
  const auto out = builder.picture(64, shade);
  Tile tile(builder);
  tile.run.finish_items(0, 2);
  tile.run.finish_ray(0);
  tile.run.finish_ray(1);
  tile.run.finish_items(shade, 2);
  EXPECT_EQ(tile.next(), kNone) << "a transfer is no launch";
  EXPECT_FALSE(tile.run.is_tile_complete());
  tile.run.finish_items(out, 64);
  EXPECT_TRUE(tile.run.is_tile_complete());
}

TEST(TileRun, ATransferStartsOnceWhenItsLastInputIsComplete) {
  TileBuilder builder;
  const auto in = builder.transfer(traces::Region::kRates, false, 64);
  const auto launch = builder.launch(kKernel, 4, {TileBuilder::all(in)});
  const auto out = builder.transfer(traces::Region::kRates, true, 64, {TileBuilder::all(launch), TileBuilder::all(in)});
  Tile tile(builder);
  const auto started = [&] {
    std::vector<std::uint32_t> nodes;
    tile.run.start_transfers([&](std::uint32_t n) { nodes.push_back(n); });
    return nodes;
  };
  EXPECT_EQ(started(), (std::vector<std::uint32_t>{in}));
  EXPECT_EQ(started(), (std::vector<std::uint32_t>{}));
  EXPECT_EQ(tile.next(), kNone);
  EXPECT_TRUE(tile.run.is_awaited(in));
  tile.run.finish_items(in, 64);
  EXPECT_EQ(started(), (std::vector<std::uint32_t>{}));
  EXPECT_EQ(tile.next(), launch);
  tile.run.finish_items(launch, 4);
  EXPECT_EQ(started(), (std::vector<std::uint32_t>{out}));
  EXPECT_FALSE(tile.run.is_awaited(out)) << "it is the last";
}

TEST(TileRun, IdleItemsComeLastAndNoNodeWaitsForThem) {
  TileBuilder builder;
  const auto producer = builder.launch(kKernel, 6);
  builder.idle(producer, 5);
  const auto each = builder.launch(kKernel, 6, {TileBuilder::each(producer)});
  const auto all = builder.launch(kKernel, 3, {TileBuilder::all(producer)});
  Tile tile(builder, 4);
  EXPECT_EQ(tile.run.total_items(producer), 11U);
  tile.run.finish_items(producer, 4);
  EXPECT_EQ(tile.next(), each);
  tile.run.finish_items(each, 4);
  EXPECT_EQ(tile.next(), producer);
  EXPECT_EQ(tile.run.next_chunk_size(producer), 4U);
  EXPECT_EQ(tile.run.non_idle_items(producer, 4, 4), 2U) << "two work, two idle";
  tile.run.finish_items(producer, 4);
  EXPECT_FALSE(tile.run.is_complete(producer));
  EXPECT_EQ(tile.next(), all) << "every item that works is finished";
  tile.run.finish_items(all, 3);
  tile.run.finish_items(each, 2);
  EXPECT_FALSE(tile.run.is_tile_complete());
  EXPECT_EQ(tile.next(), producer);
  EXPECT_EQ(tile.run.next_chunk_size(producer), 3U);
  EXPECT_EQ(tile.run.non_idle_items(producer, 8, 3), 0U);
  tile.run.finish_items(producer, 3);
  EXPECT_TRUE(tile.run.is_tile_complete());
}

TEST(TileRun, IdleItemsWaitForAllInputsOfTheirLaunchAndKeepTheSlotsItReads) {
  TileBuilder builder;
  const auto rays = builder.rays(builder.launch(kKernel, 6), 6);
  const auto shade = builder.launch(kKernel, 6, {TileBuilder::each(rays)});
  builder.idle(shade, 2);
  Tile tile(builder, 4);
  tile.run.finish_items(0, 6);
  for (std::uint32_t r = 0; r < 5; ++r) tile.run.finish_ray(r);
  EXPECT_EQ(tile.next(), shade);
  EXPECT_EQ(tile.run.finish_items(shade, 4), 0U);
  EXPECT_EQ(tile.next(), kNone) << "two that work and two that idle run together, but a ray is out";
  tile.run.finish_ray(5);
  EXPECT_EQ(tile.next(), shade);
  EXPECT_EQ(tile.run.finish_items(shade, 2), 0U) << "idle items are left";
  EXPECT_EQ(tile.run.finish_items(shade, 2), 6U);
}

TEST(TileRun, IdleItemsMakeNoRays) {
  TileBuilder builder;
  const auto launch = builder.launch(kKernel, 6);
  builder.idle(launch, 4);
  builder.rays(launch, 6);
  Tile tile(builder);
  EXPECT_EQ(tile.run.count_produced_rays(launch, 0, 10), 6U);
  EXPECT_EQ(tile.run.count_produced_rays(launch, 4, 4), 2U);
  EXPECT_EQ(tile.run.count_produced_rays(launch, 8, 2), 0U);
}

TEST(TileRun, AReusedSlotKeepsNothingOfTheTileBefore) {
  TileBuilder large;
  large.launch(kKernel, 9, {TileBuilder::each(large.rays(large.launch(kKernel, 9), 9))});
  Tile tile(large, 2);
  tile.run.finish_items(0, 9);
  for (std::uint32_t r = 0; r < 9; ++r) tile.run.finish_ray(r);
  tile.run.finish_items(2, 9);
  EXPECT_TRUE(tile.run.is_tile_complete());
  tile.run.clear_tile();
  EXPECT_FALSE(tile.run.is_active());

  TileBuilder small;
  small.launch(kKernel, 3, {TileBuilder::each(small.rays(small.launch(kKernel, 3), 3))});
  const traces::TileWork work = small.build();
  tile.run.start_tile(work, 2);
  EXPECT_EQ(tile.next(), 0U);
  EXPECT_EQ(tile.run.count_produced_rays(0, 0, 3), 3U);
  tile.run.finish_items(0, 3);
  EXPECT_EQ(tile.next(), kNone) << "no ray of this tile is back";
  EXPECT_FALSE(tile.run.is_tile_complete());
}

}  // namespace
}  // namespace hw
