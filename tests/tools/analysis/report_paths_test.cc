#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "tests/temp_folder.h"
#include "tools/analysis/report_file.h"

// Tests that every number of a report has a path, and that any unambiguous end of the path selects it.

namespace tools {
namespace {

using sim::Json;

const Json& report() {
  static const Json json = sim::parse_json(R"({
    "schema": "raywatt-report/1",
    "resolution": [64, 32],
    "config": {"cores": 2, "clocks": {"tni": "500 MHz"}},
    "provenance": {"made_of": 1},
    "totals": {
      "cycles": 100,
      "rays": {"primary": 7, "total": 9},
      "power_w": {"nominal": 0.5},
      "energy_mj": {"nominal": 0.25},
      "psnr_db": null, "identical": true,
      "kernels": {"shade": {"cycles": 60}},
      "relative": {"rays": 1.5}
    },
    "frames": [{"cycles": 100, "time_ms": 3}],
    "units": {
      "tile_dispatcher": {"elapsed": 5},
      "core0": {"tni": {"trv0": {"elapsed": 5, "counters": {"hits": 1}}, "trv1": {"elapsed": 5, "counters": {"hits": 2}}}},
      "core1": {"tni": {"trv0": {"elapsed": 5, "counters": {"hits": 4}}, "trv1": {"elapsed": 5, "counters": {"hits": 8}}}},
      "l2": {"bank0": {"elapsed": 5, "counters": {"hits": 16}}, "bank1": {"elapsed": 5, "counters": {"hits": 32}}}
    },
    "host": {"wall_s": 1}
  })");
  return json;
}

std::vector<std::string> paths() {
  std::vector<std::string> out;
  for (const ReportNumber& number : report_numbers(report())) out.push_back(number.path);
  return out;
}

double value(const std::string& path) {
  for (const ReportNumber& number : report_numbers(report())) {
    if (number.path == path) return number.value;
  }
  return -1;
}

bool has(const std::string& path) { return value(path) != -1; }

std::string complaint(const std::string& text) {
  try {
    return "no complaint, but " + resolve_report_path(text, paths());
  } catch (const sim::InputError& error) {
    return error.what();
  }
}

TEST(ReportNumbers, AreFoundAtTheirDottedPaths) {
  EXPECT_EQ(value("totals.rays.primary"), 7);
  EXPECT_EQ(value("frames[0].time_ms"), 3);
  EXPECT_EQ(value("resolution[1]"), 32);
  EXPECT_EQ(value("config.cores"), 2);
}

TEST(ReportNumbers, HostAndProvenanceDifferBetweenEqualRunsAndAreLeftOut) {
  EXPECT_FALSE(has("host.wall_s"));
  EXPECT_FALSE(has("provenance.made_of"));
}

TEST(ReportNumbers, WhatIsNoNumberIsLeftOut) {
  EXPECT_FALSE(has("totals.identical"));
  EXPECT_FALSE(has("totals.psnr_db"));
  EXPECT_FALSE(has("config.clocks.tni"));
}

TEST(ReportNumbers, RankAnIdenticalPictureByAHundredDecibels) {
  tools::ReportFile report;
  report.json["totals"] = {{"psnr_db", nullptr}, {"temporal_psnr_db", 31.5}, {"cycles", nullptr}};
  tools::rank_identical_pictures(report);
  EXPECT_EQ(report.numbers, (std::map<std::string, double>{{"totals.psnr_db", 100}, {"totals.worst_psnr_db", 100}}))
      << "of other values, null is none; the only frame is the worst";
}

TEST(ReportNumbers, UnitsWithoutTheirNumbersAreSums) {
  EXPECT_EQ(value("units.core1.tni.trv0.counters.hits"), 4);
  EXPECT_EQ(value("units.core.tni.trv.counters.hits"), 1 + 2 + 4 + 8);
  EXPECT_EQ(value("units.l2.bank.counters.hits"), 16 + 32) << "the 2 of l2 counts nothing";
  EXPECT_EQ(std::ranges::count(paths(), "units.tile_dispatcher.elapsed"), 1) << "the only one of its kind";
  EXPECT_EQ(value("units.tile_dispatcher.units"), 1);
  EXPECT_EQ(value("units.core.tni.trv.units"), 4);
}

TEST(ReportNumbers, NothingIsReadOfWhatIsNoReport) {
  EXPECT_TRUE(report_numbers(Json(7)).empty());
  EXPECT_TRUE(report_numbers(Json::array({1})).empty());
  Json deep = 1;
  for (int i = 0; i < 100; ++i) deep = Json{{"a", deep}};
  EXPECT_THROW(report_numbers(deep), sim::InputError);
}

TEST(ReportPath, AnyEndThatIsClearNamesIt) {
  EXPECT_EQ(resolve_report_path("totals.rays.primary", paths()), "totals.rays.primary");
  EXPECT_EQ(resolve_report_path("rays.primary", paths()), "totals.rays.primary");
  EXPECT_EQ(resolve_report_path("primary", paths()), "totals.rays.primary");
  EXPECT_EQ(resolve_report_path("trv.counters.hits", paths()), "units.core.tni.trv.counters.hits");
  EXPECT_EQ(resolve_report_path("frames[0].time_ms", paths()), "frames[0].time_ms");
}

TEST(ReportPath, TotalsWinOverAllElseAndTheirOwnNamesOverThoseBelow) {
  EXPECT_EQ(resolve_report_path("cycles", paths()), "totals.cycles");
  EXPECT_EQ(resolve_report_path("shade.cycles", paths()), "totals.kernels.shade.cycles");
  EXPECT_EQ(resolve_report_path("time_ms", paths()), "frames[0].time_ms") << "nothing else has it";
  EXPECT_EQ(resolve_report_path("cores", paths()), "config.cores");
}

TEST(ReportPath, MetricsOfTheRunWinOverThoseAtTheTargetRate) {
  const std::vector<std::string> rated = {"frames[0].perf.fps", "totals.at_fps.fps",       "totals.at_fps.idle_ms",
                                          "totals.perf.fps",    "totals.perf.mrays_per_s", "units.core.idle_ms"};
  EXPECT_EQ(resolve_report_path("fps", rated), "totals.perf.fps");
  EXPECT_EQ(resolve_report_path("at_fps.fps", rated), "totals.at_fps.fps");
  EXPECT_EQ(resolve_report_path("idle_ms", rated), "totals.at_fps.idle_ms") << "totals win over all else";
}

TEST(ReportPath, OneThatMayMeanSeveralIsRefusedWithAllOfThem) {
  const std::string why = complaint("nominal");
  EXPECT_SAYS(why, "'nominal' may mean any of");
  EXPECT_SAYS(why, "totals.power_w.nominal, totals.energy_mj.nominal");
  EXPECT_SAYS(complaint("counters.hits"), "units.l2.bank.counters.hits");
}

TEST(ReportPath, LongListsOfCandidatesAreCutShort) {
  std::vector<std::string> many;
  for (int i = 0; i < 20; ++i) many.push_back("units.core" + std::to_string(i) + ".srp.elapsed");
  EXPECT_THROW(resolve_report_path("elapsed", many), sim::InputError);
  try {
    resolve_report_path("elapsed", many);
  } catch (const sim::InputError& error) {
    EXPECT_SAYS(std::string(error.what()), "and 12 more");
  }
}

TEST(ReportPath, AGroupIsRefusedWithWhatIsInIt) {
  EXPECT_SAYS(complaint("rays"), "'rays' is a group of: totals.rays.primary, totals.rays.total");
  EXPECT_SAYS(complaint("totals.power_w"), "totals.power_w.nominal");
  EXPECT_SAYS(complaint("bank1.counters"), "units.l2.bank1.counters.hits");
  EXPECT_SAYS(complaint("frames[0]"), "frames[0].cycles");
  const std::vector<std::string> keys = {"config.power.voltage", "config.power.temperature", "totals.power_w.high",
                                         "totals.power_w.low", "totals.power_w.nominal"};
  try {
    resolve_report_path("power", keys);
    ADD_FAILURE() << "two keys of the configuration";
  } catch (const sim::InputError& error) {
    EXPECT_SAYS(std::string(error.what()), "config.power.temperature, did you mean 'power_w'?") << "figures are meant";
  }
}

TEST(ReportPath, ALargeGroupSuggestsOnlyTheNearestMetric) {
  std::vector<std::string> keys = {"totals.energy_mj.high", "totals.energy_mj.low", "totals.energy_mj.nominal"};
  for (int i = 0; i < 20; ++i) keys.push_back("config.dram.energy.key" + std::to_string(i));
  try {
    resolve_report_path("energy", keys);
    ADD_FAILURE() << "20 keys of the configuration";
  } catch (const sim::InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              "the report path 'energy' is a group of 20 numbers, none of them a figure, did you mean 'energy_mj'?");
  }
}

TEST(ReportPath, AMetricWithABandDenotesItsNominalValue) {
  const std::vector<std::string> band = {"totals.energy_mj.high", "totals.energy_mj.low", "totals.energy_mj.nominal",
                                         "totals.replicates.figures.energy_mj.nominal.mean"};
  EXPECT_EQ(resolve_report_path("energy_mj", band), "totals.energy_mj.nominal");
  EXPECT_EQ(resolve_report_path("totals.energy_mj", band), "totals.energy_mj.nominal");
  EXPECT_EQ(resolve_report_path("energy_mj.low", band), "totals.energy_mj.low");
  EXPECT_EQ(report_path_group("energy_mj", band).size(), 3U) << "of a group all is meant";
}

TEST(ReportPath, OneThatIsNotThereGetsTheNearest) {
  EXPECT_SAYS(complaint("cycels"), "there is no report path 'cycels', did you mean 'cycles'?");
  EXPECT_SAYS(complaint("rays.totl"), "did you mean 'rays.total'?");
  EXPECT_SAYS(complaint("enrgy_mj"), "did you mean 'energy_mj'?") << "a band goes by its name";
  EXPECT_SAYS(complaint("ycles"), "no report path") << "ends count at dots only";
  EXPECT_SAYS(complaint(""), "no report path");
  EXPECT_SAYS(complaint("cycles."), "no report path");
}

TEST(ReportPathGroup, IsAllPathsBelowOrTheMatchingPath) {
  using Paths = std::vector<std::string>;
  EXPECT_EQ(report_path_group("rays", paths()), (Paths{"totals.rays.primary", "totals.rays.total"}));
  EXPECT_EQ(report_path_group("primary", paths()), Paths{"totals.rays.primary"});
  EXPECT_EQ(report_path_group("frames", paths()), (Paths{"frames[0].cycles", "frames[0].time_ms"}));
  EXPECT_EQ(report_path_group("core1", paths()).size(), 4U);
  EXPECT_EQ(report_path_group("nowhere", paths()), Paths{});
  EXPECT_THROW(report_path_group("nominal", paths()), sim::InputError);
}

TEST(ReportPathGroup, UnitsDenotesTheSumsOnly) {
  const std::vector<std::string> units = report_path_group("units", paths());
  EXPECT_EQ(std::ranges::count(units, "units.core.tni.trv.counters.hits"), 1);
  EXPECT_EQ(std::ranges::count(units, "units.tile_dispatcher.elapsed"), 1);
  for (const std::string& path : units) EXPECT_EQ(path.find("core0"), std::string::npos) << path;
}

}  // namespace
}  // namespace tools
