#include "sim/report/energy.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "../folder.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"

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

constexpr std::uint64_t kMhz = 1'000'000;

PowerConfig power_config() {
  PowerConfig c;
  c.dvfs = {{"core@100MHz", {0.6, 0.6, 0.6}}, {"core@200MHz", {0.7, 0.7, 0.7}}, {"core@400MHz", {1.1, 1.1, 1.1}}};
  return c;
}

std::string error_of(const PowerConfig& c) {
  const Folder folder;
  return complaint<InputError>(folder, [&] { voltage_curves(c); });
}

TEST(VoltageCurve, IsLinearBetweenPointsConstantBelowAndExtrapolatedAbove) {
  const VoltageCurve curve = voltage_curves(power_config()).at("core");
  EXPECT_EQ(curve.voltage_at(100 * kMhz), 0.6);
  EXPECT_EQ(curve.voltage_at(200 * kMhz), 0.7);
  EXPECT_EQ(curve.voltage_at(400 * kMhz), 1.1);
  EXPECT_NEAR(curve.voltage_at(150 * kMhz), 0.65, 1e-12);
  EXPECT_NEAR(curve.voltage_at(300 * kMhz), 0.9, 1e-12);
  EXPECT_EQ(curve.voltage_at(50 * kMhz), 0.6);
  EXPECT_NEAR(curve.voltage_at(500 * kMhz), 1.3, 1e-12);
}

TEST(VoltageCurve, RefusesInvalidEntries) {
  PowerConfig c = power_config();
  c.dvfs["core@300MHz"] = {0.5, 0.5, 0.5};
  EXPECT_NE(error_of(c).find("0.7 V at 200 MHz and 0.5 V at 300 MHz"), std::string::npos) << error_of(c);
  c = power_config();
  c.dvfs["core"] = {0.5, 0.5, 0.5};
  EXPECT_NE(error_of(c).find("power.dvfs.core: "), std::string::npos) << error_of(c);
}

TEST(PowerScale, IsExactlyOneAtTheTablesVoltageAndTemperature) {
  const PowerScale scale = power_scale(power_config(), 0.8);
  EXPECT_EQ(scale.dynamic, 1);
  EXPECT_EQ(scale.leakage, 1);
}

TEST(PowerScale, FollowsTheVoltageTheExponentAndTheTemperature) {
  PowerConfig c = power_config();
  EXPECT_NEAR(power_scale(c, 0.4).dynamic, 0.25, 1e-12);
  EXPECT_NEAR(power_scale(c, 0.4).leakage, 0.125, 1e-12);
  c.temperature = 125;
  EXPECT_NEAR(power_scale(c, 0.8).leakage, 4, 1e-12);
  EXPECT_EQ(power_scale(c, 0.8).dynamic, 1);
  c.temperature = 50;
  c.leakage_exponent = 2;
  EXPECT_NEAR(power_scale(c, 1.6).leakage, 2, 1e-12);
}

/// Returns the energy of a unit with 100 KiB and 2 mm2 that counted `boxes` events of 3 pJ.
double pj(double boxes, Time time, const PowerScale& scale) {
  EnergyConfig e;
  e.events = {{"box", {3, 3, 3}}};
  e.clock_share = {0.25, 0.25, 0.25};
  e.sram_leakage = {0.02, 0.02, 0.02};
  e.logic_leakage = {10, 10, 10};
  e.logic = {{"tni", {2, 2, 2}}};
  e.flops = {{"tni", {0, 0, 0}}};
  UnitReport unit;
  unit.path = "core0.tni.trv0";
  unit.block = "tni";
  unit.sram_bytes = 100 * 1024;
  unit.counters = {{"boxes", "", static_cast<std::uint64_t>(boxes), "box", CounterKind::kSum}};
  return compute_energy(std::vector{unit}, e, {}, time, {{"tni", scale}}).total_pj.nominal;
}

// 22 mW at 0.8 V and 75 C: 22e-6 pJ per femtosecond.
TEST(LeakageAlone, IsPowerTimesTimeAtAnyVoltageAndTemperature) {
  PowerConfig c = power_config();
  constexpr Time kTime = kFemtosecondsPerSecond / 1000;
  for (const double volt : {0.4, 0.6, 0.8, 1.0}) {
    for (const double degrees : {25.0, 75.0, 100.0}) {
      c.temperature = degrees;
      const double expected =
          22e-6 * static_cast<double>(kTime) * std::pow(volt / 0.8, 3) * std::pow(2, (degrees - 75) / 25);
      EXPECT_NEAR(pj(0, kTime, power_scale(c, volt)), expected, 1e-9 * expected);
    }
  }
}

// For a fixed number of cycles at one voltage, leakage energy is proportional to time, so the fastest clock is best.
TEST(LeakageAlone, AtOneVoltageGoesWithOneOverTheClock) {
  const double slow = pj(0, 4 * kFemtosecondsPerSecond / 1000, {}), fast = pj(0, kFemtosecondsPerSecond / 1000, {});
  EXPECT_NEAR(slow / fast, 4, 1e-12);
}

TEST(DynamicAlone, GoesWithTheSquareOfTheVoltageAndNotWithTheTime) {
  const double full = pj(1000, 0, power_scale(power_config(), 0.8));
  EXPECT_NEAR(full, 3 * 1000 / 0.75, 1e-9);
  EXPECT_NEAR(pj(1000, 0, power_scale(power_config(), 0.6)), full * 0.5625, 1e-9);
}

TEST(EnergyOfADevice, DoesNotFollowTheChipsVoltage) {
  EnergyConfig e;
  e.logic = e.flops = {{"dram", {0, 0, 0}}};
  UnitReport unit;
  unit.path = "dram.channel0";
  unit.block = "dram";
  unit.counters = {{"reads", "", 10, "dram.read", CounterKind::kSum}};
  const EnergyReport report = compute_energy(std::vector{unit}, e, {{"dram.read", {{5, 5, 5}, false}}}, 1,
                                             {{"dram", power_scale(power_config(), 0.4)}});
  EXPECT_EQ(report.total_pj.nominal, 50);
  EXPECT_EQ(report.events.at("dram").at("dram.read").nominal, 50);
}

TEST(Power14nm, HasTheTablesVoltageAtTheDefaultClocks) {
  const auto curves = voltage_curves(load_config<PowerConfig>("configs/power/14nm.yaml"));
  EXPECT_EQ(curves.at("tni").voltage_at(500 * kMhz), 0.8);
  EXPECT_EQ(curves.at("srp").voltage_at(1000 * kMhz), 0.8);
  EXPECT_EQ(curves.at("l2").voltage_at(500 * kMhz), 0.8);
}

UnitReport sized_unit(std::string path, std::string block, std::uint64_t sram, std::uint64_t array) {
  UnitReport u;
  u.path = std::move(path);
  u.block = std::move(block);
  u.sram_bytes = sram;
  u.cache_bytes = array;
  return u;
}

EnergyConfig energy() {
  EnergyConfig c;
  c.logic = {{"tni", {1, 2, 3}}, {"tni.trv", {0.5, 1, 2}}, {"dram", {0, 0.5, 1}}};
  c.parts = {{"tni.trv.tester", {0.125, 0.25, 0.5}}, {"tni.adder", {0.25, 0.5, 1}}};
  c.parts_in_logic = {{"tni.trv.tester", {2, 2, 2}}, {"tni.adder", {1, 1, 1}}};
  return c;
}

AreaConfig area_config() {
  AreaConfig c;
  c.logic_scale = {0.5, 1, 2};
  c.arrays = {{"tni@16KiB", {1, 2, 4}}, {"tni@64KiB", {2, 8, 32}}};
  c.buffers = {{"tni", {0.1, 0.2, 0.4}}};
  c.pads = {{"dram", {1, 2, 3}}};
  c.placement = {1, 1.25, 1.5};
  return c;
}

UnitReport channel(std::uint32_t data_lines) {
  UnitReport u = sized_unit("dram.channel0", "dram", 0, 0);
  u.data_lines = data_lines;
  return u;
}

/// Returns the logic area of a unit with given numbers of testers and adders.
Band logic_with(std::uint32_t testers, std::uint32_t adders) {
  UnitReport u = sized_unit("core0.tni.trv0", "tni", 0, 0);
  u.parts = {{"tester", testers}, {"adder", adders}};
  return LogicArea(u, energy()).area_band();
}

TEST(Area, IsLogicArraysBuffersAndPadsOfEveryUnitAndThePlacement) {
  const std::vector<UnitReport> units = {sized_unit("core0.tni.trv0", "tni", 20 * 1024, 16 * 1024),
                                         sized_unit("core0.tni.trv1", "tni", 20 * 1024, 16 * 1024),
                                         sized_unit("core0.tni.dispatcher", "tni", 0, 0), channel(16)};
  const AreaReport area = compute_area(units, energy(), area_config());
  const AreaOfBlock& tni = area.blocks.at("tni");
  EXPECT_EQ(tni.logic, (Band{1, 4, 14}));
  EXPECT_EQ(tni.arrays, (Band{2, 4, 8}));
  EXPECT_DOUBLE_EQ(tni.buffers.nominal, 1.6);
  EXPECT_DOUBLE_EQ(area.blocks.at("dram").total().nominal, 2.5);
  EXPECT_DOUBLE_EQ(area.total.nominal, (4 + 4 + 1.6 + 2.5) * 1.25);
}

TEST(Area, OfAnArrayIsAPowerOfItsSizeBetweenPoints) {
  const AreaReport area =
      compute_area(std::vector{sized_unit("core0.tni.trv0", "tni", 32 * 1024, 32 * 1024)}, energy(), area_config());
  EXPECT_NEAR(area.blocks.at("tni").arrays.nominal, 4, 1e-12);
}

TEST(Area, OfABankIsItsShareOfTheArray) {
  const std::vector<UnitReport> banks(4, sized_unit("core0.tni.trv0", "tni", 16 * 1024, 64 * 1024));
  EXPECT_DOUBLE_EQ(compute_area(banks, energy(), area_config()).blocks.at("tni").arrays.nominal, 8);
}

TEST(Area, OfPadsIsProportionalToTheDataLines) {
  for (const std::uint32_t lines : {8U, 16U, 32U}) {
    EXPECT_EQ(compute_area(std::vector{channel(lines)}, energy(), area_config()).blocks.at("dram").pads,
              (Band{lines / 16., lines / 8., lines * 3 / 16.}))
        << lines;
  }
}

TEST(Area, OfLogicEqualsTheTableForTheTablesNumberOfParts) { EXPECT_EQ(logic_with(2, 1), (Band{0.5, 1, 2})); }

TEST(Area, OfLogicGrowsByEachPartMoreAndShrinksByEachPartLess) {
  EXPECT_EQ(logic_with(5, 1), (Band{0.5 + 3 * 0.125, 1 + 3 * 0.25, 2 + 3 * 0.5}));
  EXPECT_EQ(logic_with(1, 3), (Band{0.5 - 0.25 + 0.5, 1 - 0.25 + 1, 2 - 0.25 + 2}));
}

TEST(Area, OfLogicWithFewerPartsIsNoSmallerForHighThanForLow) {
  EnergyConfig c = energy();
  c.logic["tni.trv"] = {1, 1, 1};
  UnitReport u = sized_unit("core0.tni.trv0", "tni", 0, 0);
  u.parts = {{"tester", 0}, {"adder", 1}};
  EXPECT_EQ(LogicArea(u, c).area_band(), (Band{0.5, 0.5, 0.5}));
}

TEST(Area, OfLogicIsNeverNegative) {
  EnergyConfig c = energy();
  c.parts_in_logic["tni.adder"] = {100, 100, 100};
  UnitReport u = sized_unit("core0.tni.trv0", "tni", 0, 0);
  u.parts = {{"adder", 1}};
  EXPECT_EQ(LogicArea(u, c).area_band(), Band());
}

TEST(Area, OfLogicEqualsTheTableWithoutParts) {
  EnergyConfig c = energy();
  c.parts = c.parts_in_logic = {};
  UnitReport u = sized_unit("core0.tni.trv0", "tni", 0, 0);
  u.parts = {{"tester", 7}};
  EXPECT_EQ(LogicArea(u, c).area_band(), (Band{0.5, 1, 2}));
}

TEST(Area, OfAUnitThatTheTableLacksIsAnError) {
  const Folder folder;
  const auto error = [&](const UnitReport& u) {
    return complaint<InputError>(folder, [&] { compute_area(std::vector{u}, energy(), area_config()); });
  };
  EXPECT_EQ(error(sized_unit("core0.srp", "srp", 0, 0)),
            "energy.logic: no entry for unit 'core0.srp'; allowed: 'srp.srp' or 'srp'");
  EXPECT_EQ(error(sized_unit("dram.channel0", "dram", 1024, 1024)),
            "area.arrays: no entry for unit 'dram.channel0'; allowed: 'dram.channel' or 'dram'");
  EXPECT_EQ(error(sized_unit("dram.channel0", "dram", 1024, 0)),
            "area.buffers: no entry for unit 'dram.channel0'; allowed: 'dram.channel' or 'dram'");
  EXPECT_EQ(error(sized_unit("core0.tni.trv0", "tni", 1024, 1024)), "no error");
  EXPECT_EQ(error(channel(0)), "area.pads: unit 'dram.channel0' has no data lines at the die's edge");
  UnitReport other = sized_unit("core0.tni.trv0", "tni", 0, 0);
  other.parts = {{"divider", 1}};
  EXPECT_EQ(error(other),
            "energy.parts: no entry for part 'divider' of unit 'core0.tni.trv0'; allowed: 'tni.trv.divider' or "
            "'tni.divider'");
}

TEST(AreaTables, NameASourceForEveryEntryAndRiseWithSize) {
  for (const char* process : {"28nm", "14nm", "7nm", "5nm", "3nm"}) {
    const std::string name = std::string("configs/area/") + process + ".yaml";
    const AreaConfig c = load_config<AreaConfig>(name);
    for (const char* block : {"tni", "srp", "l2", "tile_buffer"}) {
      const auto of = [&](std::uint64_t kib) {
        const UnitReport u = sized_unit("x", block, kib * 1024, kib * 1024);
        EnergyConfig no_logic;
        no_logic.logic = {{block, {0, 0, 0}}};
        return compute_area(std::vector{u}, no_logic, c).blocks.at(block).arrays;
      };
      const Band at_16 = of(16);
      EXPECT_LT(at_16.low, at_16.nominal) << block;
      EXPECT_LT(at_16.nominal, at_16.high) << block;
      EXPECT_LT(at_16.high, of(256).high) << block;
    }
    std::ifstream file(name);
    int figures = 0;
    for (std::string line; std::getline(file, line);) {
      if (line.find(": {low") == std::string::npos) continue;
      ++figures;
      EXPECT_NE(line.find("# source: "), std::string::npos) << line;
    }
    EXPECT_GE(figures, 4) << name;
  }
}

UnitReport unit(const char* path, const char* block, std::vector<UnitPart> parts = {}) {
  UnitReport u;
  u.path = path;
  u.block = block;
  u.parts = std::move(parts);
  return u;
}

/// Returns the reports of two kinds of units. One has a part whose number is a configuration key.
std::vector<UnitReport> units() {
  return {unit("core0.tni.trv0", "tni", {{"tester", 2}}), unit("core0.tni.trv1", "tni", {{"tester", 2}}),
          unit("core0.srp", "srp")};
}

template <class Config>
std::string refusal(const Config& config) {
  const Folder folder;
  return complaint<InputError>(folder, [&] { check_unit_names(config, units()); });
}

TEST(TableNames, EventsAreThoseThatCountersName) {
  EnergyConfig c;
  c.events = {{"box", {1, 2, 3}}, {"read@16KiB", {1, 2, 3}}, {"read@32KiB", {2, 3, 4}}};
  const Folder folder;
  const auto check = [&](const std::vector<std::string>& declared) {
    return complaint<InputError>(folder, [&] { check_energy_events(c, declared); });
  };
  EXPECT_EQ(check({"box", "read"}), "no error");
  EXPECT_EQ(check({"read"}), "energy.events.box: no counter names this event; allowed: read");
  EXPECT_EQ(check({"boxes", "read"}), "energy.events.box: no counter names this event; allowed: boxes, read");
  EXPECT_EQ(check({"bax", "read"}),
            "energy.events.box: no counter names this event, did you mean 'bax'?; allowed: bax, read");
  EXPECT_EQ(check({"box", "read", "write"}), "energy.events: no figure for 'write'");
}

TEST(TableNames, LogicAndFlopsAreOfUnitsOrBlocks) {
  EnergyConfig c;
  c.logic = {{"tni", {}}, {"tni.trv", {}}, {"srp", {}}};
  c.flops = {{"tni.trv", {}}, {"srp.srp", {}}};
  EXPECT_EQ(refusal(c), "no error");
  EnergyConfig logic = c, flops = c;
  logic.logic["tni.trvv"] = {};
  EXPECT_EQ(refusal(logic),
            "energy.logic.tni.trvv: no unit goes by this name, did you mean 'tni.trv'?; allowed: srp, srp.srp, tni, "
            "tni.trv");
  EnergyConfig sized = c;
  sized.logic["srp@16KiB"] = {};
  EXPECT_EQ(refusal(sized).substr(0, 50), "energy.logic.srp@16KiB: no unit goes by this name;");
  flops.flops["dram_controller"] = {};
  EXPECT_EQ(refusal(flops),
            "energy.flops.dram_controller: no unit goes by this name; allowed: srp, srp.srp, tni, tni.trv");
}

TEST(TableNames, PartsAreThoseThatUnitsHave) {
  EnergyConfig c;
  c.parts = {{"tni.trv.tester", {}}, {"tni.tester", {}}};
  c.parts_in_logic = {{"tni.trv.tester", {}}};
  EXPECT_EQ(refusal(c), "no error");
  EnergyConfig parts = c, held = c;
  parts.parts["tni.trv.testers"] = {};
  EXPECT_EQ(refusal(parts),
            "energy.parts.tni.trv.testers: no unit has a part of this name, did you mean 'tni.trv.tester'?; allowed: "
            "tni.tester, tni.trv.tester");
  held.parts_in_logic["srp.tester"] = {};
  EXPECT_EQ(refusal(held),
            "energy.parts_in_logic.srp.tester: no unit has a part of this name, did you mean 'tni.tester'?; allowed: "
            "tni.tester, tni.trv.tester");
}

TEST(TableNames, AreaIsOfUnitsOrBlocksAtAnySize) {
  AreaConfig c;
  c.arrays = {{"tni@16KiB", {}}, {"srp.srp@4KiB", {}}};
  c.buffers = {{"tni", {}}};
  c.pads = {{"srp", {}}};
  EXPECT_EQ(refusal(c), "no error");
  AreaConfig arrays = c, buffers = c, pads = c;
  arrays.arrays["tin@16KiB"] = {};
  EXPECT_EQ(refusal(arrays),
            "area.arrays.tin: no unit goes by this name, did you mean 'tni'?; allowed: srp, srp.srp, tni, tni.trv");
  buffers.buffers["sr"] = {};
  EXPECT_EQ(refusal(buffers),
            "area.buffers.sr: no unit goes by this name, did you mean 'srp'?; allowed: srp, srp.srp, tni, tni.trv");
  pads.pads["ddr"] = {};
  EXPECT_EQ(refusal(pads), "area.pads.ddr: no unit goes by this name; allowed: srp, srp.srp, tni, tni.trv");
}

// Tests of sizes outside the curves of tables, and of number formats.

UnitReport cache(std::string path, std::uint64_t bytes) {
  UnitReport unit;
  unit.path = std::move(path);
  unit.block = "l2";
  unit.cache_bytes = bytes;
  unit.counters.resize(1);
  unit.counters.front().event = "read";
  return unit;
}

std::vector<std::string> lines_of(std::uint64_t bytes) {
  const std::vector<UnitReport> units = {cache("l2.bank0", bytes), cache("l2.bank1", bytes)};
  const Band any{1, 1, 1};
  return curve_range_warnings(units, {{"read@64KiB", any}, {"read@256KiB", any}},
                              {{"l2@32KiB", any}, {"l2@512KiB", any}});
}

TEST(SizesOutsideCurves, AreNamedOnceAKindWithTheRange) {
  EXPECT_EQ(lines_of(512 << 10), std::vector<std::string>{"energy.events: the array of l2.bank has 512 KiB, outside 64 "
                                                          "KiB to 256 KiB of read, and is extrapolated"});
  EXPECT_EQ(lines_of(16 << 10).size(), 2U) << "energy and area";
}

TEST(SizesOutsideCurves, AreNoneAtTheEndsAndBetweenPoints) {
  for (const std::uint64_t kib : {64U, 100U, 256U}) EXPECT_TRUE(lines_of(kib << 10).empty()) << kib;
}

TEST(SizesOutsideCurves, AreNoneOfEventsWithoutSizes) {
  const std::vector<UnitReport> units = {cache("l2.bank0", 1)};
  EXPECT_TRUE(curve_range_warnings(units, {{"read", {1, 1, 1}}}, {}).empty());
}

TEST(SiText, HasNoPrefixForARatio) {
  EXPECT_EQ(si_text(0.335), "0.335");
  EXPECT_EQ(si_text(-0.0042), "-0.00420");
  EXPECT_EQ(si_text(0.335, "J"), "335 mJ");
}

TEST(FourDigits, RoundToFourSignificantDigits) {
  EXPECT_EQ(four_digit_text(4733.4), "4733");
  EXPECT_EQ(four_digit_text(350), "350.0");
  EXPECT_EQ(four_digit_text(9999.7), "10.00 k");
  EXPECT_EQ(four_digit_text(12824), "12.82 k");
  EXPECT_EQ(four_digit_text(-1.23456e7), "-12.35 M");
  EXPECT_EQ(four_digit_text(0.12034), "0.1203");
  EXPECT_EQ(four_digit_text(8.4612e-5), "8.461e-05");
  EXPECT_EQ(four_digit_text(0), "0");
}

}  // namespace

}  // namespace sim::test
