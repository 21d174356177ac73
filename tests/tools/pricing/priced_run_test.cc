#include "tools/pricing/priced_run.h"

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/tools/pricing/two_designs.h"

// Tests that a finished run priced by another energy table equals a run with that table.

namespace test {
namespace {

using tools::energy_totals_json;
using tools::load_report;
using tools::PricedRun;
using tools::PriceTable;

/// Expects that a priced run has the energy totals of a report.
void expect_totals(const PricedRun& run, const std::filesystem::path& report) {
  const sim::Json totals = load_report(report).json["totals"], priced = energy_totals_json(run.energy(), run.work());
  for (const auto& [key, value] : priced.items()) {
    if (key == "perf") continue;
    EXPECT_EQ(value, totals[key]) << key;
  }
  for (const auto& [key, value] : priced["perf"].items()) EXPECT_EQ(value, totals["perf"][key]) << key;
}

TEST(PricedRun, UnderItsOwnTableIsItsReport) {
  const TempFolder folder;
  const auto out = simulate_into_folder(folder.path() / "a",
                                        {"--set", "tni.miss_handling=rau", "--set", "direct_interface.enabled=false"});
  expect_totals(PricedRun(load_report(out)), out);
}

TEST(PricedRun, UnderAnotherTableIsTheRunWithThatTable) {
  const TempFolder folder;
  const auto a = simulate_into_folder(folder.path() / "a");
  const Words sets = {"energy.events.tni.box_test=48", "energy.clock_share={low: 0.1, nominal: 0.2, high: 0.3}",
                      "dram.energy.phy.nominal=100", "energy.events.cache.l1_read@16KiB=20", "tni.trv.ray_bytes=64"};
  Words more;
  for (const std::string& set : sets) more.insert(more.end(), {"--set", set});
  const auto b = simulate_into_folder(folder.path() / "b", more);
  expect_totals(PricedRun(load_report(a), {.sets = sets}), b);
}

TEST(PricedRun, OfSeveralFramesIsTheirSum) {
  const TempFolder folder;
  const auto out = simulate_into_folder(folder.path() / "a", {"--scene", "car", "--frames", "0:2"});
  const PricedRun run(load_report(out));
  EXPECT_EQ(run.work().frames, 3);
  const sim::Json totals = load_report(out).json["totals"], priced = energy_totals_json(run.energy(), run.work());
  EXPECT_NEAR(priced["energy_mj"]["high"].get<double>() / totals["energy_mj"]["high"].get<double>(), 1, 1e-12);
  EXPECT_NEAR(
      priced["perf"]["frames_per_joule_gpu"].get<double>() / totals["perf"]["frames_per_joule_gpu"].get<double>(), 1,
      1e-12);
}

TEST(PricedRun, OfAWholeTableTakesNothingFromTheRuns) {
  const TempFolder folder;
  const auto out = simulate_into_folder(folder.path() / "a");
  const auto file = folder.write("mine.yaml", "extends: energy/14nm\nsram_leakage: 0\nlogic_leakage: 0\n");
  const PricedRun run(load_report(out), {.energy = file.string()});
  const double standby = run.energy().blocks.at("dram").leakage.nominal;
  EXPECT_GT(standby, 0);
  EXPECT_EQ(run.energy().kinds.leakage.nominal, standby);
  const auto part = folder.write("part.yaml", "events: {tni.box_test: 3}\n");
  try {
    const PricedRun refused(load_report(out), {.energy = part.string()});
    FAIL();
  } catch (const sim::InputError& error) {
    EXPECT_SAYS(std::string(error.what()), "energy.events: no figure for");
  }
}

/// Returns the error of pricing a changed report, or by a certain table.
std::string complaint(const tools::ReportFile& report, const PriceTable& table = {}) {
  try {
    const PricedRun run(report, table);
  } catch (const sim::InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(PricedRun, RefusesWhatNeedsAnotherRunAndCountsThatAreNotItsOwn) {
  const TempFolder folder;
  const tools::ReportFile report = load_report(simulate_into_folder(folder.path() / "a"));
  EXPECT_SAYS(complaint(report, {.sets = {"cores=2"}}), "cores: changes what the machine does");
  EXPECT_SAYS(complaint(report, {.sets = {"area.placement.nominal=2"}}), "changes the machine's area, not its energy");
  EXPECT_SAYS(complaint(report, {.sets = {"energy.events.tni.bxo=2"}}), "no counter names this event");
  EXPECT_EQ(complaint(report, {.sets = {"energy.events.tni.box_test=2"}}), "no error");
  tools::ReportFile changed = report;
  changed.json["units"]["core0"]["tni"]["trv0"]["counters"].erase("visits");
  EXPECT_SAYS(complaint(changed), "units.core0.tni.trv0.counters.visits is no count");
  changed = report;
  auto& boxes = changed.json["units"]["core0"]["tni"]["trv0"]["counters"]["visits"];
  boxes = boxes.get<std::uint64_t>() + 1;
  EXPECT_SAYS(complaint(changed), "by its own table its counts come to");
  changed = report;
  changed.json["units"]["core0"]["tni"].erase("trv1");
  EXPECT_SAYS(complaint(changed), "units, the machine of its configuration");
}

}  // namespace
}  // namespace test
