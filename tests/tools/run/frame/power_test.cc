#include "tools/run/frame/power.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/config/value.h"
#include "sim/error.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/machine_run.h"

namespace tools {
namespace {

RunConfig with(const std::vector<std::string>& sets) {
  JobOptions options;
  options.sets = sets;
  return load_run_config(options);
}

TEST(ClockDomains, HaveTheClocksOfAllUnitsOfTheirBlocks) {
  const RunConfig config = with({"clocks.tni=400 MHz", "clocks.srp=900 MHz", "clocks.l2=450 MHz"});
  for (const sim::UnitReport& unit : idle_unit_reports(*config.gpu, {.rasterisers = true, .tree_builder = true})) {
    if (unit.block == "dram") continue;
    int domains = 0;
    for (const ClockDomain& domain : clock_domains()) {
      if (std::ranges::find(domain.blocks, unit.block) == domain.blocks.end()) continue;
      domains += 1;
      EXPECT_EQ(unit.clock_mhz, (config.gpu->clocks.*domain.clock).hz / 1'000'000) << unit.path;
    }
    EXPECT_EQ(domains, 1) << unit.path;
  }
}

TEST(PowerScales, AreOneAtTheDefaultClocksWithOrWithoutDvfs) {
  for (const char* voltage : {"power.voltage=nominal", "power.voltage=dvfs"}) {
    for (const auto& [block, scale] : power_scales(with({voltage}))) {
      EXPECT_EQ(scale.dynamic, 1) << block;
      EXPECT_EQ(scale.leakage, 1) << block;
    }
  }
}

TEST(PowerWarnings, AreOfClocksWhoseVoltageIsNotTheTables) {
  EXPECT_TRUE(power_warnings(with({})).empty());
  const std::vector<std::string> slow = power_warnings(with({"clocks.tni=400 MHz"}));
  ASSERT_EQ(slow.size(), 1U);
  EXPECT_NE(slow.front().find("clocks.tni of 400 MHz needs 0.7155 V"), std::string::npos) << slow.front();
  EXPECT_TRUE(power_warnings(with({"clocks.tni=400 MHz", "power.voltage=dvfs"})).empty());
  EXPECT_TRUE(power_warnings(with({"clocks.tni=700 MHz", "power.voltage=dvfs"})).empty());
  const std::vector<std::string> fast = power_warnings(with({"clocks.tni=1600 MHz", "power.voltage=dvfs"}));
  ASSERT_EQ(fast.size(), 2U);
  EXPECT_NE(fast[0].find("power.max_voltage: clocks.tni of 1600 MHz needs"), std::string::npos) << fast[0];
  EXPECT_NE(fast[1].find("clocks.tni of 1600 MHz is outside 77 MHz to 1500 MHz"), std::string::npos) << fast[1];
}

TEST(PowerTables, OfADomainThatThereIsNotGetTheNearest) {
  try {
    with({"power.dvfs.tnu@1GHz=0.9"});
    FAIL() << "no refusal";
  } catch (const sim::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'tnu', did you mean 'tni'"), std::string::npos) << error.what();
  }
}

const std::vector<std::string> kAuto = {"tni.trv.l1.hit_cycles=auto", "tni.ist.l1.hit_cycles=auto",
                                        "l2.hit_cycles=auto"};

std::vector<std::uint32_t> cycles(const RunConfig& c) {
  return {c.gpu->tni.trv.l1.hit_cycles, c.gpu->tni.ist.l1.hit_cycles, c.gpu->l2.cache.hit_cycles};
}

std::vector<std::string> auto_and(std::vector<std::string> more) {
  more.insert(more.begin(), kAuto.begin(), kAuto.end());
  return more;
}

TEST(HitCycles, ThatAreAutoAreTheDefaultMachinesForItsSizes) {
  EXPECT_EQ(cycles(with(kAuto)), cycles(with({})));
  EXPECT_TRUE(latency_warnings(with(kAuto)).empty());
}

// 0.301 ns is one cycle at 1 GHz, 1.02 ns two; 0.848 ns and 0.609 ns are two cycles at 2 GHz, 0.496 ns one.
TEST(HitCycles, ThatAreAutoFollowSizeAndClock) {
  EXPECT_EQ(cycles(with(auto_and({"clocks.tni=1 GHz", "tni.trv.l1.size=512 KiB", "tni.ist.l1.size=16 KiB"}))),
            (std::vector<std::uint32_t>{3, 2, 12}));
  EXPECT_EQ(cycles(with(auto_and({"clocks.l2=2 GHz"}))).at(2), 13U);
  EXPECT_EQ(cycles(with(auto_and({"clocks.l2=2 GHz", "l2.size=32 KiB"}))).at(2), 12U);
}

// 1.02 ns at 512 KiB are three cycles at 2 GHz.
TEST(HitCycles, OfTheSystemCacheThatAreAutoFollowItsSize) {
  const auto cycles_at = [](const char* size) {
    const RunConfig c = with({"slc.hit_cycles=auto", "clocks.l2=2 GHz", std::string("slc.size=") + size});
    return c.gpu->slc.cache.hit_cycles.value;
  };
  EXPECT_EQ(cycles_at("512 KiB"), 11U + 3);
  EXPECT_GT(cycles_at("16 MiB"), cycles_at("1 MiB"));
  const std::vector<std::string> lines = latency_warnings(with({"slc.hit_cycles=auto", "slc.size=64 MiB"}));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines.front().find("slc has 64 MiB, outside 1 KiB to 16 MiB"), std::string::npos) << lines.front();
}

TEST(HitCycles, OutsideTheCurveAreSaid) {
  const std::vector<std::string> lines = latency_warnings(with(auto_and({"l2.size=512 B", "l2.ways=2", "l2.banks=1"})));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines.front().find("l2 has 512 B, outside 1 KiB to 16 MiB"), std::string::npos) << lines.front();
  EXPECT_TRUE(latency_warnings(with({"l2.size=512 B", "l2.ways=2", "l2.banks=1"})).empty());
}

TEST(HitCycles, ThatAreAutoStaySoInTheConfigurationAndItsJson) {
  RunConfig config = with(kAuto);
  const sim::ConfigNode tree = sim::config_tree(config);
  const sim::ConfigNode& field = *tree.find_child("l2")->find_child("hit_cycles");
  EXPECT_EQ(sim::value_text(field), "auto");
  EXPECT_EQ(sim::allowed_text(field), "1 to 64 cycles, or auto");
}

}  // namespace
}  // namespace tools
