#include <gtest/gtest.h>

#include "tests/hw_models/frame/bench.h"
#include "tests/hw_models/frame/conservation.h"
#include "tests/hw_models/frame/random_config.h"

namespace hw {
namespace {

using testing::difference;
using testing::Frame;
using testing::Outcome;
using testing::play;

TEST(Gpu, PictureRaysAndStepsAreTheSameOnFiftyRandomMachinesAndNothingIsLostOnAnyOfThem) {
  const Frame& frame = testing::cornell_64x32();
  const GpuConfig standard;
  const Outcome expected = play(frame, standard);
  expect_conserved(expected, frame, standard);
  for (std::uint64_t seed = 100; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    const GpuConfig config = testing::random_config(seed);
    const Outcome run = play(frame, config);
    EXPECT_EQ(difference(expected.function, run.function), "");
    EXPECT_EQ(run.sum("ist", "tests"), expected.sum("ist", "tests"));
    EXPECT_EQ(run.sum("ist", "hits"), expected.sum("ist", "hits"));
    EXPECT_EQ(run.sum("srp", "items"), expected.sum("srp", "items"));
    expect_conserved(run, frame, config);
  }
}

TEST(Gpu, NothingIsLostWithSeveralSamplesPerPixelAndAPictureThatCutsItsTiles) {
  const Frame frame("teapot", 37, 21, 4);
  const GpuConfig config;
  expect_conserved(play(frame, config), frame, config);
}

/// Every queue at its least, one of everything in flight.
GpuConfig smallest() {
  GpuConfig c;
  c.tni.link_depth = 1;
  c.tni.trv.rays = c.tni.trv.l1.mshrs = c.tni.trv.stack_entries = 1;
  c.tni.trv.l1.size.bytes = c.tni.ist.l1.size.bytes = c.srp.data_cache.size.bytes = 64;
  c.tni.trv.l1.ways = c.tni.ist.l1.ways = c.srp.data_cache.ways = 1;
  c.tni.ist.leaves = c.tni.ist.l1.mshrs = 1;
  c.direct_interface.depth = 1;
  c.srp.chunk = c.srp.data_cache.mshrs = 1;
  c.tile_buffer.size.bytes = 1024;
  c.tile_buffer.tiles_in_flight = 1;
  c.dma.depth = 1;
  c.l2.banks = c.l2.cache.mshrs = c.l2.targets = c.l2.cache.ways = 1;
  c.l2.cache.size.bytes = 64;
  c.interconnect.link_depth = 1;
  c.dram.channels = 1;
  c.dram.controller.read_queue = c.dram.controller.write_queue = c.dram.controller.write_high = 1;
  c.dram.controller.write_low = 0;
  return c;
}

TEST(Gpu, QueuesOfOneOneTileInFlightOneItemAChunkAndATileBufferTooSmallForATileStillEnd) {
  const Frame frame("cornell", 16, 16);
  for (const std::uint32_t cores : {1U, 4U}) {
    GpuConfig config = smallest();
    config.cores = cores;
    const Outcome run = play(frame, config);
    expect_conserved(run, frame, config);
    EXPECT_EQ(run.sum("tile_buffer", "spilled_slots"), run.rays()) << "no slot fits, so every ray spills";
  }
}

TEST(Gpu, ATileBufferOfHalfATileSpillsSomeAndEnds) {
  const Frame& frame = testing::cornell_64x32();
  for (const std::uint32_t tiles : {1U, 3U}) {
    GpuConfig config;
    config.tile_buffer.tiles_in_flight = tiles;
    config.tile_buffer.size.bytes = 12 * 1024 + 64 * 128;
    const Outcome run = play(frame, config);
    expect_conserved(run, frame, config);
    EXPECT_GT(run.sum("tile_buffer", "spilled_slots"), 0U) << tiles;
    EXPECT_LT(run.sum("tile_buffer", "spilled_slots"), run.rays()) << tiles;
  }
}

}  // namespace
}  // namespace hw
