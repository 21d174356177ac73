#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/studies/sweep/small_sweep.h"
#include "tools/analysis/report_file.h"
#include "tools/pricing/rated_report.h"

// Tests of target frame rates in runs, finished runs, sweeps and searches.

namespace test {
namespace {

using Json = nlohmann::json;
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
