#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "sim/config/config_tree.h"
#include "tests/full_size.h"
#include "tests/hw_models/machines/conservation.h"
#include "tests/hw_models/machines/gpu_harness.h"
#include "tests/hw_models/machines/random_config.h"
#include "tests/param_name.h"

namespace hw {
namespace {

using test::difference;
using test::Frame;
using test::Outcome;
using test::play;

/// Seeds of 200 machines, in groups of 25. Tests at full size run all machines of a group.
constexpr std::uint64_t kFirstSeed = 100, kSeeds = 200, kPart = 25;

/// Returns one of eight layouts of the tree in memory, by its number.
traces::BvhConfig format_of(std::uint64_t part) {
  traces::BvhConfig bvh;
  if ((part & 1) != 0) bvh.boxes = traces::BoxRecords::kSingle;
  if ((part & 2) != 0) bvh.numbers = traces::BoxNumbers::kHybrid;
  if ((part & 4) != 0) bvh.triangle_bytes = 36;
  if ((part & 3) < 2 && part >= 4) bvh.instances = traces::InstanceLevels::kTwoLevel;
  return bvh;
}

class RandomMachines : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomMachines, MakeTheSamePictureRaysAndStepsAndLoseNothing) {
  const Frame frame("cornell", 64, 32, 1, 16, format_of(GetParam()));
  const GpuConfig standard;
  const Outcome expected = play(frame, standard);
  expect_conserved(expected, frame, standard);
  const std::uint64_t first = kFirstSeed + GetParam() * kPart;
  for (std::uint64_t seed = first; seed < first + ::test::full_or(kPart, std::uint64_t{6}); ++seed) {
    SCOPED_TRACE(seed);
    const GpuConfig config = test::random_config(seed);
    const Outcome run = play(frame, config);
    EXPECT_EQ(difference(expected.function, run.function), "");
    EXPECT_EQ(run.sum("ist", "tests"), expected.sum("ist", "tests"));
    EXPECT_EQ(run.sum("ist", "hits"), expected.sum("ist", "hits"));
    EXPECT_EQ(run.sum("srp", "items"), expected.sum("srp", "items"));
    expect_conserved(run, frame, config);
  }
}

INSTANTIATE_TEST_SUITE_P(TwoHundred, RandomMachines, ::testing::Range(std::uint64_t{0}, kSeeds / kPart),
                         ::test::ParamName());

/// Returns one of eight kinds of wide trees, by its number.
traces::BvhConfig wide_format_of(std::uint64_t number) {
  using enum traces::NodeFormat;
  traces::BvhConfig bvh;
  bvh.format = std::array{kQ8, kQ12, kCw80, kFp32, kHybrid, kQ8, kQ12, kFp32}[number % 8];
  bvh.width = std::array{8U, 8U, 8U, 4U, 6U, 4U, 6U, 8U}[number % 8];
  bvh.leaf = std::array{traces::LeafFormat::kTriangles, traces::LeafFormat::kBlock128,
                        traces::LeafFormat::kPair64}[number % 3];
  bvh.leaf_size = 3;
  bvh.order = bvh.format == kCw80 ? traces::ChildOrder::kOctant
              : number % 2 == 0   ? traces::ChildOrder::kSort
                                  : traces::ChildOrder::kNearest;
  if (number % 5 == 0 && bvh.format != kHybrid) bvh.instances = traces::InstanceLevels::kTwoLevel;
  return bvh;
}

class WideRandomMachines : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(WideRandomMachines, MakeTheSamePictureOnAnyEngineAndLoseNothing) {
  for (std::uint64_t seed = GetParam(); seed < ::test::full_or(50U, 20U); seed += 10) {
    SCOPED_TRACE(seed);
    const Frame frame("cornell", 16, 16, 1, 16, wide_format_of(seed));
    const GpuConfig config = test::random_wide_config(seed);
    const Outcome run = play(frame, config);
    EXPECT_EQ(difference(run, play(frame, config, test::Engine::kOracle)), "");
    EXPECT_EQ(difference(run, play(frame, config, test::Engine::kShuffled, seed)), "");
    EXPECT_EQ(difference(play(frame, GpuConfig()).function, run.function), "");
    expect_conserved(run, frame, config);
    EXPECT_EQ(run.sum("trv", "box_tests") + run.sum("trv", "hybrid_box_tests") + run.sum("trv", "q8_box_tests") +
                  run.sum("trv", "q12_box_tests") + run.sum("trv", "idle_lanes"),
              run.sum("trv", "box_cycles") * config.tni.trv.box_testers);
  }
}

INSTANTIATE_TEST_SUITE_P(Fifty, WideRandomMachines, ::testing::Range(std::uint64_t{0}, std::uint64_t{10}),
                         ::test::ParamName());

/// Counts how often each value of each enum or boolean field was drawn.
using Draws = std::map<std::string, std::map<std::string, int>>;

void count_choices(const sim::ConfigNode& node, Draws& draws) {
  for (const sim::ConfigNode& child : node.children) count_choices(child, draws);
  if (node.is_group() || (node.affects != sim::Affects::kTiming && node.affects != sim::Affects::kWalk)) return;
  if (const auto* choice = std::get_if<sim::EnumTarget>(&*node.target)) {
    for (const std::string_view name : choice->names) draws[node.path].try_emplace(std::string(name), 0);
    ++draws[node.path][std::string(choice->names[choice->get()])];
  } else if (const auto* on = std::get_if<bool*>(&*node.target)) {
    for (const char* name : {"false", "true"}) draws[node.path].try_emplace(name, 0);
    ++draws[node.path][**on ? "true" : "false"];
  } else if (node.path == "tni.trv.box_testers" || node.path == "dram.organisation.ranks") {
    for (const char* name : {"1", "2"}) draws[node.path].try_emplace(name, 0);
    const std::string value = std::to_string(*std::get<std::uint32_t*>(*node.target));
    if (draws[node.path].contains(value)) ++draws[node.path][value];
  }
}

TEST(RandomMachinesDrawn, HaveEveryMechanismMoreThanAFewTimes) {
  Draws draws;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSeeds; ++seed) {
    GpuConfig config = test::random_config(seed);
    count_choices(sim::config_tree(config), draws);
    GpuConfig wide = test::random_wide_config(seed);
    count_choices(sim::config_tree(wide), draws);
  }
  EXPECT_GE(draws.size(), 20U);
  for (const auto& [path, values] : draws) {
    for (const auto& [value, times] : values) EXPECT_GE(times, 20) << path << " = " << value;
  }
}

TEST(Gpu, NothingIsLostWithSeveralSamplesPerPixelAndCutTiles) {
  const Frame frame("teapot", 37, 21, 4);
  const GpuConfig config;
  expect_conserved(play(frame, config), frame, config);
}

/// Returns a machine with all queues at their minimum and one item of each kind in flight.
GpuConfig smallest() {
  GpuConfig c;
  c.tni.link_depth = 1;
  c.tni.trv.rays = c.tni.trv.l1.mshrs = c.tni.trv.stack_entries = 1;
  c.tni.trv.l1.size.bytes = c.tni.ist.l1.size.bytes = c.srp.data_cache.size.bytes = 64;
  c.tni.trv.l1.ways = c.tni.ist.l1.ways = c.srp.data_cache.ways = 1;
  c.tni.ist.leaves = c.tni.ist.l1.mshrs = 1;
  c.direct_interface.depth = 1;
  c.srp.chunk = c.srp.data_cache.mshrs = 1;
  c.srp.latency.load_queue = 0;
  c.srp.config_memory.bytes = 0;
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

TEST(Gpu, QueuesOfOneAndATileBufferTooSmallForATileStillFinish) {
  const Frame frame("cornell", 16, 16);
  for (const std::uint32_t cores : {1U, 4U}) {
    GpuConfig config = smallest();
    config.cores = cores;
    const Outcome run = play(frame, config);
    expect_conserved(run, frame, config);
    EXPECT_EQ(run.sum("tile_buffer", "spilled_slots"), run.rays()) << "no slot fits, so every ray spills";
  }
}

TEST(Gpu, ATileBufferOfHalfATileSpillsAndFinishes) {
  const Frame& frame = test::cornell_64x32();
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
