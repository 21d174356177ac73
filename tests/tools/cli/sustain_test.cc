#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/pricing/two_designs.h"
#include "tests/tools/studies/sweep/small_sweep.h"

// Tests of `raywatt sustain`, and of runs that repeat their frame over minutes.

namespace test {
namespace {

using Json = nlohmann::json;

/// Settings of a device that is too small for the machine's heat.
const Words kHot = {"--set", "thermal.body_resistance=30", "--set", "thermal.body_capacity=3",
                    "--set", "thermal.other_power=0",      "--set", "thermal.die_resistance=20",
                    "--set", "thermal.lookahead=10"};

Json sustained(Words words) {
  words.insert(words.begin(), {"sustain", "--resolution", "64x32", "--json"});
  const ProcessResult ending = raywatt(words);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return Json::parse(ending.out);
}

TEST(SustainVerb, OfACoolMachineHasTheFrameRateOfItsRun) {
  const Json s = sustained({"--minutes", "1", "--loop", "20"});
  EXPECT_EQ(s["schema"], "raywatt-sustain/1");
  EXPECT_EQ(s["stability"], 1);
  EXPECT_EQ(s["loops"].size(), 3U);
  EXPECT_EQ(s["steps"].size(), 7U);
  EXPECT_EQ(s["clock_changes"], 0);
  const Json first = s["steps"][0]["frames"][0];
  EXPECT_NEAR(s["sustained_fps"].get<double>(), 1000 / first["time_ms"].get<double>(), 1e-3);
  EXPECT_GT(s["steps"][6]["frames"][0]["time_ms"], first["time_ms"]);
  EXPECT_TRUE(s["warnings"].empty()) << s["warnings"];
}

TEST(SustainVerb, HasTheVoltageOfEachClockAndNoWarningOfIt) {
  const Json s = sustained({"--minutes", "0.1", "--set", "clocks.tni=400 MHz"});
  EXPECT_TRUE(s["warnings"].empty()) << s["warnings"];
  EXPECT_LT(s["steps"][0]["volt"]["tni"], s["steps"][0]["volt"]["srp"]);
}

TEST(SustainVerb, OfAHotMachineSlowsDownToItsLimit) {
  Words words = kHot;
  words.insert(words.end(), {"--minutes", "12"});
  const Json s = sustained(words);
  EXPECT_LT(s["sustained_fps"], s["first_fps"]);
  EXPECT_LT(s["stability"], 1);
  EXPECT_GT(s["clock_changes"], 0);
  EXPECT_LT(s["hottest"]["body_c"], 44);
}

TEST(SustainVerb, SmallerProcessesSustainMore) {
  double before = 0;
  for (const char* process : {"28nm", "14nm", "5nm"}) {
    Words words = kHot;
    words.insert(words.end(), {"--set", std::string("process=") + process, "--minutes", "12"});
    const double fps = sustained(words)["sustained_fps"].get<double>();
    EXPECT_GT(fps, before) << process;
    before = fps;
  }
}

TEST(SustainVerb, TakesWhatTheIdleStateLeavesBetweenFrames) {
  double before = 0;
  for (const char* idle : {"power_gated", "clock_gated", "clocked"}) {
    const Json s = sustained({"--minutes", "0.1", "--fps", "60", "--set", std::string("power.idle=") + idle});
    EXPECT_NEAR(s["sustained_fps"].get<double>(), 60, 0.5);
    EXPECT_GT(s["energy_j"].get<double>(), 1.01 * before) << idle;
    before = s["energy_j"].get<double>();
  }
}

TEST(SustainVerb, OfSeveralFramesRepeatsThem) {
  const Json s = sustained({"--minutes", "0.1", "--frames", "0:1"});
  EXPECT_EQ(s["steps"][0]["frames"].size(), 2U);
}

TEST(SustainVerb, RefusesTimesThatAreNone) {
  for (const char* minutes : {"0", "-1", "x"}) {
    expect_refusal(raywatt({"sustain", "--minutes", minutes}), {"--minutes"});
  }
  expect_refusal(raywatt({"sustain", "--set", "thermal.steps=0"}), {"thermal.steps"});
}

TEST(SustainedRun, AddsItsFiguresToTheTotalsAndChangesNoOther) {
  const TempFolder folder;
  Json plain = read_json(simulate_into_folder(folder.path() / "a") / "report.json")["totals"];
  Json more =
      read_json(simulate_into_folder(folder.path() / "b", {"--set", "thermal.minutes=1"}) / "report.json")["totals"];
  EXPECT_NEAR(more["sustained_fps"].get<double>(), more["perf"]["fps"].get<double>(),
              1e-3 * more["perf"]["fps"].get<double>());
  EXPECT_EQ(more["stability"], 1);
  EXPECT_NEAR(more["sustained"]["minutes"].get<double>(), 1, 1e-3);
  for (const char* added : {"sustained_fps", "stability", "sustained"}) {
    EXPECT_FALSE(plain.contains(added));
    more.erase(added);
  }
  EXPECT_EQ(plain, more);
}

TEST(SustainedRun, PrintsItsFigure) {
  const TempFolder folder;
  const ProcessResult ending = raywatt(small_run(folder.path() / "a", {"--set", "thermal.minutes=1"}));
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "frames/s after 1 minutes, stability 100.0 %");
}

TEST(SustainedSweep, HasItsFrameRateAsObjectiveAndConstraint) {
  const TempFolder folder;
  const auto file = write_sweep(folder, "axes: {cores: [1, 2]}\nsets: [thermal.minutes=1]\n");
  ASSERT_EQ(raywatt(sweep_run(folder, file)).exit, 0);
  const std::string out = (folder.path() / "out").string();
  const ProcessResult best = raywatt({"sweep", "best", out, "--max", "sustained_fps"});
  EXPECT_EQ(best.exit, 0) << best.err;
  const ProcessResult table =
      raywatt({"sweep", "table", out, "--csv", "--columns", "cores,sustained_fps", "--where", "sustained_fps>0"});
  EXPECT_EQ(table.exit, 0) << table.err;
  EXPECT_EQ(std::count(table.out.begin(), table.out.end(), '\n'), 3) << table.out;
}

}  // namespace
}  // namespace test
