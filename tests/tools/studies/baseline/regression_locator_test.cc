#include "tools/studies/baseline/regression_locator.h"

#include <gtest/gtest.h>

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

TEST(Suspect, IsTheUnitWhoseOwnTimeMovedNotTheOnesThatWaitForIt) {
  Values was = machine(), is = machine();
  is["units.core.tni.trv.why.l1_miss"] = 100;
  is["units.core.srp.why.waiting"] = 100;
  is["units.l2.bank.why.lookup"] = 30;
  const auto suspect = find_suspect(was, is);
  ASSERT_TRUE(suspect);
  EXPECT_EQ(suspect->unit, "l2.bank");
  EXPECT_EQ(suspect->moved, "why.lookup 0 -> 30 cycles (+30)");
  EXPECT_EQ(suspect->clarity, 1);
}

TEST(Suspect, IsLessClearTheMoreUnitsMove) {
  Values was = machine(), is = machine();
  is["units.l2.bank.why.lookup"] = 30;
  is["units.core.srp.why.running"] = 10;
  EXPECT_DOUBLE_EQ(find_suspect(was, is)->clarity, 0.75);
}

TEST(Suspect, WithoutAnyIsTheUnitNearestToMemoryThatWaitedLonger) {
  Values was = machine(), is = machine();
  is["units.core.tni.trv.why.ist"] = 79;
  is["units.core.srp.why.waiting"] = 79;
  EXPECT_EQ(find_suspect(was, is)->unit, "core.tni.trv");
}

TEST(Suspect, NothingToDoMeansNothing) {
  Values was = machine(), is = machine();
  is["units.core.tni.trv.why.starved"] = 79;
  is["units.dram.channel.why.idle"] = 79;
  is["units.dram.channel.why.refresh"] = 79;
  EXPECT_FALSE(find_suspect(was, is));
  EXPECT_FALSE(find_suspect({}, {})) << "no unit is kept";
}

TEST(Suspect, EveryReasonOfEveryUnitIsOneKindOfReason) {
  for (const char* direct : {"true", "false"}) {
    JobOptions options;
    options.resolution = "4x4";
    options.sets = {"scene.triangles=500", std::string("direct_interface.enabled=") + direct};
    for (const sim::UnitReport& unit : simulate(load_inputs(options), kernels::parse_program("full:1"), 1).units) {
      for (const auto& [reason, cycles] : unit.why) {
        EXPECT_TRUE(kind_of_reason(reason))
            << unit.path << " " << reason << ": add it to tools/studies/baseline/regression_locator.cc";
      }
    }
  }
  EXPECT_FALSE(kind_of_reason("reorder"));
}

}  // namespace
}  // namespace tools
