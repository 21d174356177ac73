#include <gtest/gtest.h>

#include "tests/hw_models/srp/srp_bench.h"

namespace hw {
namespace {

using testing::SrpBench;
using testing::TileBuilder;
using traces::Access;

SrpBench::Setup ideal() {
  SrpBench::Setup setup;
  setup.ideal = true;
  return setup;
}

TEST(SrpIdeal, ALaunchTakesACycleWithoutSwitchDepthOrConflicts) {
  SrpBench bench(ideal(), {{.ii = 7, .depth = 90, .conflicts = {5, 1}}});
  TileBuilder work;
  work.launch(0, 200);
  bench.add(work.build()).run();
  EXPECT_EQ(bench.cycles(0), 1U);
  EXPECT_EQ(bench.spent(Srp::CycleReason::kSwitching), 0U);
  EXPECT_EQ(bench.spent(Srp::CycleReason::kBanks), 0U);
}

TEST(SrpIdeal, ItStillWaitsForItsLinesAllAtOnceAsFarAsThereAreMissRegisters) {
  SrpBench::Setup setup = ideal();
  setup.config.data_cache.mshrs = 4;
  std::vector<std::vector<Access>> eight;
  for (std::uint32_t i = 0; i < 8; ++i) eight.push_back({Access::attributes(i)});
  TileBuilder work;
  work.launch(0, eight);
  SrpBench bench(setup, {{}});
  bench.add(work.build()).run();
  // Two rounds of memory_latency + 1, one request a cycle, one line a cycle.
  EXPECT_EQ(bench.srp().stats().cache_fills, 8U);
  EXPECT_GE(bench.cycles(0), 2 * 41U);
  EXPECT_LE(bench.cycles(0), 2 * 41U + 8);
  EXPECT_EQ(bench.spent(Srp::CycleReason::kCacheMiss), bench.cycles(0) - 1);
}

TEST(SrpIdeal, RaysLeaveWhenTheLinesOfTheirLaunchHaveCome) {
  SrpBench bench(ideal(), {{}, {}});
  TileBuilder work;
  const auto rays = work.rays(work.launch(0, {{Access::attributes(0)}, {Access::attributes(1)}}), 2);
  work.launch(1, 2, {TileBuilder::each(rays)});
  bench.add(work.build()).run();
  ASSERT_EQ(bench.rays().size(), 2U);
  EXPECT_GE(bench.rays()[0].cycle, 41U);
}

TEST(SrpIdeal, SkippingIdleTimeChangesNothing) {
  const auto play = [](bool skip) {
    SrpBench bench(ideal(), {{3, 20}, {1, 10}});
    TileBuilder work;
    const auto rays = work.rays(work.launch(0, {{Access::attributes(0)}, {}, {Access::attributes(9)}}), 3);
    work.launch(1, 3, {TileBuilder::each(rays)});
    bench.add(work.build());
    skip ? bench.run<sim::Skip::kOn>() : bench.run<sim::Skip::kOff>();
    return std::vector{bench.cycles(0), bench.cycles(1), bench.spent(Srp::CycleReason::kCacheMiss),
                       bench.spent(Srp::CycleReason::kWaiting)};
  };
  EXPECT_EQ(play(true), play(false));
}

}  // namespace
}  // namespace hw
