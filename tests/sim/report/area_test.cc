#include "sim/report/area.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "../folder.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/report/energy.h"

namespace sim::test {
namespace {

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

}  // namespace
}  // namespace sim::test
