#include <gtest/gtest.h>

#include "tests/hw_models/srp/srp_harness.h"

namespace hw {
namespace {

using test::SrpHarness;
using test::TileBuilder;
using traces::Access;

SrpHarness::Setup ideal() {
  SrpHarness::Setup setup;
  setup.ideal = true;
  return setup;
}

TEST(SrpIdeal, ALaunchTakesACycleWithoutSwitchDepthOrConflicts) {
  SrpHarness harness(ideal(), {{.ii = 7, .depth = 90, .conflicts = {5, 1}}});
  TileBuilder work;
  work.launch(0, 200);
  harness.add(work.build()).run();
  EXPECT_EQ(harness.cycles(0), 1U);
  EXPECT_EQ(harness.spent(Srp::CycleReason::kSwitching), 0U);
  EXPECT_EQ(harness.spent(Srp::CycleReason::kBanks), 0U);
}

TEST(SrpIdeal, ItStillWaitsForItsLinesAllAtOnceUpToTheMshrs) {
  SrpHarness::Setup setup = ideal();
  setup.config.data_cache.mshrs = 4;
  std::vector<std::vector<Access>> eight;
  for (std::uint32_t i = 0; i < 8; ++i) eight.push_back({Access::attributes(i)});
  TileBuilder work;
  work.launch(0, eight);
  SrpHarness harness(setup, {{}});
  harness.add(work.build()).run();
  // Two rounds of memory_latency + 1, with one request and one line per cycle.
  EXPECT_EQ(harness.srp().stats().cache_fills, 8U);
  EXPECT_GE(harness.cycles(0), 2 * SrpHarness::kLine);
  EXPECT_LE(harness.cycles(0), 2 * SrpHarness::kLine + 8);
  EXPECT_EQ(harness.spent(Srp::CycleReason::kCacheMiss), harness.cycles(0) - 1);
}

TEST(SrpIdeal, RaysLeaveWhenTheLinesOfTheirLaunchHaveArrived) {
  SrpHarness harness(ideal(), {{}, {}});
  TileBuilder work;
  const auto rays = work.rays(work.launch(0, {{Access::attributes(0)}, {Access::attributes(1)}}), 2);
  work.launch(1, 2, {TileBuilder::each(rays)});
  harness.add(work.build()).run();
  ASSERT_EQ(harness.rays().size(), 2U);
  EXPECT_GE(harness.rays()[0].cycle, SrpHarness::kLine);
}

TEST(SrpIdeal, AnInterfaceWithoutIntervalSendsAnyNumberOfRaysPerCycle) {
  const auto first_ray_at = [](std::uint32_t ray_interval) {
    SrpHarness::Setup setup = ideal();
    setup.ray_interval = ray_interval;
    SrpHarness harness(setup, {{}, {}});
    TileBuilder work;
    work.launch(1, 8, {TileBuilder::each(work.rays(work.launch(0, 8), 8))});
    harness.add(work.build()).run();
    EXPECT_EQ(harness.rays().size(), 8U);
    EXPECT_EQ(harness.srp().stats().rays, 8U);
    return harness.rays().front().cycle;
  };
  EXPECT_EQ(first_ray_at(0), first_ray_at(1));
}

TEST(SrpIdeal, SkippingIdleTimeChangesNothing) {
  const auto play = [](bool skip) {
    SrpHarness harness(ideal(), {{3, 20}, {1, 10}});
    TileBuilder work;
    const auto rays = work.rays(work.launch(0, {{Access::attributes(0)}, {}, {Access::attributes(9)}}), 3);
    work.launch(1, 3, {TileBuilder::each(rays)});
    harness.add(work.build());
    skip ? harness.run<sim::Skip::kOn>() : harness.run<sim::Skip::kOff>();
    return std::vector{harness.cycles(0), harness.cycles(1), harness.spent(Srp::CycleReason::kCacheMiss),
                       harness.spent(Srp::CycleReason::kWaiting)};
  };
  EXPECT_EQ(play(true), play(false));
}

}  // namespace
}  // namespace hw
