#include "tools/analysis/top_down.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/analysis/made_up_machine.h"
#include "tools/simulation/run_job.h"

// Every cycle of a core is in one place of the view.

namespace tools {
namespace {

double sum(const CoreTime& t) {
  return t.busy() + t.data_misses + t.tracing() + t.raster + t.raster_misses + t.transfers + t.no_tile;
}

TEST(TopDown, TimeInWhichTheArrayIdlesGoesToWhatTheRaysDoMeanwhile) {
  // The array ran 30 of 100 cycles and idled 70, 60 of them with rays in the unit. Of the time in which the traversal
  // unit had rays (80), a quarter went to visits, a quarter to misses, half to the IST, which tested half its time.
  const test::MadeUpMachine machine{.trv = {{"starved", 20}, {"visiting", 20}, {"l1_miss", 20}, {"ist", 40}},
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
  // A miss of the data cache takes 80 ns, of which the L2 keeps its requests 60, 45 of them waiting for memory.
  const test::MadeUpMachine machine{.srp = {{"running", 40}, {"cache_miss", 60}},
                                    .of_srp = {{"cache_fills", 10}, {"cache_miss_cycles", 800}},
                                    .of_l2 = {{"reads", 20}, {"latency", 1200}, {"memory_cycles", 900}}};
  const CoreTime t = top_down(machine.units(), {}).gpu;
  EXPECT_DOUBLE_EQ(t.data_misses, 0.60);
  EXPECT_DOUBLE_EQ(t.data_levels.dram, 45.0 / 80);
  EXPECT_DOUBLE_EQ(t.data_levels.l2, 15.0 / 80);
  EXPECT_DOUBLE_EQ(t.data_levels.interconnect, 20.0 / 80);
  EXPECT_EQ(t.tree_levels.dram, 0) << "there was no such miss";
}

TEST(TopDown, CoresThatHadNothingToDoTakeNothingFromTheLevelsOfOthers) {
  JobOptions options;
  options.resolution = "16x16";  // one tile
  options.sets = {"scene.triangles=500", "cores=4"};
  const Simulation s = simulate(load_inputs(options), kernels::parse_program("full:1"), 1);
  const TopDown view = top_down(s.units, s.machine);
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
    const Simulation s = simulate(load_inputs(options), kernels::parse_program("full:1"), 1);
    const TopDown view = top_down(s.units, s.machine);
    EXPECT_EQ(view.cores.size(), s.machine.cores);
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
