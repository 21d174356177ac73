#include "tools/studies/baseline/regression_locator.h"

#include <regex>

#include <gtest/gtest.h>

#include "hw_models/machines/unit_kinds.h"
#include "tools/simulation/run_job.h"

// Which unit has changed, from what two runs say.

namespace tools {
namespace {

/// A machine in which each unit ran for 1000 cycles.
Values machine() {
  Values v = {{"totals.cycles", 1000}};
  for (const char* unit : {"core.tni.trv", "core.srp", "l2.bank", "dram.channel"}) {
    v[std::string("units.") + unit + ".elapsed"] = 1000;
    v[std::string("units.") + unit + ".units"] = 1;
  }
  return v;
}

TEST(RegressionLocator, IsTheUnitWhoseOwnTimeMovedNotTheOnesThatWaitForIt) {
  Values was = machine(), is = machine();
  is["units.core.tni.trv.why.l1_miss"] = 100;
  is["units.core.srp.why.waiting"] = 100;
  is["units.l2.bank.why.lookup"] = 30;
  const auto located = locate_regression(was, is);
  ASSERT_TRUE(located);
  EXPECT_EQ(located->unit, "l2.bank");
  EXPECT_EQ(located->moved, "why.lookup 0 -> 30 cycles (+30)");
  EXPECT_EQ(located->clarity, 1);
}

TEST(RegressionLocator, IsLessClearTheMoreUnitsMove) {
  Values was = machine(), is = machine();
  is["units.l2.bank.why.lookup"] = 30;
  is["units.core.srp.why.running"] = 10;
  EXPECT_DOUBLE_EQ(locate_regression(was, is)->clarity, 0.75);
}

TEST(RegressionLocator, WithoutAnyIsTheUnitNearestToMemoryThatWaitedLonger) {
  Values was = machine(), is = machine();
  is["units.core.tni.trv.why.ist"] = 79;
  is["units.core.srp.why.waiting"] = 79;
  EXPECT_EQ(locate_regression(was, is)->unit, "core.tni.trv");
}

TEST(RegressionLocator, NothingToDoMeansNothing) {
  Values was = machine(), is = machine();
  is["units.core.tni.trv.why.starved"] = 79;
  is["units.dram.channel.why.idle"] = 79;
  is["units.dram.channel.why.refresh"] = 79;
  EXPECT_FALSE(locate_regression(was, is));
  EXPECT_FALSE(locate_regression({}, {})) << "no unit is kept";
  is["units.l2.bank.why.lookup"] = 30;
  EXPECT_TRUE(locate_regression(was, is));
  EXPECT_FALSE(locate_regression({{"totals.cycles", 100}}, is)) << "no unit was kept";
}

TEST(RegressionLocator, EveryReasonOfEveryUnitIsOneKindOfReason) {
  for (const char* direct : {"true", "false"}) {
    JobOptions options;
    options.resolution = "4x4";
    options.sets = {"scene.triangles=500", std::string("direct_interface.enabled=") + direct, "render.primary=raster"};
    for (const sim::UnitReport& unit : simulate(load_inputs(options), kernels::parse_program("full:1"), 1).units) {
      for (const auto& [reason, cycles] : unit.why) {
        const std::string kind = std::regex_replace(unit.path, std::regex("(core|trv|bank|channel)[0-9]+"), "$1");
        EXPECT_TRUE(hw::kind_of_reason(kind, reason)) << unit.path << " " << reason << ": add it to kUnitKinds";
      }
    }
  }
  EXPECT_FALSE(hw::kind_of_reason("core.tni.trv", "reorder"));
  EXPECT_FALSE(hw::kind_of_reason("core.trv", "l1_miss"));
}

}  // namespace
}  // namespace tools
