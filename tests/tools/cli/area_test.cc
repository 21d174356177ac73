#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/pricing/two_designs.h"
#include "tests/tools/studies/sweep/small_sweep.h"

// Area of the machine in reports, in sweeps, and in conditions.

namespace test {
namespace {

using Json = nlohmann::json;

double sum_of(const Json& spreads) {
  double sum = 0;
  for (const Json& s : spreads) sum += s["nominal"].get<double>();
  return sum;
}

TEST(AreaOfARun, SumsByBlockAndByPartAndDividesWhatTheFrameGives) {
  const TempFolder folder;
  const auto out = run_into(folder.path() / "a");
  const Json report = read_json(out / "report.json"), t = report["totals"];
  const double mm2 = t["area_mm2"].get<double>();
  EXPECT_EQ(t["area_band_mm2"]["nominal"], mm2);
  EXPECT_LT(t["area_band_mm2"]["low"], mm2);
  EXPECT_GT(t["area_band_mm2"]["high"], mm2);
  const double placement = report["config"]["area"]["placement"]["nominal"].get<double>();
  EXPECT_NEAR(sum_of(t["area_by_block_mm2"]) * placement, mm2, 1e-9);
  EXPECT_NEAR(sum_of(t["area_by_part_mm2"]) * placement, mm2, 1e-9);
  EXPECT_DOUBLE_EQ(t["perf"]["frames_per_joule_per_mm2"].get<double>() * mm2,
                   t["perf"]["frames_per_joule_gpu"].get<double>());
  EXPECT_DOUBLE_EQ(t["perf"]["mrays_per_s_per_mm2"].get<double>() * mm2, t["perf"]["mrays_per_s"].get<double>());
  EXPECT_SAYS(read_bytes(out / "report.txt"), "Mrays/s per mm2");
}

TEST(AreaOfARun, OfAnotherProcessIsAnotherAndMovesNothingElse) {
  const TempFolder folder;
  const Json a = read_json(run_into(folder.path() / "a") / "report.json")["totals"];
  const auto out = run_into(folder.path() / "b", {"--set", "area.extends=area/7nm"});
  const Json b = read_json(out / "report.json")["totals"];
  EXPECT_LT(b["area_mm2"].get<double>(), 0.7 * a["area_mm2"].get<double>());
  EXPECT_EQ(a["cycles"], b["cycles"]);
  EXPECT_EQ(a["energy_mj"], b["energy_mj"]);
}

TEST(AreaOfARun, OfABlockThatTheTableDoesNotKnowIsRefused) {
  const TempFolder folder;
  const auto file = folder.write("c.yaml", "extends: sgrt-2016\nenergy: {logic: {}}\narea: {arrays: {}}\n");
  EXPECT_EQ(raywatt({"config", "show", file.string()}).exit, 0);
  expect_refusal(raywatt({"run", "--resolution", "16x16", "--quiet", "-o", (folder.path() / "x").string(), "--set",
                          "area.arrays.tni=1"}),
                 {"area.arrays.tni", "with and without a size"});
}

TEST(AreaOfASweep, IsAColumnAndACondition) {
  const TempFolder folder;
  const auto file = write_sweep(folder, "axes: {cores: [1, 2]}\n");
  ASSERT_EQ(raywatt(sweep_run(folder, file)).exit, 0);
  const std::string out = (folder.path() / "out").string();
  const Ending table = raywatt({"sweep", "table", out, "--csv", "--columns", "cores,area_mm2"});
  ASSERT_EQ(table.exit, 0) << table.err;
  const double small = std::stod(table.out.substr(table.out.find("\n1,") + 3));
  const double large = std::stod(table.out.substr(table.out.find("\n2,") + 3));
  EXPECT_LT(small, large);
  const std::string limit = "area_mm2<=" + std::to_string((small + large) / 2);
  const Ending met = raywatt({"sweep", "table", out, "--csv", "--columns", "cores", "--where", limit});
  EXPECT_EQ(met.out, "cores\n1\n");
  EXPECT_EQ(raywatt({"sweep", "best", out, "--max", "frames_per_joule_per_mm2", "--energy", "band"}).exit, 0);
}

}  // namespace
}  // namespace test
