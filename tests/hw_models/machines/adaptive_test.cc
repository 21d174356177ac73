#include <algorithm>
#include <memory>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "sim/config/config.h"
#include "sim/hash.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"
#include "traces/scenes/library.h"

// Tests of adaptive sampling on whole machines: dependencies between tiles, several passes, transfers in both
// directions.

namespace hw {
namespace {

using kernels::AttributeStorage;
using kernels::Halo;
using test::difference;
using test::Engine;
using test::Method;
using test::Outcome;
using test::play;

kernels::ProgramConfig config_of(Halo halo, AttributeStorage attributes) {
  kernels::ProgramConfig config;
  config.multirate.rate_control = kernels::RateControl::kHysteresis;
  config.undersample.correction = kernels::Correction::kFour;
  config.multirate.halo = config.undersample.halo = halo;
  config.multirate.attributes = config.undersample.attributes = attributes;
  return config;
}

/// Returns a machine of one core that handles one tile at a time, with all queues at their minimum.
GpuConfig smallest_machine() {
  GpuConfig config;
  config.cores = 1;
  config.tile_buffer.tiles_in_flight = 1;
  config.direct_interface.depth = 1;
  config.dma.depth = 1;
  config.interconnect.link_depth = 1;
  config.tni.link_depth = 1;
  config.tni.trvs = 1;
  config.tni.trv.rays = 1;
  config.tni.ist.leaves = 1;
  config.tni.trv.l1.mshrs = config.tni.ist.l1.mshrs = config.srp.data_cache.mshrs = 1;
  config.l2.cache.mshrs = config.l2.banks;
  sim::check_config(config);
  return config;
}

void expect_same_function(const tools::RenderResult& a, const tools::RenderResult& b) {
  EXPECT_EQ(difference(a, b), "");
  EXPECT_EQ(a.sampling.traced, b.sampling.traced);
  EXPECT_EQ(a.sampling.halo, b.sampling.halo);
  EXPECT_EQ(a.sampling.correction, b.sampling.correction);
  EXPECT_EQ(a.sampling.failed, b.sampling.failed);
  EXPECT_EQ(a.sampling.similar, b.sampling.similar);
}

class Adaptive : public ::testing::TestWithParam<std::tuple<const char*, Halo, AttributeStorage>> {
 protected:
  const Method method_{
      "cornell", std::get<0>(GetParam()), config_of(std::get<1>(GetParam()), std::get<2>(GetParam())), 10, 7, 4};
};
INSTANTIATE_TEST_SUITE_P(Programs, Adaptive,
                         ::testing::Combine(::testing::Values("multirate:under", "multirate:super", "undersample"),
                                            ::testing::Values(Halo::kReload, Halo::kRetrace),
                                            ::testing::Values(AttributeStorage::kTile, AttributeStorage::kDram)),
                         [](const auto& i) {
                           std::string name = std::get<0>(i.param);
                           name += std::get<1>(i.param) == Halo::kReload ? "_reload" : "_retrace";
                           name += std::get<2>(i.param) == AttributeStorage::kTile ? "_tile" : "_dram";
                           std::ranges::replace(name, ':', '_');
                           return name;
                         });

TEST_P(Adaptive, TheOracleAndEveryOrderOfUnitsGiveTheFastEnginesCounters) {
  const GpuConfig config;
  const Outcome fast = play(method_, config);
  EXPECT_EQ(difference(fast, play(method_, config, Engine::kOracle)), "");
  EXPECT_EQ(difference(fast, play(method_, config, Engine::kShuffled, 1)), "");
}

TEST_P(Adaptive, RandomMachinesGiveTheSameWithAllEngines) {
  const auto [program, halo, storage] = GetParam();
  const std::uint64_t seed = 300 + sim::hash(program[10], static_cast<int>(halo), static_cast<int>(storage)) % 100;
  const GpuConfig config = test::random_config(seed);
  const Outcome fast = play(method_, config);
  EXPECT_EQ(difference(fast, play(method_, config, Engine::kOracle)), "") << "seed " << seed;
  EXPECT_EQ(difference(fast, play(method_, config, Engine::kShuffled, seed)), "") << "seed " << seed;
}

TEST_P(Adaptive, ThreadsThatRunAheadChangeNothing) {
  const GpuConfig config;
  const Outcome alone = play(method_, config);
  for (const std::uint32_t workers : {1U, 2U}) {
    const Outcome run = play(method_, config, Engine::kFast, 0, workers);
    EXPECT_EQ(difference(alone, run), "") << workers;
    expect_same_function(alone.function, run.function);
  }
}

TEST_P(Adaptive, TheSmallestMachineFinishesWithTheSameResults) {
  const Outcome whole = play(method_, {}), small = play(method_, smallest_machine());
  expect_same_function(whole.function, small.function);
  EXPECT_GT(small.cycles, whole.cycles);
  for (const char* counter : {"samples_lines_written", "samples_lines_read", "rates_lines_read"}) {
    EXPECT_EQ(whole.sum("dma", counter), small.sum("dma", counter)) << counter;
  }
}

TEST_P(Adaptive, EveryTileIsExecutedAndItsTransfersAreCounted) {
  const auto [name, halo, storage] = GetParam();
  const Outcome run = play(method_, {});
  const std::unique_ptr<kernels::FrameProgram> program = method_.make();
  const bool scans = std::string_view(name) == "undersample";
  EXPECT_EQ(run.sum("tile_dispatcher", "finished"), program->tiles());
  EXPECT_EQ(run.sum("srp", "tiles"), program->tiles());
  const bool moves_samples = halo == Halo::kReload || storage == AttributeStorage::kDram || scans;
  EXPECT_EQ(run.sum("dma", "samples_lines_read") != 0, moves_samples);
  EXPECT_EQ(run.sum("dma", "samples_lines_written") != 0, moves_samples);
  const std::uint64_t rated = scans ? 0 : program->tiles();
  EXPECT_GE(run.sum("dma", "rates_lines_read"), rated) << "of its halo too";
  EXPECT_EQ(run.sum("dma", "rates_lines_written"), rated);
  EXPECT_EQ(run.function.sampling.halo != 0, halo == Halo::kRetrace);
}

TEST(AdaptiveRoom, RaySlotsWithAShareSpillLessAndAllEnginesAgree) {
  const Method method{"cornell", "undersample", config_of(Halo::kReload, AttributeStorage::kTile), 20, 14, 8};
  GpuConfig config;
  config.tile_buffer.size.bytes = 6 * 1024;
  config.tile_buffer.tiles_in_pass = 8;
  const Outcome crowded = play(method, config);
  config.tile_buffer.ray_share = 0.5;
  const Outcome fast = play(method, config);
  EXPECT_LT(fast.sum("tile_buffer", "spilled_slots"), crowded.sum("tile_buffer", "spilled_slots"));
  EXPECT_EQ(difference(fast, play(method, config, Engine::kOracle)), "");
  EXPECT_EQ(difference(fast, play(method, config, Engine::kShuffled, 1)), "");
  expect_same_function(fast.function, crowded.function);
}

// `normal: 2` traces every sample in three passes over a tile, so the rays are those of full:1 in another order.
TEST(AdaptivePasses, ReadLinesAgainUnlessTheL2HoldsTheScene) {
  kernels::ProgramConfig nothing_similar;
  nothing_similar.multirate.normal = 2;
  kernels::RenderConfig render;
  render.width = 64;
  render.height = 32;
  render.tile = 16;
  const traces::Scene forest = traces::open_scene("forest");
  const Method full{forest, "full:1", {}, render}, passes{forest, "multirate:under", nothing_similar, render};
  const auto fills = [](const Outcome& run) { return run.sum("l2.bank", "fills"); };

  GpuConfig config;
  config.l2.cache.size.bytes = 32 << 20;
  const Outcome whole_full = play(full, config), whole_passes = play(passes, config);
  EXPECT_EQ(whole_full.function.traversal_steps, whole_passes.function.traversal_steps);
  EXPECT_EQ(fills(whole_full), fills(whole_passes)) << "each line once, in any order";

  config.l2.cache.size.bytes = 64 << 10;
  const Outcome small_passes = play(passes, config);
  EXPECT_GT(fills(small_passes), fills(play(full, config)) * 5 / 4);
  config.cores = config.tile_buffer.tiles_in_flight = 1;
  EXPECT_LT(fills(play(passes, config)), fills(small_passes)) << "fewer tiles in flight touch less";
}

/// Tests of programs with optional features: rounds of propagation, and colours compared to choose a tile's rate.
class AdaptiveKeys : public ::testing::TestWithParam<const char*> {
 protected:
  static kernels::ProgramConfig keys() {
    kernels::ProgramConfig config = config_of(Halo::kReload, AttributeStorage::kTile);
    config.multirate.texture = 0.5;
    config.multirate.rate_texture = 0.001;
    config.supersample.propagate = 2;
    return config;
  }
  const Method method_{"chess", GetParam(), keys(), 12, 10, 8};
};
INSTANTIATE_TEST_SUITE_P(Programs, AdaptiveKeys, ::testing::Values("multirate:under", "supersample", "reconstruct"),
                         [](const auto& i) {
                           std::string name = i.param;
                           std::ranges::replace(name, ':', '_');
                           return name;
                         });

TEST_P(AdaptiveKeys, GiveTheSameWithAllEnginesFromTheDefaultToTheSmallestMachine) {
  for (const GpuConfig& config : {GpuConfig(), smallest_machine(), test::random_config(341)}) {
    const Outcome fast = play(method_, config);
    EXPECT_EQ(difference(fast, play(method_, config, Engine::kOracle)), "");
    EXPECT_EQ(difference(fast, play(method_, config, Engine::kShuffled, 1)), "");
    EXPECT_EQ(difference(fast, play(method_, config, Engine::kFast, 0, 2)), "") << "threads";
    const kernels::Sampling& found = fast.function.sampling;
    if (GetParam() == std::string_view("reconstruct")) {
      EXPECT_GT(found.traced, found.background) << "rays for samples that meet something";
    } else {
      EXPECT_GT(found.propagated + found.rough, 0U);
    }
  }
}

}  // namespace
}  // namespace hw
