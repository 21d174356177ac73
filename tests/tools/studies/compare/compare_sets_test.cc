#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tests/tools/studies/compare/compare_harness.h"

// Comparisons of two machines on several workloads.

namespace test {
namespace {

using Json = nlohmann::json;

/// Machines `a` and `b` on two scenes, each run in a folder of its machine.
struct RunSets : Runs {
  RunSets() {
    for (const auto& [from, to] : {std::pair{"base", "a/first"}, {"teapot", "a/second"}, {"ports", "b/z"}}) {
      copy(path(from), to);
    }
    const auto teapot = folder.path() / "b/y";
    if (std::filesystem::exists(teapot)) return;
    const ProcessResult ending =
        raywatt({"run", "--quiet", "--threads", "1", "-o", teapot.string(), "--scene", "teapot", "--set",
                 "scene.triangles=1000", "--resolution", "32x16", "--set", "srp.switch_cycles=16"});
    EXPECT_EQ(ending.exit, 0) << ending.err;
  }
  void copy(const std::string& from, const std::string& to) const {
    const auto target = folder.path() / to;
    if (std::filesystem::exists(target)) return;
    std::filesystem::create_directories(target);
    std::filesystem::copy_file(from + "/report.json", target / "report.json");
  }
  std::string at(const std::string& name) const { return (folder.path() / name).string(); }
  double value(const std::string& run, const char* group, const char* name) const {
    const Json totals = read_json(at(run) + "/report.json")["totals"];
    return totals[group][name].get<double>();
  }
};

TEST_F(RunSets, AreMatchedByWorkload) {
  const ProcessResult ending = raywatt({"compare", at("a"), at("b"), "--json"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const Json all = Json::parse(ending.out);
  EXPECT_EQ(all["schema"], "raywatt-compare-sets/1");
  const Json& c = all["against"][0];
  EXPECT_EQ(c["workloads"], (Json{"cornell", "teapot"}));
  EXPECT_EQ(c["config"], (Json{{{"key", "srp.switch_cycles"}, {"a", "8"}, {"b", "16"}}}));
  const Json& fps = c["figures"]["fps"];
  EXPECT_EQ(fps["teapot"]["a"], value("a/second", "perf", "fps"));
  EXPECT_EQ(fps["teapot"]["b"], value("b/y", "perf", "fps"));
  EXPECT_EQ(fps["cornell"]["b"], value("b/z", "perf", "fps"));
  EXPECT_NEAR(fps["geomean"]["a"], std::sqrt(fps["cornell"]["a"].get<double>() * fps["teapot"]["a"].get<double>()),
              1e-6);
  EXPECT_NEAR(fps["mean"]["a"], (fps["cornell"]["a"].get<double>() + fps["teapot"]["a"].get<double>()) / 2, 1e-9);
  EXPECT_EQ(fps["worst"]["b"], std::min(fps["cornell"]["b"].get<double>(), fps["teapot"]["b"].get<double>()));
  EXPECT_EQ(c["figures"]["energy_mj"]["worst"]["a"], std::max(c["figures"]["energy_mj"]["cornell"]["a"].get<double>(),
                                                              c["figures"]["energy_mj"]["teapot"]["a"].get<double>()));
  EXPECT_EQ(c["figures"]["area_mm2"].size(), 1U) << "it is equal on all workloads";
  EXPECT_FALSE(c["figures"]["rays"].contains("worst")) << "more rays are neither better nor worse";
  const Json alone = compared("base", "ports");
  EXPECT_EQ(c["runs"][0]["figures"], alone["figures"]);
}

TEST_F(RunSets, HaveLessNoiseInTheirMean) {
  const Json c = Json::parse(raywatt({"compare", at("a"), at("b"), "--json"}).out)["against"][0];
  const Json& cycles = c["figures"]["cycles"];
  const auto width = [&](const char* of) { return cycles[of]["noise"]["half_width"].get<double>(); };
  EXPECT_LT(width("geomean"), 0.8 * std::max(width("cornell"), width("teapot")));
  EXPECT_GT(width("geomean"), 0.6 * std::min(width("cornell"), width("teapot")));
}

TEST_F(RunSets, AreComparedByTheMetricsThatAreNamed) {
  const auto compared_by = [&](const Words& metrics, const Words& more = {}) {
    Words words = {"compare", at("a"), at("b")};
    for (const std::string& metric : metrics) words.insert(words.end(), {"--metric", metric});
    words.insert(words.end(), more.begin(), more.end());
    return raywatt(words);
  };
  const ProcessResult ending =
      compared_by({"mean(fps)", "on(teapot, utilisation.dram)", "geomean(totals.rays.total)"}, {"--json"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const Json figures = Json::parse(ending.out)["against"][0]["figures"];
  const double mean = (value("b/y", "perf", "fps") + value("b/z", "perf", "fps")) / 2;
  EXPECT_NEAR(figures["fps"]["mean"]["b"], mean, 1e-9 * mean);
  EXPECT_FALSE(figures.contains("perf.fps")) << "a main metric has one name";
  EXPECT_EQ(figures["utilisation.dram"]["teapot"]["a"], value("a/second", "utilisation", "dram"));
  EXPECT_NEAR(figures["rays"]["geomean"]["a"],
              std::sqrt(value("a/first", "rays", "total") * value("a/second", "rays", "total")), 1e-6);
  const std::string table = compared_by({"worst(fps)", "cycles"}).out;
  for (const char* row : {"perf.fps", "worst", "cycles", "cornell", "teapot"}) EXPECT_SAYS(table, row);
  for (const char* row : {"area_mm2", "power_w", "geomean"}) EXPECT_EQ(table.find(row), std::string::npos) << table;
  EXPECT_SAYS(table, "worst is the lowest value");
  const std::string areas = compared_by({"worst(area_mm2)", "mean(cycles)"}).out;
  EXPECT_EQ(areas.find("worst"), std::string::npos) << areas;
  EXPECT_SAYS(areas, "  all  ");
  EXPECT_SAYS(compared_by({"on(tea, fps)"}).err, "'tea' is no workload; allowed: cornell, teapot");
  EXPECT_SAYS(compared_by({"mean(fsp)"}).err, "no report path 'fsp', did you mean 'fps'?");
  EXPECT_SAYS(raywatt({"compare", path("base"), path("ports"), "--metric", "fps"}).err, "--metric is for sets of runs");
}

TEST_F(RunSets, AreAlsoTwoListsOfRuns) {
  const ProcessResult folders = raywatt({"compare", at("a"), at("b")});
  const ProcessResult lists = raywatt({"compare", at("a/second"), at("a/first"), "--with", at("b/z"), at("b/y")});
  ASSERT_EQ(folders.exit, 0) << folders.err;
  ASSERT_EQ(lists.exit, 0) << lists.err;
  EXPECT_SAYS(folders.out, "b against a, 2 workloads");
  EXPECT_SAYS(folders.out, "srp.switch_cycles: 8 -> 16");
  EXPECT_SAYS(folders.out, "raywatt compare " + at("a/second") + " " + at("b/y"));
  for (const char* row : {"geomean", "worst"}) EXPECT_SAYS(lists.out, row);
}

TEST_F(RunSets, OfOtherWorkloadsAreRefused) {
  copy(path("larger"), "c/only");
  copy(path("base"), "d/one");
  copy(path("same"), "d/two");
  EXPECT_SAYS(raywatt({"compare", at("a"), at("c")}).err,
              "a has runs of cornell, teapot; c of cornell; allowed: sets of the same workloads");
  EXPECT_SAYS(raywatt({"compare", at("d"), at("d")}).err, "d: has two runs of cornell 32x16");
  EXPECT_SAYS(raywatt({"compare", at("a"), path("base")}).err, "base: is no folder of runs, as another is");
}

}  // namespace
}  // namespace test
