#include <gtest/gtest.h>

#include "tests/hw_models/srp/srp_harness.h"

// Tests of the time in which the T&I unit has no rays while a kernel runs on the array.

namespace hw {
namespace {

using test::kA, test::kB;
using test::SrpHarness;
using test::TileBuilder;
using traces::Access;

std::uint64_t starved(const SrpHarness& harness, traces::KernelId kernel) {
  return harness.srp().kernel_use()[kernel].starved;
}

TEST(SrpStarved, ASingleLaunchWithoutRaysStarvesTheUnitSwitchAndStallsIncluded) {
  SrpHarness harness({}, {{4, 90}});
  TileBuilder work;
  work.launch(kA, {{Access::attributes(0)}, {Access::attributes(1)}});
  harness.add(work.build()).run();
  EXPECT_EQ(starved(harness, kA), SrpHarness::cold(4) + 90 + 4 + (SrpHarness::kLine - SrpHarness::kLoad));
  EXPECT_EQ(starved(harness, kA), harness.cycles(kA));
}

TEST(SrpStarved, TheFirstRayEndsItAndTheLastHitBeginsItAgain) {
  constexpr std::uint32_t kItems = 8;
  SrpHarness harness({}, {{5, 30}, {2, 20}});
  TileBuilder work;
  work.launch(kB, kItems, {TileBuilder::each(work.rays(work.launch(kA, kItems), kItems))});
  harness.add(work.build()).run();
  EXPECT_EQ(starved(harness, kA), SrpHarness::cold(5) + 30) << "until the first item leaves the array";
  EXPECT_EQ(starved(harness, kB), SrpHarness::cold(2) + 20 + (kItems - 1) * 2) << "every hit is back when it begins";
}

TEST(SrpStarved, AKernelIsNotChargedWhileTheUnitIsBusyThroughout) {
  SrpHarness::Setup setup;
  setup.tni_latency = 5000;
  SrpHarness harness(setup, {{1, 10}, {3, 40}});
  TileBuilder tracing(0), other(1);
  tracing.launch(kA, 4, {TileBuilder::each(tracing.rays(tracing.launch(kA, 4), 4))});
  other.launch(kB, 200);
  harness.add(tracing.build()).add(other.build()).run();
  EXPECT_EQ(starved(harness, kB), 0U);
  EXPECT_EQ(harness.cycles(kB), SrpHarness::cold(3) + 40 + 199 * 3);
}

TEST(SrpStarved, AKernelIsChargedOnlyFromTheReturnOfTheLastHit) {
  SrpHarness::Setup setup;
  setup.tni_latency = 300;
  SrpHarness harness(setup, {{1, 10}, {3, 40}});
  TileBuilder tracing(0), other(1);
  tracing.launch(kA, 4, {TileBuilder::each(tracing.rays(tracing.launch(kA, 4), 4))});
  other.launch(kB, 200);
  harness.add(tracing.build()).add(other.build()).run();
  // The last ray leaves when the other tile's kernel is switched in. Its hit returns after a link and the unit's
  // latency.
  EXPECT_EQ(starved(harness, kB), harness.cycles(kB) - (1 + 300));
}

}  // namespace
}  // namespace hw
