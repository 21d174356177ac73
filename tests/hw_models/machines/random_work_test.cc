#include "tests/hw_models/machines/random_work.h"

#include <array>
#include <string>

#include <gtest/gtest.h>

#include "tests/hw_models/machines/conservation.h"
#include "tests/hw_models/machines/random_config.h"

// Streams with everything that a frame program can say: transfers anywhere, idle items, tiles that wait for tiles.

namespace hw {
namespace {

using test::difference;
using test::Engine;
using test::Frame;
using test::Outcome;
using test::play;

const Frame& frame_of_six_tiles() {
  static const Frame frame("cornell", 24, 16, 1, 8);
  return frame;
}

GpuConfig machine(std::uint64_t seed) { return seed == 0 ? GpuConfig{} : test::random_config(seed); }

/// Lines, rays and items that the machine counted are those that the stream asks for.
void expect_all_played(const std::vector<traces::TileWork>& works, const Outcome& run) {
  std::array<std::array<std::uint64_t, 2>, kRegions> lines{};
  std::uint64_t rays = 0, idle = 0, items = 0;
  for (const traces::TileWork& work : works) {
    for (const traces::WorkNode& node : work.nodes) {
      if (node.kind == traces::WorkNode::Kind::kTransfer) {
        lines[static_cast<std::size_t>(node.region)][node.to_memory ? 1 : 0] +=
            (node.offset % 64 + node.items + 63) / 64;
      } else {
        (node.kind == traces::WorkNode::Kind::kRays ? rays : items) += node.items + node.idle;
        idle += node.idle;
      }
    }
  }
  const std::array<std::string, kRegions> names = {"picture", "samples", "rates"};
  for (std::size_t region = 0; region < kRegions; ++region) {
    EXPECT_EQ(run.sum("dma", names[region] + "_lines_read"), lines[region][0]);
    EXPECT_EQ(run.sum("dma", names[region] + "_lines_written"), lines[region][1]);
    EXPECT_GT(lines[region][0], 0U) << names[region];
  }
  EXPECT_EQ(run.sum("tile_dispatcher", "finished"), works.size());
  EXPECT_EQ(run.sum("srp", "rays"), rays);
  EXPECT_EQ(run.sum("srp", "items"), items);
  std::uint64_t idle_run = 0;
  for (const KernelUse& kernel : run.kernels) idle_run += kernel.idle;
  EXPECT_EQ(idle_run, idle);
}

TEST(GpuRandomWork, AllOfItIsPlayedAndTheOracleAgrees) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    const GpuConfig config = machine(seed);
    const std::vector<traces::TileWork> works = test::random_work(frame_of_six_tiles(), seed);
    const Outcome fast = play(frame_of_six_tiles(), works, config);
    expect_all_played(works, fast);
    test::expect_machine_conserved(fast, config);
    EXPECT_EQ(difference(fast, play(frame_of_six_tiles(), works, config, Engine::kOracle)), "");
  }
}

TEST(GpuRandomWork, TheOrderOfUnitsWithinAStepIsInvisible) {
  for (std::uint64_t seed = 8; seed < 16; ++seed) {
    const GpuConfig config = machine(seed % 4 == 0 ? 0 : seed);
    const std::vector<traces::TileWork> works = test::random_work(frame_of_six_tiles(), seed);
    const Outcome fast = play(frame_of_six_tiles(), works, config);
    EXPECT_EQ(difference(fast, play(frame_of_six_tiles(), works, config, Engine::kShuffled, seed)), "") << seed;
  }
}

TEST(GpuRandomWork, WithFewRaySlotsItStillEnds) {
  for (std::uint64_t seed = 16; seed < 32; ++seed) {
    SCOPED_TRACE(seed);
    GpuConfig config;
    config.tile_buffer.size.bytes = seed % 2 == 0 ? 1024 : 4 * 1024;
    config.tile_buffer.tiles_in_flight = 1 + static_cast<std::uint32_t>(seed % 4);
    config.srp.chunk = seed % 3 == 0 ? 7 : 64;
    const std::vector<traces::TileWork> works = test::random_work(frame_of_six_tiles(), seed);
    const Outcome run = play(frame_of_six_tiles(), works, config);
    expect_all_played(works, run);
    test::expect_machine_conserved(run, config);
    EXPECT_GT(run.sum("tile_buffer", "spilled_slots"), 0U);
  }
}

TEST(GpuRandomWork, TilesThatWaitForTilesTakeTurns) {
  std::vector<traces::TileWork> works = test::random_work(frame_of_six_tiles(), 1);
  for (traces::TileWork& work : works) work.after_all = true;
  const Outcome run = play(frame_of_six_tiles(), works, {});
  std::uint64_t in_use = 0;
  for (const sim::UnitReport& unit : run.units) {
    if (unit.block != "tile_buffer") continue;
    for (const auto& [why, cycles] : unit.why) in_use += why == "in_use" ? cycles : 0;
    EXPECT_LE(in_use, unit.elapsed) << "never two cores at once";
  }
}

}  // namespace
}  // namespace hw
