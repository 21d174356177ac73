#include "sim/report/energy.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "../folder.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/report/report_json.h"

namespace sim::test {
namespace {

constexpr Time kMillisecond = kFemtosecondsPerSecond / 1000;

UnitReport counting_unit(std::string path, std::string block, std::vector<CounterReport> counters) {
  UnitReport u;
  u.path = std::move(path);
  u.block = std::move(block);
  u.counters = std::move(counters);
  return u;
}

EnergyConfig energy_config() {
  EnergyConfig c;
  c.events = {{"box", {1, 2, 4}}, {"read@16KiB", {1, 4, 16}}, {"read@64KiB", {4, 8, 32}}};
  c.clock_share = {0, 0.2, 0.5};
  c.sram_leakage = {0.01, 0.02, 0.04};
  c.logic_leakage = {5, 10, 20};
  c.logic = {{"tni", {1, 1, 1}}, {"tni.trv", {0.5, 0.5, 0.5}}, {"dram", {0, 0, 0}}};
  c.flop_clock = {0.001, 0.001, 0.001};
  c.idle_clocked = {0.1, 0.2, 0.5};
  c.flops = {{"tni", {1000, 1000, 1000}}, {"dram", {0, 0, 0}}};
  return c;
}

void expect_near(const Band& a, const Band& b) {
  EXPECT_NEAR(a.low, b.low, 1e-12 * std::abs(b.low));
  EXPECT_NEAR(a.nominal, b.nominal, 1e-12 * std::abs(b.nominal));
  EXPECT_NEAR(a.high, b.high, 1e-12 * std::abs(b.high));
}

std::string error_of(const EnergyConfig& c, const UnitReport& u) {
  const Folder folder;
  return complaint<InputError>(folder, [&] { compute_energy(std::vector{u}, c, {}, 1); });
}

TEST(Energy, OfEventsIsCountTimesEntryPlusTheClockTreesShare) {
  const EnergyReport e = compute_energy(std::vector{counting_unit("core0.tni", "tni", {{"boxes", "", 10, "box"}})},
                                        energy_config(), {}, 0);
  expect_near(e.kinds.dynamic, {10, 20, 40});
  expect_near(e.kinds.clock, {0, 5, 40});
  expect_near(e.total_pj, {10, 25, 80});
}

TEST(Energy, CountersWithoutAnEventCostNothing) {
  const EnergyReport e =
      compute_energy(std::vector{counting_unit("core0.tni", "tni", {{"rays", "", 10, ""}})}, energy_config(), {}, 0);
  expect_near(e.total_pj, {0, 0, 0});
}

TEST(Energy, LeakageIsStorageAndLogicTimesTime) {
  UnitReport u = counting_unit("core0.tni", "tni", {});
  u.sram_bytes = 100 * 1024;
  const EnergyReport e = compute_energy(std::vector{u}, energy_config(), {}, kMillisecond);
  expect_near(e.kinds.leakage, {6e6, 12e6, 24e6});  // 1 mW for 1 ms is 1 uJ
}

TEST(Energy, LogicIsLookedUpByKindOfUnitThenByBlock) {
  const auto leakage = [](const char* path) {
    return compute_energy(std::vector{counting_unit(path, "tni", {})}, energy_config(), {}, kMillisecond)
        .kinds.leakage.low;
  };
  EXPECT_DOUBLE_EQ(leakage("core0.tni.trv12"), 2.5e6);
  EXPECT_DOUBLE_EQ(leakage("core0.tni.ist"), 5e6);
}

TEST(Energy, TheClockOfIdleAndStarvedCyclesRunsOn) {
  constexpr std::array reasons = {idle_reason("idle", ""), working_reason("testing", ""), idle_reason("starved", ""),
                                  waiting_reason("output_full", "")};
  UnitReport u = counting_unit("core0.tni", "tni", {});
  u.reasons = reasons;
  u.cycles_by_reason = {{"idle", 100}, {"testing", 1000}, {"starved", 50}, {"output_full", 7}};
  expect_near(compute_energy(std::vector{u}, energy_config(), {}, 0).kinds.clock, {15, 30, 75});
}

TEST(Energy, SizeDependentEventsAreInterpolatedByAPowerLaw) {
  const EnergyConfig config = energy_config();
  const EnergyTable table(config.events);
  expect_near(table.energy_of("read", 16 * 1024), {1, 4, 16});
  expect_near(table.energy_of("read", 64 * 1024), {4, 8, 32});
  expect_near(table.energy_of("read", 32 * 1024), {2, 4 * std::sqrt(2.0), 16 * std::sqrt(2.0)});
  expect_near(table.energy_of("read", 256 * 1024), {16, 16, 64});
  expect_near(table.energy_of("read", 4 * 1024), {0.25, 2, 8});
  expect_near(table.energy_of("box", 4 * 1024), {1, 2, 4});
}

TEST(Energy, TheUnitsArraySizeSelectsTheEntry) {
  UnitReport u = counting_unit("core0.tni", "tni", {{"reads", "", 2, "read"}});
  u.sram_bytes = 1 << 20;
  u.cache_bytes = 64 * 1024;
  expect_near(compute_energy(std::vector{u}, energy_config(), {}, 0).kinds.dynamic, {8, 16, 64});
  u.cache_bytes = 0;
  EXPECT_EQ(error_of(energy_config(), u),
            "energy.events: 'read' depends on the size of an array, and unit 'core0.tni' has none");
}

TEST(Energy, OfADeviceIsTakenAsItIs) {
  const std::map<std::string, DeviceEvent> device = {{"dram.read", {{100, 200, 300}, false}},
                                                     {"dram.standby", {{1, 2, 3}, true}}};
  const UnitReport u =
      counting_unit("dram0", "dram", {{"reads", "", 3, "dram.read"}, {"cycles", "", 10, "dram.standby"}});
  const EnergyReport e = compute_energy(std::vector{u}, energy_config(), device, kMillisecond);
  expect_near(e.kinds.dynamic, {300, 600, 900});
  expect_near(e.kinds.clock, {0, 0, 0});
  expect_near(e.kinds.leakage, {10, 20, 30});
}

TEST(Energy, OfABlockIsReportedByEventWithoutTheClock) {
  const std::map<std::string, DeviceEvent> device = {{"dram.read", {{100, 200, 300}, false}},
                                                     {"dram.standby", {{1, 2, 3}, true}}};
  const std::vector<UnitReport> units = {
      counting_unit("core0.tni", "tni", {{"boxes", "", 10, "box"}, {"rays", "", 9, ""}}),
      counting_unit("core1.tni", "tni", {{"boxes", "", 5, "box"}}),
      counting_unit("dram0", "dram", {{"reads", "", 3, "dram.read"}, {"cycles", "", 10, "dram.standby"}})};
  EnergyReport e = compute_energy(units, energy_config(), device, 0);
  EXPECT_EQ(e.events["tni"].size(), 1U) << "a counter without an event costs nothing";
  expect_near(e.events["tni"]["box"], {15, 30, 60});
  expect_near(e.events["dram"]["dram.standby"], {10, 20, 30});
  expect_near(e.events["tni"]["box"] + e.events["dram"]["dram.read"], e.kinds.dynamic);
  e += e;
  expect_near(e.events["tni"]["box"], {30, 60, 120});
  EXPECT_DOUBLE_EQ(energy_json(e)["energy_by_event_mj"]["tni"]["box"].get<double>(), 60e-9);
}

TEST(Energy, BothViewsSumToTheTotal) {
  EnergyConfig c = energy_config();
  for (const char* block : {"l2", "srp", "dma"}) c.logic[block] = {0.1, 0.3, 0.7}, c.flops[block] = {7, 7, 7};
  std::vector<UnitReport> units;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const char* const blocks[] = {"tni", "l2", "srp", "dma"};
    UnitReport u =
        counting_unit("unit" + std::to_string(i), blocks[i % 4], {{"a", "", i * i * 977, "box"}, {"b", "", i, "read"}});
    u.sram_bytes = u.cache_bytes = 1024 + 77 * i;
    u.cycles_by_reason = {{"idle", i * 13}};
    units.push_back(u);
  }
  const EnergyReport e = compute_energy(units, c, {}, 7 * kMillisecond);
  Band by_block;
  for (const auto& [name, kinds] : e.blocks) by_block += kinds.total();
  EXPECT_EQ(e.blocks.size(), 4U);
  expect_near(by_block, e.total_pj);
  expect_near(e.kinds.dynamic + e.kinds.clock + e.kinds.leakage, e.total_pj);
}

TEST(Energy, NamesTheEventWithoutAnEntry) {
  EXPECT_EQ(error_of(energy_config(), counting_unit("core0.tni", "tni", {{"n", "", 1, "bxo"}})),
            "energy.events: no figure for 'bxo', which counter 'n' of unit 'core0.tni' names");
  EXPECT_EQ(error_of(energy_config(), counting_unit("core0.srp", "srp", {})),
            "energy.flops: no entry for unit 'core0.srp'; allowed: 'srp.srp' or 'srp'");
  EnergyConfig c = energy_config();
  c.events["read"] = {1, 1, 1};
  EXPECT_EQ(error_of(c, counting_unit("core0.tni", "tni", {})),
            "energy.events.read@16KiB: given with and without a size; allowed: either");
  c = energy_config();
  c.events["box@big"] = {1, 1, 1};
  EXPECT_EQ(error_of(c, counting_unit("core0.tni", "tni", {})),
            "energy.events.box@big: 'big' is not a number with a unit; allowed: a size such as @16KiB");
}

TEST(Energy, AFreePointOfACurveIsRefused) {
  EnergyConfig c = energy_config();
  c.events["read@16KiB"] = {0, 1, 2};
  EXPECT_THROW(check_config(c), InputError);
}

TEST(Energy, JsonIsInMillijoules) {
  const EnergyReport e = compute_energy(std::vector{counting_unit("core0.tni", "tni", {{"boxes", "", 10, "box"}})},
                                        energy_config(), {}, 0);
  const auto json = energy_json(e);
  EXPECT_DOUBLE_EQ(json.at("energy_mj").at("nominal").get<double>(), 25e-9);
  EXPECT_DOUBLE_EQ(json.at("energy_by_block_mj").at("tni").at("high").get<double>(), 80e-9);
  EXPECT_DOUBLE_EQ(json.at("energy_by_kind_mj").at("clock").at("nominal").get<double>(), 5e-9);
}

TEST(Energy14nm, IsAValidTableWithEveryBlock) {
  const EnergyConfig c = load_config<EnergyConfig>("configs/energy/14nm.yaml");
  const EnergyTable table(c.events);
  EXPECT_NEAR(table.energy_of("cache.l2_read", 256 * 1024).nominal, 45, 1e-9);
  EXPECT_DOUBLE_EQ(table.energy_of("tni.box_test", 0).nominal, 24);
  for (const char* block : {"tni", "srp", "l2", "tile_buffer", "dma", "interconnect", "dram"}) {
    EXPECT_TRUE(c.logic.contains(block)) << block;
    EXPECT_TRUE(c.flops.contains(block)) << block;
  }
}

TEST(Energy14nm, NamesASourceForEveryFigure) {
  std::ifstream file("configs/energy/14nm.yaml");
  int figures = 0;
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.find_first_not_of(' ') == line.find('#') || colon == std::string::npos) continue;
    const char value = line[line.find_first_not_of(' ', colon + 1)];
    if (value != '{' && (value < '0' || value > '9')) continue;
    ++figures;
    EXPECT_NE(line.find("# source: "), std::string::npos) << line;
  }
  EXPECT_GT(figures, 50);
}

}  // namespace
}  // namespace sim::test
