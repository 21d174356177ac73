#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/srp/array_loop.h"
#include "tests/hw_models/srp/srp_harness.h"

// Tests of switches to kernels that are resident in configuration memory, and to others.

namespace hw {
namespace {

using test::SrpHarness;
using test::TileBuilder;

constexpr std::uint64_t kRow = 128;  // bytes: 16 units, 8 bytes each

/// Returns a tile with launches of these kernels, one after the other.
traces::TileWork launches(const std::vector<traces::KernelId>& kernels) {
  TileBuilder work;
  std::vector<TileBuilder::Edge> before;
  for (const traces::KernelId kernel : kernels) before = {TileBuilder::all(work.launch(kernel, 16, before))};
  return work.build();
}

SrpHarness::Setup with_memory(std::uint64_t bytes) {
  SrpHarness::Setup setup;
  setup.config.config_memory.bytes = bytes;
  return setup;
}

TEST(SrpSwitches, OnlyTheFirstSwitchToAKernelIsColdIfAllFit) {
  SrpHarness harness(with_memory(10 * kRow), {{3, 20}, {7, 20}});
  harness.add(launches({0, 1, 0, 1, 0})).run();
  const SrpStats& stats = harness.srp().stats();
  EXPECT_EQ(stats.switches, 5U);
  EXPECT_EQ(stats.cold_switches, 2U);
  EXPECT_EQ(stats.resident_switches, 3U);
  EXPECT_EQ(stats.config_rows_loaded, 3U + 7U);
  EXPECT_EQ(stats.config_rows_switched, 3 * 3U + 2 * 7U);
  EXPECT_EQ(harness.spent(Srp::CycleReason::kSwitching),
            SrpHarness::cold(3) + SrpHarness::cold(7) + 3 * SrpHarness::kResident);
}

TEST(SrpSwitches, EverySwitchIsColdIfOneRowIsMissing) {
  SrpHarness harness(with_memory(10 * kRow - 1), {{3, 20}, {7, 20}});
  harness.add(launches({0, 1, 0, 1, 0})).run();
  EXPECT_EQ(harness.srp().stats().resident_switches, 0U);
  EXPECT_EQ(harness.srp().stats().config_rows_loaded, 3 * 3U + 2 * 7U);
  EXPECT_EQ(harness.spent(Srp::CycleReason::kSwitching), 3 * SrpHarness::cold(3) + 2 * SrpHarness::cold(7));
}

TEST(SrpSwitches, OfThreeKernelsInRoomForTwoTheLeastRecentlyUsedIsEvicted) {
  SrpHarness harness(with_memory(4 * kRow), {{2, 20}, {2, 20}, {2, 20}});
  harness.add(launches({0, 1, 0, 2, 0, 1})).run();
  EXPECT_EQ(harness.srp().stats().resident_switches, 2U) << "0, twice";
  EXPECT_EQ(harness.srp().stats().cold_switches, 4U);
}

TEST(SrpSwitches, LoadingTakesWholeCyclesOfItsPort) {
  for (const auto& [word, load, cycles] :
       {std::tuple{8U, 64U, 6U}, {8U, 128U, 3U}, {8U, 256U, 2U}, {4U, 64U, 3U}, {1U, 64U, 1U}}) {
    SrpHarness::Setup setup;
    setup.config.config_word.bytes = word;
    setup.config.config_load.bytes = load;
    SrpHarness harness(setup, {{3, 20}});
    harness.add(launches({0})).run();
    EXPECT_EQ(harness.spent(Srp::CycleReason::kSwitching), SrpHarness::kResident + cycles) << word << ' ' << load;
  }
}

TEST(SrpSwitches, AnIdealShaderCoreMakesNone) {
  SrpHarness::Setup setup;
  setup.ideal = true;
  SrpHarness harness(setup, {{3, 20}, {7, 20}});
  harness.add(launches({0, 1, 0})).run();
  EXPECT_EQ(harness.srp().stats().switches, 0U);
  EXPECT_EQ(harness.srp().stats().config_rows_switched, 0U);
}

TEST(SrpSwitches, TheOracleAgreesForAnySizeOfTheMemory) {
  for (const std::uint64_t rows : {0U, 5U, 9U, 12U}) {
    const std::vector<SrpHarness::Kernel> kernels = {{2, 33}, {5, 71}, {4, 12}};
    SrpHarness fast(with_memory(rows * kRow), kernels), oracle(with_memory(rows * kRow), kernels);
    for (SrpHarness* harness : {&fast, &oracle}) harness->add(launches({0, 1, 2, 0})).add(launches({2, 0, 1}));
    fast.run();
    oracle.run<sim::Skip::kOff>();
    SCOPED_TRACE(rows);
    test::expect_equal_cycles(fast, oracle);
    const SrpStats& stats = fast.srp().stats();
    EXPECT_EQ(stats.switches, stats.cold_switches + stats.resident_switches);
    EXPECT_EQ(stats.cold_switches, oracle.srp().stats().cold_switches);
  }
}

TEST(ConfigMemory, AKernelIsLoadedOnceAndStaysWhileAllFit) {
  ConfigMemory memory(100, 3);
  for (const auto kernel : std::to_array<traces::KernelId>({0, 1, 2}))
    EXPECT_FALSE(memory.select_kernel(kernel, kernel == 2 ? 20 : 40));
  for (const auto kernel : std::to_array<traces::KernelId>({2, 0, 1, 1, 0, 2}))
    EXPECT_TRUE(memory.select_kernel(kernel, kernel == 2 ? 20 : 40));
}

TEST(ConfigMemory, TheLeastRecentlyUsedKernelIsEvicted) {
  ConfigMemory memory(100, 4);
  memory.select_kernel(0, 40);
  memory.select_kernel(1, 40);
  memory.select_kernel(0, 40);
  EXPECT_FALSE(memory.select_kernel(2, 50)) << "1 goes, 0 ran later";
  EXPECT_TRUE(memory.select_kernel(0, 40));
  EXPECT_FALSE(memory.select_kernel(1, 40));
}

TEST(ConfigMemory, ALargeKernelEvictsAsManyAsItNeeds) {
  ConfigMemory memory(100, 4);
  for (const auto kernel : std::to_array<traces::KernelId>({0, 1, 2})) memory.select_kernel(kernel, 30);
  EXPECT_FALSE(memory.select_kernel(3, 70));
  EXPECT_TRUE(memory.select_kernel(2, 30));
  EXPECT_FALSE(memory.select_kernel(1, 30)) << "3 goes, 2 ran later";
  EXPECT_TRUE(memory.select_kernel(2, 30));
}

TEST(ConfigMemory, AKernelLargerThanTheMemoryIsAlwaysLoadedAndLeavesNoneResident) {
  ConfigMemory memory(100, 2);
  memory.select_kernel(0, 40);
  EXPECT_FALSE(memory.select_kernel(1, 101));
  EXPECT_FALSE(memory.select_kernel(1, 101));
  EXPECT_FALSE(memory.select_kernel(0, 40));
  EXPECT_TRUE(memory.select_kernel(0, 40));
}

}  // namespace
}  // namespace hw
