#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "hw_models/machines/unit_kinds.h"
#include "sim/config/config.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/run_job.h"
#include "tools/studies/baseline/check.h"

// Tests of finding the unit that a configuration key belongs to.

namespace tools {
namespace {

TEST(UnitOfKey, IsTheKindOfUnitsOfTheInnermostGroup) {
  EXPECT_EQ(unit_of_key("tni.trv.l1.size"), "core.tni.trv");
  EXPECT_EQ(unit_of_key("tni.trv.rays"), "core.tni.trv");
  EXPECT_EQ(unit_of_key("tni.ist.l1.mshrs"), "core.tni.ist");
  EXPECT_EQ(unit_of_key("tile_buffer.size"), "core.tile_buffer");
  EXPECT_EQ(unit_of_key("srp.latency.fp_add"), "core.srp");
  EXPECT_EQ(unit_of_key("raster.l1.ways"), "core.raster");
  EXPECT_EQ(unit_of_key("dma.depth"), "core.dma");
}

TEST(UnitOfKey, IsTheOnlyKindInsideTheGroup) {
  EXPECT_EQ(unit_of_key("l2.mshrs"), "l2.bank");
  EXPECT_EQ(unit_of_key("dram.timing.rl"), "dram.channel");
}

TEST(UnitOfKey, IsTheOutermostGroupIfItHasSeveralKindsOrNone) {
  EXPECT_EQ(unit_of_key("tni.miss_handling"), "tni");
  EXPECT_EQ(unit_of_key("tni.rau.rows"), "tni");
  EXPECT_EQ(unit_of_key("direct_interface.interval"), "direct_interface");
  EXPECT_EQ(unit_of_key("interconnect.latency"), "interconnect");
  EXPECT_EQ(unit_of_key("clocks.tni"), "clocks");
  EXPECT_EQ(unit_of_key("render.raster.batch"), "render") << "a setting of the function, no unit's";
  EXPECT_EQ(unit_of_key("area.arrays.l2@256KiB"), "area");
  EXPECT_EQ(unit_of_key("cores"), "");
}

TEST(UnitOfKey, IsAKindOfUnitsOrAGroupForEveryKey) {
  std::set<std::string> groups;
  const std::vector<sim::FieldInfo> fields = sim::list_fields(RunConfig{});
  for (const sim::FieldInfo& field : fields) groups.insert(field.path.substr(0, field.path.find('.')));
  for (const sim::FieldInfo& field : fields) {
    const std::string unit = unit_of_key(field.path);
    const bool is_kind = std::ranges::find(hw::kUnitKinds, unit, &hw::UnitKind::name) != hw::kUnitKinds.end();
    if (field.path.find('.') == std::string::npos) {
      EXPECT_EQ(unit, "") << field.path;
    } else {
      EXPECT_TRUE(is_kind || groups.contains(unit)) << field.path << ": " << unit;
    }
  }
}

TEST(UnitOfKey, CoversTheUnitsOfItsCounters) {
  EXPECT_TRUE(is_part_of("core.tni.trv", "core.tni.trv"));
  EXPECT_TRUE(is_part_of("core.tni.trv", "tni"));
  EXPECT_TRUE(is_part_of("l2.bank", "l2.bank"));
  EXPECT_FALSE(is_part_of("core.tni.trv", "core.tni.ist"));
  EXPECT_FALSE(is_part_of("core.dma_port", "core.dma"));
  EXPECT_FALSE(is_part_of("core.srp", "clocks"));
  EXPECT_FALSE(is_part_of("core.srp", ""));
}

TEST(ChangedKeys, ListKeysOfOnlyOneConfigurationSeparately) {
  const ChangedKeys keys = changed_keys({{"l2.mshrs", "32"}, {"l2.ways", "8"}, {"old", "1"}},
                                        {{"l2.mshrs", "8"}, {"l2.ways", "8"}, {"new.key", "2"}});
  EXPECT_EQ(changed_keys_text(keys.changed), "Changed in l2.bank: l2.mshrs was 32, is 8\n");
  EXPECT_EQ(changed_keys_text(keys.of_one), "Changed in new: new.key was none, is 2\nChanged: old was 1, is none\n");
}

TEST(ChangedKeys, MoreThanFourOfAGroupAreOneLine) {
  std::vector<KeyPair> keys = {{"dram.grade", "A", "B"}};
  for (const char* name : {"ccd_l", "faw", "ras", "rc"}) keys.push_back({std::string("dram.timing.") + name, "1", "2"});
  EXPECT_EQ(
      changed_keys_text(keys),
      "Changed in dram.channel: dram.grade was A, is B\nChanged in dram.channel: dram.timing.ccd_l was 1, is 2\n"
      "Changed in dram.channel: dram.timing.faw was 1, is 2\nChanged in dram.channel: dram.timing.ras was 1, is 2\n"
      "Changed in dram.channel: dram.timing.rc was 1, is 2\n");
  keys.push_back({"dram.timing.rcd", "1", "2"});
  EXPECT_EQ(changed_keys_text(keys),
            "Changed in dram.channel: dram.grade was A, is B\n"
            "Changed in dram.channel: dram.timing.ccd_l was 1, is 2, and 4 more keys of dram.timing\n");
}

TEST(ChangedKeys, AreGroupedByUnit) {
  EXPECT_EQ(changed_keys_text({{"l2.mshrs", "32", "8"}, {"cores", "4", "2"}, {"l2.ways", "8", "4"}}),
            "Changed in l2.bank: l2.mshrs was 32, is 8\nChanged in l2.bank: l2.ways was 8, is 4\n"
            "Changed: cores was 4, is 2\n");
}

// Tests of locating the changed unit from the counters of two runs.

/// Returns report values of a machine whose units ran for 1000 cycles.
Values machine() {
  Values v = {{"totals.cycles", 1000}};
  for (const char* unit : {"core.tni.trv", "core.srp", "l2.bank", "dram.channel"}) {
    v[std::string("units.") + unit + ".elapsed"] = 1000;
    v[std::string("units.") + unit + ".units"] = 1;
  }
  return v;
}

TEST(RegressionLocator, NamesTheSlowUnitNotTheUnitsThatWaitForIt) {
  Values was = machine(), is = machine();
  is["units.core.tni.trv.why.l1_miss"] = 100;
  is["units.core.srp.why.waiting"] = 100;
  is["units.l2.bank.why.lookup"] = 30;
  const auto located = locate_regression(was, is);
  ASSERT_TRUE(located);
  EXPECT_EQ(located->unit, "l2.bank");
  EXPECT_EQ(located->moved, "why.lookup 0 -> 30 cycles (+30)");
  EXPECT_EQ(located->certainty, 1);
}

TEST(RegressionLocator, IsLessCertainIfMoreUnitsChange) {
  Values was = machine(), is = machine();
  is["units.l2.bank.why.lookup"] = 30;
  is["units.core.srp.why.running"] = 10;
  EXPECT_DOUBLE_EQ(locate_regression(was, is)->certainty, 0.75);
}

TEST(RegressionLocator, FallsBackToTheWaitingUnitNearestToMemory) {
  Values was = machine(), is = machine();
  is["units.core.tni.trv.why.ist"] = 79;
  is["units.core.srp.why.waiting"] = 79;
  EXPECT_EQ(locate_regression(was, is)->unit, "core.tni.trv");
}

/// Returns report values of a machine whose L2 read 100 lines, with 60 cycles each in memory and 20 on the path.
Values machine_with_reads() {
  Values v = machine();
  v["units.l2.bank.counters.fills"] = 100;
  v["units.l2.bank.counters.line_cycles"] = 8000;
  v["units.dram.channel.counters.reads"] = 100;
  v["units.dram.channel.counters.read_latency"] = 6000;
  return v;
}

TEST(RegressionLocator, NamesThePathIfMissesTookLongerThanTheNextLevel) {
  Values was = machine_with_reads(), is = machine_with_reads();
  is["units.l2.bank.counters.line_cycles"] = 8100;
  const auto located = locate_regression(was, is);
  ASSERT_TRUE(located);
  EXPECT_EQ(located->unit, "path between L2 and memory");
  EXPECT_EQ(located->moved, "misses spent 2000 -> 2100 T&I cycles there (+100)");
}

TEST(RegressionLocator, NamesNoPathIfTheNextLevelServedOtherUnits) {
  // The L2 does not wait for 300 reads of the DMA, 60 cycles each, so the difference 8100 - 24000 has no meaning.
  Values was = machine_with_reads(), is = machine_with_reads();
  is["units.l2.bank.counters.line_cycles"] = 8100;
  is["units.dram.channel.counters.reads"] = 400;
  is["units.dram.channel.counters.read_latency"] = 24000;
  is["units.core.srp.why.waiting"] = 79;
  const auto located = locate_regression(was, is);
  ASSERT_TRUE(located);
  EXPECT_EQ(located->unit, "core.srp");
  EXPECT_EQ(located->moved.find("-> -"), std::string::npos) << located->moved;
}

TEST(RegressionLocator, NamesTheReasonThatChangedMost) {
  Values was = machine(), is = machine();
  is["units.core.tni.trv.why.l1_miss"] = 100;
  is["units.core.tni.trv.why.pipe"] = 60;
  is["units.l2.bank.why.lookup"] = 240;
  EXPECT_EQ(largest_change_in_unit("tni", was, is)->unit, "core.tni.trv");
  EXPECT_EQ(largest_change_in_unit("core.tni.trv", was, is)->moved, "why.l1_miss 0 -> 100 cycles (+100)");
  EXPECT_DOUBLE_EQ(largest_change_in_unit("core.tni.trv", was, is)->certainty, 0.2) << "60 of 300 cycles of work";
  EXPECT_FALSE(largest_change_in_unit("core.srp", was, is)) << "none of its reasons moved";
  EXPECT_FALSE(largest_change_in_unit("clocks", was, is));
  EXPECT_FALSE(largest_change_in_unit("", was, is));
}

TEST(RegressionLocator, IgnoresIdleCycles) {
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

TEST(RegressionLocator, ClassifiesEveryReasonOfEveryUnit) {
  for (const char* direct : {"true", "false"}) {
    JobOptions options;
    options.resolution = "4x4";
    options.sets = {"scene.triangles=500", std::string("direct_interface.enabled=") + direct, "render.primary=raster"};
    for (const sim::UnitReport& unit :
         simulate_frame(load_inputs(options), kernels::parse_program("full:1"), 1).units) {
      for (const auto& [reason, cycles] : unit.cycles_by_reason) {
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
