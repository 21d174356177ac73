#include "tests/hw_models/machines/random_work.h"

#include <array>
#include <string>

#include <gtest/gtest.h>

#include "tests/hw_models/machines/conservation.h"
#include "tests/hw_models/machines/random_config.h"

// Tests of tiles with all that a frame program can record: transfers anywhere, idle items, dependencies between tiles.

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

GpuConfig drawn_machine(std::uint64_t seed) { return seed == 0 ? GpuConfig{} : test::random_config(seed); }

/// Expects that the machine counted as many lines, rays and items as its tiles have.
void expect_all_played(const std::vector<traces::TileWork>& works, const GpuConfig& config, const Outcome& run) {
  std::array<std::array<std::uint64_t, 2>, test::kTileRegions> lines{};
  std::uint64_t rays = 0, idle = 0, items = 0, chunks = 0;
  for (const traces::TileWork& work : works) {
    for (const traces::WorkNode& node : work.nodes) {
      if (node.kind == traces::WorkNode::Kind::kTransfer) {
        lines[static_cast<std::size_t>(node.region)][node.to_memory ? 1 : 0] +=
            (node.offset % 64 + node.items + 63) / 64;
      } else {
        (node.kind == traces::WorkNode::Kind::kRays ? rays : items) += node.items + node.idle;
        idle += node.idle;
        const bool launch = node.kind == traces::WorkNode::Kind::kLaunch;
        if (launch) chunks += (node.items + node.idle + config.srp.chunk - 1) / config.srp.chunk;
      }
    }
  }
  const std::array<std::string, test::kTileRegions> names = {"picture", "samples", "rates"};
  for (std::size_t region = 0; region < test::kTileRegions; ++region) {
    EXPECT_EQ(run.sum("dma", names[region] + "_lines_read"), lines[region][0]);
    EXPECT_EQ(run.sum("dma", names[region] + "_lines_written"), lines[region][1]);
    EXPECT_GT(lines[region][0], 0U) << names[region];
  }
  EXPECT_EQ(run.sum("tile_dispatcher", "finished"), works.size());
  EXPECT_EQ(run.sum("srp", "rays"), rays);
  EXPECT_EQ(run.sum("srp", "items"), items);
  EXPECT_EQ(run.sum("srp", "launches"), chunks) << "whether they run alone or together";
  std::uint64_t idle_run = 0;
  for (const KernelUse& kernel : run.kernels) idle_run += kernel.idle;
  EXPECT_EQ(idle_run, idle);
}

TEST(GpuRandomWork, AllOfItIsExecutedAndTheOracleAgrees) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    const GpuConfig config = drawn_machine(seed);
    const std::vector<traces::TileWork> works = test::random_work(frame_of_six_tiles(), seed);
    const Outcome fast = play(frame_of_six_tiles(), works, config);
    expect_all_played(works, config, fast);
    test::expect_machine_conserved(fast, config);
    EXPECT_EQ(difference(fast, play(frame_of_six_tiles(), works, config, Engine::kOracle)), "");
  }
}

TEST(GpuRandomWork, TheOrderOfUnitsWithinAStepIsInvisible) {
  for (std::uint64_t seed = 8; seed < 16; ++seed) {
    const GpuConfig config = drawn_machine(seed % 4 == 0 ? 0 : seed);
    const std::vector<traces::TileWork> works = test::random_work(frame_of_six_tiles(), seed);
    const Outcome fast = play(frame_of_six_tiles(), works, config);
    EXPECT_EQ(difference(fast, play(frame_of_six_tiles(), works, config, Engine::kShuffled, seed)), "") << seed;
  }
}

TEST(GpuRandomWork, WithFewRaySlotsItStillFinishes) {
  for (std::uint64_t seed = 16; seed < 32; ++seed) {
    SCOPED_TRACE(seed);
    GpuConfig config;
    config.tile_buffer.size.bytes = seed % 2 == 0 ? 1024 : 4 * 1024;
    config.tile_buffer.tiles_in_flight = 1 + static_cast<std::uint32_t>(seed % 4);
    config.srp.chunk = seed % 3 == 0 ? 7 : 64;
    const std::vector<traces::TileWork> works = test::random_work(frame_of_six_tiles(), seed);
    const Outcome run = play(frame_of_six_tiles(), works, config);
    expect_all_played(works, config, run);
    test::expect_machine_conserved(run, config);
    EXPECT_GT(run.sum("tile_buffer", "spilled_slots"), 0U);
  }
}

/// Returns tiles that depend on all earlier tiles: the first node imports their borders, and borders need the whole
/// tile.
std::vector<traces::TileWork> chained_work() {
  using traces::Edge;
  using traces::WorkNode;
  std::vector<traces::TileWork> works = frame_of_six_tiles().record();
  for (traces::TileWork& work : works) {
    const auto imports = static_cast<std::uint32_t>(work.tile);
    for (WorkNode& node : work.nodes) {
      for (Edge& edge : node.inputs) edge.node += imports;
      if (node.inputs.empty()) {
        for (std::uint32_t i = 0; i < imports; ++i) node.inputs.push_back({i, Edge::Kind::kAll});
      }
    }
    for (std::uint32_t t = 0; t < imports; ++t) {
      work.imports.push_back({t, 0});
      work.nodes.insert(work.nodes.begin(), {.kind = WorkNode::Kind::kTransfer,
                                             .items = 100,
                                             .region = traces::Region::kSamples,
                                             .to_memory = false,
                                             .border = imports - 1 - t,
                                             .inputs = {}});
    }
    const auto last = static_cast<std::uint32_t>(work.nodes.size() - 1);
    work.nodes.push_back({.kind = WorkNode::Kind::kTransfer,
                          .items = 100,
                          .region = traces::Region::kSamples,
                          .border = 0,
                          .inputs = {{last, Edge::Kind::kAll}}});
  }
  return works;
}

TEST(GpuRandomWork, AChainOfImportsFinishesOnEveryMachine) {
  const std::vector<traces::TileWork> works = chained_work();
  for (const std::uint32_t cores : {1U, 2U, 4U}) {
    for (const std::uint32_t in_flight : {1U, 3U}) {
      for (const std::uint64_t buffer : {1024U, 64U * 1024U}) {
        SCOPED_TRACE(testing::Message() << cores << " cores, " << in_flight << " tiles, " << buffer << " bytes");
        GpuConfig config;
        config.cores = cores;
        config.tile_buffer.tiles_in_flight = in_flight;
        config.tile_buffer.size.bytes = buffer;
        const Outcome fast = play(frame_of_six_tiles(), works, config);
        EXPECT_EQ(fast.sum("tile_dispatcher", "finished"), works.size());
        EXPECT_EQ(fast.sum("tile_dispatcher", "borders"), works.size());
        EXPECT_EQ(fast.sum("tile_dispatcher", "early"), cores * in_flight == 1 ? 0 : works.size() - 1);
        test::expect_machine_conserved(fast, config);
        EXPECT_EQ(difference(fast, play(frame_of_six_tiles(), works, config, Engine::kOracle)), "");
        EXPECT_EQ(difference(fast, play(frame_of_six_tiles(), works, config, Engine::kShuffled, 5)), "");
      }
    }
  }
}

TEST(GpuRandomWork, TilesAfterAllOthersTakeTurns) {
  std::vector<traces::TileWork> works = test::random_work(frame_of_six_tiles(), 1);
  for (traces::TileWork& work : works) work.after_all = true;
  const Outcome run = play(frame_of_six_tiles(), works, {});
  std::uint64_t in_use = 0;
  for (const sim::UnitReport& unit : run.units) {
    if (unit.block != "tile_buffer") continue;
    for (const auto& [why, cycles] : unit.cycles_by_reason) in_use += why == "in_use" ? cycles : 0;
    EXPECT_LE(in_use, unit.elapsed) << "never two cores at once";
  }
}

}  // namespace
}  // namespace hw
