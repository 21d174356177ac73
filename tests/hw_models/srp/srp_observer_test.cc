#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hw_models/srp/srp_harness.h"

// Those who watch a shader core are told of tiles, loops and batches of rays, each once.

namespace hw {
namespace {

using test::kA, test::kB;
using test::SrpHarness;
using test::TileBuilder;

/// Numbers of calls, and of rays that were in the T&I unit at batches' ends.
struct Watched : Observer {
  void tile_begins(std::uint32_t /*core*/, std::uint32_t /*slot*/, Owner /*tile*/, sim::Time /*now*/) override {
    tiles_begun += 1;
  }
  void tile_ends(std::uint32_t /*core*/, std::uint32_t /*slot*/, sim::Time /*now*/) override { tiles_ended += 1; }
  void loop_ends(std::uint32_t /*core*/, const ObservedLoop& loop) override { items.push_back(loop.items); }
  void batch_begins(std::uint32_t /*core*/, std::uint32_t /*slot*/, std::uint32_t node, std::uint64_t rays,
                    sim::Time now) override {
    batches_begun.push_back(node);
    rays_at_begin.push_back(rays);
    begin = now;
  }
  void batch_ends(std::uint32_t /*core*/, std::uint32_t /*slot*/, std::uint32_t node, const traces::WorkNode& batch,
                  std::uint64_t rays, sim::Time now) override {
    batches_ended.push_back(node);
    rays_of_batch.push_back(batch.items);
    rays_at_end.push_back(rays);
    end = now;
  }
  void transfer_ends(std::uint32_t /*core*/, const DmaJob& /*job*/, sim::Time /*begin*/, sim::Time /*end*/) override {
    ADD_FAILURE() << "the DMA tells of transfers";
  }

  int tiles_begun = 0, tiles_ended = 0;
  std::vector<std::uint32_t> items, batches_begun, batches_ended, rays_of_batch;
  std::vector<std::uint64_t> rays_at_begin, rays_at_end;
  sim::Time begin = 0, end = 0;
};

TEST(SrpObserver, IsToldOfABatchWithItsFirstRayAndWithItsLastHit) {
  Watched watched;
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
