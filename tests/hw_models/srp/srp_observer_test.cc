#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hw_models/srp/srp_harness.h"

// Tests that a shader core reports each tile, kernel loop and batch of rays to its observer once.

namespace hw {
namespace {

using test::kA, test::kB;
using test::SrpHarness;
using test::TileBuilder;

/// Observer that counts events, and the rays in the T&I unit at the end of each batch.
struct CountingObserver : Observer {
  void on_event(const Event& event) override {
    handle_event(event, HandleEvents{
                            [&](const TileStarted&) { tiles_begun += 1; },
                            [&](const TileEnded&) { tiles_ended += 1; },
                            [&](const LoopEnded& loop) { items.push_back(loop.items); },
                            [&](const BatchStarted& batch) {
                              batches_begun.push_back(batch.node);
                              rays_at_begin.push_back(batch.rays);
                              begin = batch.at;
                            },
                            [&](const BatchEnded& ended) {
                              batches_ended.push_back(ended.node);
                              rays_of_batch.push_back(ended.batch->items);
                              rays_at_end.push_back(ended.rays);
                              end = ended.at;
                            },
                            [&](const TransferEnded&) { ADD_FAILURE() << "the DMA reports transfers"; },
                        });
  }

  int tiles_begun = 0, tiles_ended = 0;
  std::vector<std::uint32_t> items, batches_begun, batches_ended, rays_of_batch;
  std::vector<std::uint64_t> rays_at_begin, rays_at_end;
  sim::Time begin = 0, end = 0;
};

TEST(SrpObserver, SeesABatchWithItsFirstRayAndWithItsLastHit) {
  CountingObserver watched;
  SrpHarness::Setup setup;
  setup.observer = &watched;
  SrpHarness harness(setup, {{}, {}});
  TileBuilder work;
  const auto rays = work.rays(work.launch(kA, 5), 5);
  const auto shaded = work.launch(kB, 5, {TileBuilder::each(rays)});
  work.picture(64, shaded);
  harness.add(work.build()).run();
  EXPECT_EQ(watched.tiles_begun, 1);
  EXPECT_EQ(watched.tiles_ended, 1);
  EXPECT_EQ(watched.items, (std::vector<std::uint32_t>{5, 5}));
  EXPECT_EQ(watched.batches_begun, std::vector<std::uint32_t>{rays});
  EXPECT_EQ(watched.batches_ended, std::vector<std::uint32_t>{rays});
  EXPECT_EQ(watched.rays_of_batch, std::vector<std::uint32_t>{5});
  EXPECT_EQ(watched.rays_at_begin, std::vector<std::uint64_t>{1}) << "the first one itself";
  EXPECT_EQ(watched.rays_at_end, std::vector<std::uint64_t>{0});
  EXPECT_LT(watched.begin, watched.end);
}

}  // namespace
}  // namespace hw
