#include <gtest/gtest.h>

#include "hw_models/machines/gpu_config.h"
#include "tests/tools/analysis/made_up_machine.h"
#include "tools/analysis/top_down.h"
#include "tools/run/frame/run_job.h"

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

// Tests that every cycle of a core is charged to exactly one cause.

double sum(const CoreTime& t) {
  return t.busy_share() + t.data_misses + t.tracing_share() + t.raster + t.raster_misses + t.transfers + t.no_tile;
}

TEST(TopDown, TimeInWhichTheArrayIdlesGoesToWhatTheRaysDoMeanwhile) {
  // The array ran 30 of 100 cycles and idled 70, 60 of them with rays in the unit. Of the TRV's 80 cycles with rays, a
  // quarter were visits, a quarter misses, half waits for the IST, which tested half its time.
  const test::SyntheticMachine machine{.trv = {{"starved", 20}, {"visiting", 20}, {"l1_miss", 20}, {"ist", 40}},
                                       .ist = {{"starved", 60}, {"testing", 20}, {"l1_miss", 10}, {"mshr_full", 10}},
                                       .srp = {{"running", 30}, {"waiting", 50}, {"no_slots", 15}, {"starved", 5}},
                                       .of_srp = {{"fed", 75}, {"awaited", 60}}};
  const CoreTime t = top_down(machine.units(), {}).gpu;
  EXPECT_DOUBLE_EQ(t.kernels, 0.30);
  EXPECT_DOUBLE_EQ(t.boxes, 0.60 / 4);
  EXPECT_DOUBLE_EQ(t.triangles, 0.60 / 2 / 2);
  EXPECT_NEAR(t.tree_misses, 0.60 / 4 + 0.60 / 2 / 2, 1e-12);
  EXPECT_NEAR(t.pipes, 0, 1e-12);
  EXPECT_NEAR(t.transfers, 0.05, 1e-12) << "launches wait, and no ray is out";
  EXPECT_DOUBLE_EQ(t.no_tile, 0.05);
  EXPECT_DOUBLE_EQ(t.demands.no_slots, 0.15);
  EXPECT_DOUBLE_EQ(t.demands.fed, 0.75);
  EXPECT_NEAR(sum(t), 1, 1e-12);
}

TEST(TopDown, MissesGoToTheLevelsAtWhichTheirTimePasses) {
  // A data cache miss takes 80 ns: 60 in the L2, 45 of them waiting for memory.
  const test::SyntheticMachine machine{.srp = {{"running", 40}, {"cache_miss", 60}},
                                       .of_srp = {{"cache_fills", 10}, {"cache_miss_cycles", 800}},
                                       .of_l2 = {{"reads", 20}, {"latency", 1200}, {"memory_cycles", 900}}};
  const CoreTime t = top_down(machine.units(), {}).gpu;
  EXPECT_DOUBLE_EQ(t.data_misses, 0.60);
  EXPECT_DOUBLE_EQ(t.data_levels.dram, 45.0 / 80);
  EXPECT_DOUBLE_EQ(t.data_levels.l2, 15.0 / 80);
  EXPECT_DOUBLE_EQ(t.data_levels.interconnect, 20.0 / 80);
  EXPECT_EQ(t.tree_levels.dram, 0) << "there was no such miss";
}

TEST(TopDown, QueuesInFrontOfAnL2WithoutMshrsAreSeenApartFromWires) {
  // A miss takes 100 ns: 1 for the lookup, 11 on wires (1 in the port, 2 x 4 of distance, 2 for 64 bytes at 32 bytes
  // per cycle), 60 in the L2, and 28 queued before the L2. The 60 are 30 for memory, 5 for the lookup and 25 more. Half
  // of the 25 is charged to MSHRs, because a bank waited for an MSHR in half of its sampled cycles.
  const test::SyntheticMachine machine{.trv = {{"visiting", 40}, {"l1_miss", 60}},
                                       .l2 = {{"serving", 30}, {"mshr_full", 30}, {"memory", 40}},
                                       .of_trv = {{"l1_fills", 1}, {"l1_miss_cycles", 100}, {"l1_late", 3}},
                                       .of_l2 = {{"reads", 1}, {"misses", 1}, {"latency", 60}, {"memory_cycles", 30}},
                                       .of_port = {{"lines_down", 10}}};
  const CoreTime t = top_down(machine.units(), {}).cores.at(0);
  EXPECT_DOUBLE_EQ(t.tree_levels.interconnect, 0.40);
  EXPECT_DOUBLE_EQ(t.tree_levels.l2, 0.30);
  EXPECT_DOUBLE_EQ(t.tree_levels.dram, 0.30);
  EXPECT_NEAR(t.tree_levels.blocked_request, 0.28, 1e-12);
  EXPECT_NEAR(t.tree_levels.blocked_bank, 0.125, 1e-12);
  EXPECT_NEAR(t.tree_levels.wires, 0.07, 1e-12) << "an ideal one takes 4 of the 11";
  EXPECT_DOUBLE_EQ(t.demands.tree_lines, 1.0 / 8) << "a miss under way all the time, of 8 MSHRs";
  EXPECT_DOUBLE_EQ(t.demands.tree_waits, 3.0 / 64) << "three rays wait for the line";
  EXPECT_DOUBLE_EQ(t.demands.tests, 0.40);
  EXPECT_DOUBLE_EQ(t.demands.port_lines, 0.20) << "ten lines of two cycles each";
}

TEST(TopDown, QueuesInFrontOfAnL2ThatTakesRequestsAreThePortsOwn) {
  const test::SyntheticMachine machine{.trv = {{"visiting", 40}, {"l1_miss", 60}},
                                       .l2 = {{"serving", 60}, {"memory", 40}},
                                       .of_trv = {{"l1_fills", 1}, {"l1_miss_cycles", 100}},
                                       .of_l2 = {{"reads", 1}, {"misses", 1}, {"latency", 60}, {"memory_cycles", 30}}};
  const MissLevels l = top_down(machine.units(), {}).cores.at(0).tree_levels;
  EXPECT_EQ(l.blocked_share(), 0);
  EXPECT_NEAR(l.wires, 0.28 + 0.07, 1e-12);
}

TEST(TopDown, OfMemorysTrafficTheSpilledSlotsAreSeenApart) {
  // Memory moved 40 lines, 20 of them for the DMA, 10 of these spilled slots. The DMA was active for 50 of 100 cycles.
  const test::SyntheticMachine machine{
      .dram = {{"reading", 40}, {"row_conflict", 30}, {"latency", 10}, {"idle", 20}},
      .dma = {{"moving", 20}, {"waiting", 30}, {"idle", 50}},
      .of_dram = {{"reads", 25}, {"writes", 15}},
      .of_dma = {{"lines_written", 15}, {"lines_read", 5}, {"spill_lines_written", 5}, {"spill_lines_read", 5}}};
  const CoreTime::Demands d = top_down(machine.units(), {}).gpu.demands;
  EXPECT_DOUBLE_EQ(d.transfers, 0.5);
  EXPECT_DOUBLE_EQ(d.spills, 0.25);
  EXPECT_DOUBLE_EQ(d.spilling, 0.5 * 10 / 20);
  EXPECT_DOUBLE_EQ(d.spill_lines, 0.20) << "ten lines of two cycles each";
  EXPECT_DOUBLE_EQ(d.dram_bus, 0.40);
  EXPECT_DOUBLE_EQ(d.dram_busy, 0.70);
}

TEST(TopDown, CoresThatHadNothingToDoTakeNothingFromTheLevelsOfOthers) {
  JobOptions options;
  options.resolution = "16x16";  // one tile
  options.sets = {"scene.triangles=500", "cores=4"};
  const FrameResult s = simulate_frame(load_inputs(options), kernels::parse_program("full:1"), 1);
  const TopDown view = top_down(s.units, *s.machine);
  for (const MissLevels& l : {view.gpu.data_levels, view.gpu.tree_levels}) {
    EXPECT_NEAR(l.interconnect + l.l2 + l.dram, 1, 1e-9);
  }
}

TEST(TopDown, SharesOfEveryCoreOfARealFrameSumToOneWhateverTheMachine) {
  for (const char* set : {"cores=2", "tni.miss_handling=blocking", "tni.miss_handling=rau", "tni.trv.box_testers=1",
                          "direct_interface.enabled=false", "ideal.l1=true", "render.primary=raster"}) {
    SCOPED_TRACE(set);
    JobOptions options;
    options.resolution = "64x32";
    options.sets = {set};
    const FrameResult s = simulate_frame(load_inputs(options), kernels::parse_program("full:1"), 1);
    const TopDown view = top_down(s.units, *s.machine);
    EXPECT_EQ(view.cores.size(), s.machine->cores);
    for (const CoreTime& core : view.cores) EXPECT_NEAR(sum(core), 1, 1e-9);
    EXPECT_NEAR(sum(view.gpu), 1, 1e-9);
    EXPECT_EQ(view.gpu.raster + view.gpu.raster_misses > 0, std::string(set) == "render.primary=raster");
    for (const MissLevels& l : {view.gpu.data_levels, view.gpu.tree_levels, view.gpu.raster_levels}) {
      const double all = l.interconnect + l.l2 + l.dram;
      EXPECT_TRUE(all == 0 || std::abs(all - 1) < 1e-9) << all;
    }
  }
}

TEST(TopDown, InWordsTheLargestComesFirst) {
  const CoreTime t = {.kernels = 0.2,
                      .data_misses = 0.5,
                      .boxes = 0.299,
                      .pipes = 0.001,
                      .data_levels = {.interconnect = 0.1, .l2 = 0.3, .dram = 0.6}};
  EXPECT_EQ(top_down_text(time_json(t)),
            "data-cache misses 50 % (DRAM 30 %, L2 15 %, interconnect 5 %), box tests 30 %, kernels 20 %");
}

}  // namespace
}  // namespace tools
