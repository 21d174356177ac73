#include "tools/studies/dvfs/dvfs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/full_size.h"
#include "tests/tools/program.h"
#include "tests/tools/studies/sweep/small_sweep.h"
#include "tools/analysis/report_file.h"
#include "tools/pricing/priced_run.h"

// Tests of `raywatt dvfs`, and of runs whose voltage depends on the clock.

namespace test {
namespace {

using Json = nlohmann::json;

Json report(const std::filesystem::path& folder, const Words& more) {
  Words words = small_run(folder, more);
  words.emplace_back("--quiet");
  ending_well(words);
  return read_json(folder / "report.json");
}

TEST(Dvfs, AtTheNominalClocksChangesNothing) {
  const TempFolder folder;
  Json plain = report(folder.path() / "a", {}), scaled = report(folder.path() / "b", {"--set", "power.voltage=dvfs"});
  EXPECT_EQ(scaled["config"]["power"]["voltage"], "dvfs");
  for (const char* part : {"totals", "units", "frames", "warnings"}) EXPECT_EQ(plain[part], scaled[part]) << part;
}

TEST(Dvfs, OfAFinishedRunIsPricedAsTheRunWouldHaveBeen) {
  const TempFolder folder;
  const Words clocks = {"--set", "clocks.tni=350 MHz", "--set", "clocks.srp=700 MHz"};
  Words scaled = clocks;
  scaled.insert(scaled.end(), {"--set", "power.voltage=dvfs", "--set", "power.temperature=50"});
  const Json run = report(folder.path() / "scaled", scaled), plain = report(folder.path() / "plain", clocks);
  EXPECT_EQ(plain["warnings"].size(), 2U);
  EXPECT_EQ(run["warnings"].size(), 0U);
  const Json priced = Json::parse(ending_well({"energy", "price", (folder.path() / "plain").string(), "--json", "--set",
                                               "power.voltage=dvfs", "--set", "power.temperature=50"})
                                      .out);
  EXPECT_EQ(priced["runs"][0]["priced"]["energy_mj"], run["totals"]["energy_mj"]);
  EXPECT_LT(run["totals"]["energy_mj"]["nominal"], plain["totals"]["energy_mj"]["nominal"]);
  EXPECT_EQ(run["totals"]["cycles"], plain["totals"]["cycles"]);
}

TEST(Dvfs, PointAtTheNominalClocksIsTheRun) {
  const TempFolder folder;
  const Json curve =
      Json::parse(ending_well({"dvfs", "--resolution", "64x64", "--factors", "1,0.5", "--json", "--threads", "2"}).out);
  ending_well(
      {"run", "--resolution", "64x64", "--set", "frame.start=warm", "-o", (folder.path() / "one").string(), "--quiet"});
  const Json run = read_json(folder.path() / "one" / "report.json");
  ASSERT_EQ(curve["points"].size(), 2U);
  EXPECT_EQ(curve["points"][0]["factor"], 0.5);
  EXPECT_EQ(curve["points"][1]["energy_mj"], run["totals"]["energy_mj"]);
  EXPECT_EQ(curve["points"][1]["cycles"], run["totals"]["cycles"]);
  EXPECT_LT(curve["points"][0]["cycles"], run["totals"]["cycles"]) << "memory is nearer to a slower core";
}

TEST(Dvfs, HasItsLeastEnergyInsideTheRangeForAFrameThatTheUnitsBound) {
  const Json curve =
      Json::parse(ending_well({"dvfs", "sgrt-balanced", "--resolution", "96x48", "--json", "--threads", "2"}).out);
  const std::size_t least = curve["energy_optimal"], last = curve["points"].size() - 1;
  EXPECT_GT(least, 0U);
  EXPECT_LT(least, last);
  EXPECT_EQ(curve["race_to_idle"], last);
}

TEST(Dvfs, AtARateFindsWhatABruteForceSearchFinds) {
  std::string factors = "0.3";
  for (int percent = 32; percent <= 120; percent += full_or(2, 4)) factors += fmt::format(",{}", percent / 100.0);
  const auto curve_of = [&](const char* fps, bool all) {
    Words words = {
        "dvfs", "sgrt-balanced", "--resolution", full_or("128x64", "64x32"), "--json", "--threads", "2", "--fps", fps};
    if (all) words.insert(words.end(), {"--factors", factors});
    return Json::parse(ending_well(words).out);
  };
  const auto point_of = [](const Json& curve, const char* which) {
    return curve["points"][curve[which].get<std::size_t>()];
  };
  const Json least = point_of(curve_of("500", false), "least_a_period"),
             true_least = point_of(curve_of("500", true), "least_a_period");
  EXPECT_GT(least["factor"], 0.3);
  EXPECT_LT(least["factor"], 1.2);
  EXPECT_NEAR(least["period_mj"].get<double>(), true_least["period_mj"].get<double>(),
              0.01 * true_least["period_mj"].get<double>());
  const Json slowest = point_of(curve_of("1500", false), "slowest_met");
  EXPECT_LE(slowest["time_ms"].get<double>(), 1000.0 / 1500);
  if (!is_full_size()) return;
  EXPECT_NEAR(slowest["factor"].get<double>(), point_of(curve_of("1500", true), "slowest_met")["factor"].get<double>(),
              0.03);
}

TEST(Dvfs, RefusesDomainsThatThereAreNot) {
  const ProcessResult ending = raywatt({"dvfs", "--clocks", "sarp"});
  EXPECT_EQ(ending.exit, 2);
  EXPECT_SAYS(ending.err, "'sarp', did you mean 'srp'");
}

tools::DvfsCurve two_points(double slow_mj, double fast_mj, double idle_mw) {
  tools::DvfsCurve curve;
  for (const auto& [ms, mj] : {std::pair{20.0, slow_mj}, std::pair{10.0, fast_mj}}) {
    tools::DvfsPoint point;
    point.ms = ms;
    point.mj = {mj, mj, mj};
    point.idle_mw = idle_mw;
    curve.points.push_back(point);
  }
  return curve;
}

// There is only leakage, 100 mW at one voltage: 2 mJ in 20 ms, 1 mJ in 10 ms. Gated it is 0.03 x 100 mW x 10 ms.
TEST(DvfsPoints, OfLeakageAloneRaceToIdle) {
  tools::DvfsCurve curve = two_points(2, 1, 3);
  tools::find_special_points(curve, 20);
  EXPECT_EQ(curve.energy_optimal, 1U);
  EXPECT_EQ(curve.race_to_idle, 1U);
  EXPECT_EQ(curve.least_a_period, 1U);
  EXPECT_DOUBLE_EQ(curve.points[0].period_mj, 2);
  EXPECT_DOUBLE_EQ(curve.points[1].period_mj, 1.03);
}

TEST(DvfsPoints, OfDynamicEnergyAloneAreAsSlowAsThePeriodAllows) {
  tools::DvfsCurve curve = two_points(1, 2, 0);
  tools::find_special_points(curve, 20);
  EXPECT_EQ(curve.energy_optimal, 0U);
  EXPECT_EQ(curve.least_a_period, 0U);
  tools::find_special_points(curve, 15);
  EXPECT_LT(curve.points[0].period_mj, 0) << "20 ms do not fit into 15";
  EXPECT_EQ(curve.least_a_period, 1U);
}

// Tests of target frame rates in runs, finished runs, sweeps and searches.

namespace fs = std::filesystem;

Json totals_of(const fs::path& out, Words more) {
  more.emplace_back("--quiet");
  output_of(small_run(out, more));
  return read_json(out / "report.json")["totals"];
}

struct TargetRate : testing::Test {
  TempFolder folder;
  fs::path plain = folder.path() / "plain", rated = folder.path() / "rated";
};

TEST_F(TargetRate, AddsFieldsAndChangesNoOther) {
  const Json without = totals_of(plain, {});
  Json with = totals_of(rated, {"--fps", "200"});
  for (const char* field : {"at_fps", "power_at_fps_w", "fps_margin"}) {
    EXPECT_FALSE(without.contains(field)) << field;
    EXPECT_EQ(with.erase(field), 1U) << field;
  }
  EXPECT_EQ(without, with);
}

TEST_F(TargetRate, OfAFinishedRunIsThatOfTheRun) {
  totals_of(plain, {});
  const Json with = totals_of(rated, {"--fps", "200"});
  const Json compared = Json::parse(output_of({"compare", plain.string(), rated.string(), "--fps", "200", "--json"}));
  const Json& figures = compared["against"][0]["figures"];
  for (const char* side : {"a", "b"}) {
    EXPECT_NEAR(figures["power_at_fps_w"][side], with["power_at_fps_w"]["nominal"], 1e-12) << side;
    EXPECT_DOUBLE_EQ(figures["fps_margin"][side], with["fps_margin"]) << side;
  }
  const Json priced =
      Json::parse(output_of({"energy", "price", plain.string(), "--set", "frame.fps=200", "--json"}))["runs"][0];
  for (const char* side : {"low", "nominal", "high"}) {
    EXPECT_NEAR(priced["priced"]["power_at_fps_w"][side], with["power_at_fps_w"][side], 1e-12) << side;
  }
  EXPECT_FALSE(priced["own"].contains("power_at_fps_w"));
}

TEST_F(TargetRate, OfAFinishedRunDropsSustainedMetricsOfAnotherRate) {
  totals_of(rated, {"--fps", "200", "--set", "thermal.minutes=0.1"});
  for (const double fps : {200.0, 100.0}) {
    tools::ReportFile report = tools::load_report(rated);
    tools::set_frame_rate(report, fps);
    EXPECT_EQ(report.number("totals.at_fps.fps"), fps);
    for (const char* name : {"sustained_fps", "stability", "sustained"}) {
      EXPECT_EQ(report.json["totals"].contains(name), fps == 200) << name << " at " << fps;
    }
    EXPECT_EQ(report.has("totals.sustained_fps"), fps == 200);
    EXPECT_EQ(report.has("totals.sustained.energy_j"), fps == 200);
  }
}

TEST_F(TargetRate, HasStatisticsOfReplicates) {
  const Json with = totals_of(rated, {"--fps", "200", "--replicates", "3"});
  const Json& power = with["replicates"]["figures"]["power_at_fps_w"]["nominal"];
  EXPECT_EQ(power["values"].size(), 3U);
  EXPECT_EQ(power["values"][0], with["power_at_fps_w"]["nominal"]);
  EXPECT_GT(with["replicates"]["figures"]["fps_margin"]["deviation"], 0);
}

TEST_F(TargetRate, IsAColumnAndAConditionOfSweeps) {
  const fs::path file = write_sweep(folder, "axes: {frame.start: [cold, warm], cores: [1, 2]}\n");
  output_of(sweep_run(folder, file, {"--fps", "300"}));
  const std::string out = (folder.path() / "out").string();
  const std::string table =
      output_of({"sweep", "table", out, "--columns", "n,frame.start,power_at_fps_w,fps_margin", "--csv"});
  EXPECT_SAYS(table, "totals.fps_margin");
  EXPECT_SAYS(table, "warm");
  output_of({"sweep", "best", out, "--min", "power_at_fps_w", "--where", "fps_margin>=1", "--energy", "band"});
}

TEST_F(TargetRate, StaysInASweepThatIsRunAgainOrResumed) {
  const fs::path file = write_sweep(folder, "axes: {cores: [1, 2]}\n"), out = folder.path() / "out";
  const auto margins = [&] {
    return output_of({"sweep", "table", out.string(), "--columns", "n,fps_margin,at_fps.fps", "--csv"});
  };
  output_of(sweep_run(folder, file, {"--fps", "300"}));
  const std::string before = margins();
  EXPECT_SAYS(before, ",300");
  output_of(sweep_run(folder, file, {"--fps", "300"}));
  EXPECT_EQ(last_run_counts(out), (Tally{2, 0, 2, 0}));
  fs::remove_all(folder.path() / "store/points");
  output_of({"sweep", "run", "--resume", "-o", out.string()});
  EXPECT_EQ(last_run_counts(out), (Tally{2, 2, 0, 0}));
  EXPECT_EQ(margins(), before);
}

TEST_F(TargetRate, IsAnObjectiveAndAConstraintOfSearches) {
  const fs::path file = folder.write(
      "search.yaml",
      "schema: raywatt-optimise/1\nresolution: 16x16\naxes: {cores: [1, 2], tni.trvs: [1, 2, 4]}\n"
      "objectives: [{min: power_at_fps_w}, {min: area_mm2}]\nconstraints: [fps_margin >= 1]\nbudget: 4\nbatch: 2\n");
  EXPECT_SAYS(output_of({"optimise", file.string(), "-o", (folder.path() / "search").string(), "--store",
                         (folder.path() / "store").string(), "--fps", "100"}),
              "power_at_fps_w");
}

TEST_F(TargetRate, IsPositiveAndOfFrames) {
  for (const char* fps : {"0", "-1", "many"}) {
    EXPECT_EQ(raywatt(small_run(plain, {"--fps", fps})).exit, 2) << fps;
  }
  const ProcessResult rays = raywatt({"run", "--rays", folder.write("a.rays", ray_list(4)).string(), "--set",
                                      "frame.start=warm", "-o", plain.string()});
  EXPECT_EQ(rays.exit, 2);
  EXPECT_SAYS(rays.err, "--rays: a list of rays is no frame of a sequence; allowed: frame.start=cold");
  EXPECT_EQ(raywatt({"sweep", "run", "--resume", "-o", plain.string(), "--fps", "60"}).exit, 2);
}

}  // namespace
}  // namespace test
