#include <gtest/gtest.h>

#include "tests/tools/analysis/made_up_machine.h"
#include "tools/analysis/top_down.h"

// Tests of the bottleneck that is estimated from the counters of one run.

namespace tools {
namespace {

double worth(const CoreTime& time, const std::string& resource) {
  for (const Estimate& e : estimate_speedups(time)) {
    if (e.resource == resource) return e.speedup;
  }
  ADD_FAILURE() << resource;
  return 0;
}

TEST(Limiter, IsTheShaderCoreWhereKernelsKeepTheArrayBusyAndTheUnitWaits) {
  const CoreTime t = {.kernels = 1, .demands = {.fed = 0.25, .occupied = 0.25, .tracing = 0.25}};
  EXPECT_EQ(largest_speedup(estimate_speedups(t)).resource, "srp");
  EXPECT_NEAR(worth(t, "srp"), 4, 1e-6) << "the T&I unit alone needs a quarter";
  EXPECT_TRUE(limiter_text(estimate_speedups(t)).starts_with("shader cores")) << limiter_text(estimate_speedups(t));
  EXPECT_NE(limiter_text(estimate_speedups(t)).find("x4.00"), std::string::npos) << limiter_text(estimate_speedups(t));
}

TEST(Limiter, IsTheUnitWhereTheArrayWaitsForRays) {
  const CoreTime t = {
      .kernels = 0.2, .boxes = 0.6, .triangles = 0.2, .demands = {.fed = 1, .occupied = 1, .tracing = 1}};
  EXPECT_EQ(largest_speedup(estimate_speedups(t)).resource, "tni");
  EXPECT_NEAR(worth(t, "tni"), 5, 1e-6) << "kernels alone need a fifth";
  EXPECT_NEAR(worth(t, "srp"), 1, 0.01) << "they are hidden behind the unit";
}

TEST(Limiter, IsTheFirstLevelWhereTheArrayStallsForItsLines) {
  const CoreTime t = {.kernels = 0.3,
                      .data_misses = 0.7,
                      .demands = {.fed = 0.05, .occupied = 0.05, .data_lines = 0.35, .tracing = 0.05},
                      .data_levels = {.interconnect = 0.2, .l2 = 0.3, .dram = 0.5}};
  EXPECT_EQ(largest_speedup(estimate_speedups(t)).resource, "l1");
  EXPECT_GT(worth(t, "l1"), worth(t, "l2"));
  EXPECT_GT(worth(t, "l2"), worth(t, "dram")) << "an ideal L2 asks nothing of memory";
  EXPECT_NEAR(worth(t, "dram"), 1 / (0.3 + 0.35), 0.02);
}

TEST(Limiter, NoIdealUnitHelpsWhereTheMshrsOfTheL2AreAllInUse) {
  const CoreTime t = {.kernels = 0.1,
                      .boxes = 0.2,
                      .tree_misses = 0.7,
                      .demands = {.fed = 1, .occupied = 1, .tree_lines = 0.6, .l2_lines = 1, .tracing = 1},
                      .tree_levels = {.interconnect = 0.1, .l2 = 0.4, .dram = 0.5}};
  EXPECT_EQ(worth(t, "tni"), 1);
  EXPECT_EQ(worth(t, "srp"), 1);
  EXPECT_EQ(largest_speedup(estimate_speedups(t)).resource, "l1");
}

TEST(Limiter, MoreRaySlotsCannotHideMoreThanTheShorterStage) {
  const CoreTime t = {
      .kernels = 0.5, .boxes = 0.5, .demands = {.no_slots = 0.5, .fed = 0.98, .occupied = 1, .tracing = 1}};
  EXPECT_LT(worth(t, "tile_buffer"), 1.02);
}

TEST(Limiter, TimeThatIsTheRasterisersOwnGoesByNoIdealUnit) {
  const CoreTime t = {.kernels = 0.2, .raster = 0.3, .raster_misses = 0.5, .raster_levels = {.l2 = 0.4, .dram = 0.6}};
  EXPECT_NEAR(worth(t, "l1"), 1 / 0.5, 1e-6);
  EXPECT_NEAR(worth(t, "l2"), 1 / 0.5, 1e-6);
  EXPECT_NEAR(worth(t, "dram"), 1 / 0.7, 1e-6) << "the L2 keeps its part";
  EXPECT_NEAR(worth(t, "srp"), 1 / 0.8, 1e-6);
  EXPECT_LT(worth(t, "tile_buffer"), 1.01);
}

TEST(Limiter, TimeWithoutATileShrinksWithTheTimeOfTiles) {
  const CoreTime t = {.kernels = 0.5, .no_tile = 0.5, .demands = {.fed = 0.125, .occupied = 0.125, .tracing = 0.125}};
  EXPECT_NEAR(worth(t, "srp"), 4, 1e-6) << "the last tiles are shorter, too";
}

TEST(Limiter, MemoryThatIsStillNeededBoundsTheFrameAndNotItsBusyPart) {
  // Half of the L2's MSHRs are in use, including time without a tile; at most three quarters can be.
  const CoreTime t = {.kernels = 0.1,
                      .boxes = 0.7,
                      .no_tile = 0.2,
                      .demands = {.fed = 0.7, .occupied = 0.7, .l2_lines = 0.5, .tracing = 0.7}};
  EXPECT_NEAR(worth(t, "tni"), 0.75 / 0.5, 1e-6);
}

TEST(Limiter, AQueueInFrontOfAnL2WithoutMshrsIsOfMemoryToo) {
  const CoreTime t = {
      .kernels = 0.2,
      .data_misses = 0.8,
      .data_levels = {
          .interconnect = 0.5, .l2 = 0.3, .dram = 0.2, .wires = 0.05, .blocked_request = 0.4, .blocked_bank = 0.2}};
  EXPECT_NEAR(worth(t, "dram"), 1 / (0.2 + 0.8 * (1 - 0.2 - 0.4 - 0.2)), 1e-6);
  EXPECT_NEAR(worth(t, "l2"), 1 / (0.2 + 0.8 * 0.1), 1e-6) << "the wires stay, without a queue for the L2";
  EXPECT_NEAR(worth(t, "interconnect"), 1 / (0.2 + 0.8 * 0.95), 1e-6);
  EXPECT_NEAR(worth(t, "l1"), 1 / 0.2, 1e-6);
}

TEST(Limiter, AnIdealUnitHasManyMissesUnderWayWhereTheRealOneBlocks) {
  // A blocking unit with one miss under way for 80 % of the time; its cache has 8 MSHRs.
  const CoreTime t = {
      .kernels = 0.05,
      .boxes = 0.15,
      .tree_misses = 0.8,
      .demands = {.fed = 0.95, .occupied = 0.95, .tree_lines = 0.1, .tree_waits = 0.0125, .tracing = 0.95},
      .tree_levels = {.interconnect = 0.4, .l2 = 0.3, .dram = 0.3}};
  EXPECT_NEAR(worth(t, "tni"), 1 / (0.05 + 0.1 / (2.0 / 3)), 1e-6) << "kernels, and lines with the MSHRs in use";
}

TEST(Limiter, WiresBoundWhatIdealMemoryCanBring) {
  const CoreTime t = {.kernels = 0.1,
                      .data_misses = 0.9,
                      .demands = {.port_lines = 0.35},
                      .data_levels = {.interconnect = 0.1, .l2 = 0.1, .dram = 0.8}};
  EXPECT_NEAR(worth(t, "l2"), 0.7 / 0.35, 1e-6);
  EXPECT_NEAR(worth(t, "dram"), 0.7 / 0.35, 1e-6);
  EXPECT_NEAR(worth(t, "l1"), 1 / 0.1, 1e-6) << "no line comes any more";
}

TEST(Limiter, SlotsThatDoNotFitAreAStageThatAnIdealTileBufferHasNot) {
  // Sequential stages: half of the time moves spilled slots.
  const CoreTime t = {.kernels = 0.3,
                      .boxes = 0.2,
                      .transfers = 0.0,
                      .demands = {.fed = 0.2, .occupied = 0.2, .spilling = 0.5, .spill_lines = 0.1, .tracing = 0.2}};
  EXPECT_NEAR(worth(t, "tile_buffer"), 1 / 0.5, 1e-6);
  EXPECT_NEAR(worth(t, "dram"), 1 / (0.3 + 0.2 + 0.1), 1e-6) << "they still go over the wires";
  EXPECT_NEAR(worth(t, "srp"), 1 / (0.2 + 0.5), 1e-6);
}

TEST(Limiter, WithoutSpilledSlotsMemoryHasShorterQueues) {
  // Memory is busy 80 % of the time, half of that with spilled slots: queues shrink from 4 / 1 to 2 / 3.
  const double left = (0.4 / 0.6) / (0.8 / 0.2);
  const CoreTime t = {.kernels = 0.2,
                      .data_misses = 0.8,
                      .demands = {.dram_busy = 0.8, .dram_queue = 0.5, .spills = 0.5},
                      .data_levels = {.interconnect = 0.1, .l2 = 0.1, .dram = 0.8}};
  EXPECT_NEAR(worth(t, "tile_buffer"), 1 / (0.2 + 0.8 * (1 - 0.8 * 0.5 * (1 - left))), 1e-6);
}

TEST(Limiter, NamesNothingThatIsWorthNothing) {
  const std::vector<Estimate> estimates = estimate_speedups({.no_tile = 1});
  EXPECT_LT(largest_speedup(estimates).speedup, 1.01);
  EXPECT_TRUE(limiter_text(estimates).starts_with("no single resource")) << limiter_text(estimates);
}

TEST(Limiter, UtilisationCountsSwitchesAsWorkOfTheShaderCores) {
  const test::SyntheticMachine machine{.trv = {{"visiting", 60}, {"starved", 40}},
                                       .srp = {{"running", 45}, {"switching", 20}, {"cache_miss", 35}},
                                       .dram = {{"reading", 30}, {"writing", 5}, {"idle", 65}}};
  const Utilisation u = utilisation_of(machine.units());
  EXPECT_DOUBLE_EQ(u.tni, 0.60);
  EXPECT_DOUBLE_EQ(u.srp, 0.65);
  EXPECT_DOUBLE_EQ(u.dram, 0.35);
}

TEST(Limiter, UtilisationIsTheMeanOverUnitsAndNothingWithoutAny) {
  std::vector<sim::UnitReport> units = test::SyntheticMachine{.srp = {{"running", 100}}}.units();
  const std::vector<sim::UnitReport> idle = test::SyntheticMachine{}.units();
  units.insert(units.end(), idle.begin(), idle.end());
  EXPECT_DOUBLE_EQ(utilisation_of(units).srp, 0.5);
  EXPECT_EQ(utilisation_of({}).srp, 0);
}

}  // namespace
}  // namespace tools
