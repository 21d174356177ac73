#include "tools/studies/reproduce/reproduce.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "tests/full_size.h"
#include "tests/tools/program.h"
#include "tools/studies/reproduce/plan.h"
#include "tools/studies/reproduce/runner.h"

// Tests of `raywatt reproduce`, which compares measured with published values.

namespace test {
namespace {

namespace fs = std::filesystem;
using namespace tools::reproduce;

/// Returns the metrics that a plan measures.
std::set<MetricKey> metric_keys(const Paper& paper, bool quick) {
  std::set<MetricKey> out;
  for (const Case& c : paper.cases(quick)) {
    for (const PaperMetric& metric : c.metrics) {
      out.insert({metric.experiment, c.view.scene, c.setting, metric.metric});
    }
  }
  return out;
}

std::string name_of(const MetricKey& p) { return p.experiment + ", " + p.scene + ", " + p.setting + ", " + p.metric; }

/// Uses a cache folder of the test.
ProcessEnvironment with_cache(const TempFolder& folder) {
  return {.folder = {},
          .variables = {{"XDG_CACHE_HOME", (folder.path() / "cache").string()}},
          .longest_file = 0,
          .out = ""};
}

class EachPaper : public testing::TestWithParam<Paper> {};
INSTANTIATE_TEST_SUITE_P(Reproduce, EachPaper, testing::ValuesIn(all_papers()), [](const auto& paper) {
  std::string name(paper.param.name);
  std::ranges::replace(name, '-', '_');
  return name;
});

// Unless at full size, one case of each program with its metrics is enough.
TEST_P(EachPaper, HasANumberForEveryMetricOfASmallPicture) {
  tools::reproduce::Options options;
  options.threads = 1;
  Runner runner(options);
  std::set<std::string> measured_before;
  for (Case c : GetParam().cases(true)) {
    std::string metrics = c.run.name;
    for (const PaperMetric& metric : c.metrics) metrics += " " + metric.metric;
    if (!measured_before.insert(metrics).second && !is_full_size()) continue;
    c.width = 64;
    c.height = 32;
    const std::vector<Measured> measured = runner.measure_case(c);
    ASSERT_EQ(measured.size(), c.metrics.size());
    for (std::size_t i = 0; i < measured.size(); ++i) {
      EXPECT_TRUE(measured[i].value.has_value()) << c.view.scene << ", " << c.setting << ", " << c.metrics[i].metric;
    }
  }
}

/// Returns all papers at full size, otherwise the one whose quick run is shortest.
TEST_P(EachPaper, HasANumberForEveryRowOfAQuickRun) {
  if (!is_full_size() && GetParam().name != "hybrid") GTEST_SKIP() << "tools/validate full";
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  const std::string paper(GetParam().name);
  const ProcessResult ending = raywatt({"reproduce", paper, "--quick", "-o", out.string()}, with_cache(folder));
  EXPECT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json results = read_json(out / "reproduce.json");
  EXPECT_EQ(results["schema"], "raywatt-reproduce/1");
  EXPECT_EQ(results["paper"], paper);
  EXPECT_EQ(results["partial"], false);
  EXPECT_EQ(results["rows"].size(), metric_keys(GetParam(), true).size());
  for (const nlohmann::json& row : results["rows"]) EXPECT_TRUE(row["measured"].is_number()) << row;
  EXPECT_SAYS(ending.out, std::string(GetParam().title));
  EXPECT_SAYS(read_bytes(out / "reproduce.md"), "| scene | stand-in |");
  const std::vector<Case> cases = GetParam().cases(true);
  EXPECT_EQ(std::ranges::any_of(names_in(out), [](const std::string& n) { return n.starts_with("figure-"); }),
            std::ranges::any_of(cases, [](const Case& c) { return !c.picture.empty(); }));
}

TEST_P(EachPaper, MeasuresEveryPublishedMetric) {
  const std::set<MetricKey> measured = metric_keys(GetParam(), false);
  for (const auto& [key, range] : load_published_values(std::string(GetParam().name))) {
    EXPECT_TRUE(measured.contains(key)) << name_of(key);
    EXPECT_LE(range.low, range.high) << name_of(key);
  }
}

TEST_P(EachPaper, MeasuresFewerMetricsInAQuickRun) {
  const std::set<MetricKey> all = metric_keys(GetParam(), false), quick = metric_keys(GetParam(), true);
  EXPECT_LT(quick.size(), all.size());
  for (const MetricKey& key : quick) EXPECT_TRUE(all.contains(key)) << name_of(key);
}

TEST_P(EachPaper, NamesMetricsThatExistAndEachPictureOnce) {
  std::set<std::string> pictures;
  for (const Case& c : GetParam().cases(false)) {
    for (const PaperMetric& metric : c.metrics) EXPECT_NO_THROW(find_metric(metric.metric)) << metric.metric;
    EXPECT_TRUE(c.picture.empty() || pictures.insert(c.picture).second) << c.picture;
  }
}

TEST(PublishedValues, HoldsNumbersAndRanges) {
  const PublishedValues p = parse_published_values(
      "table 1:\n  teapot:\n    super: {psnr_db: 48.99, tni_power: {low: 1, high: 1.09}}\n", "p.yaml");
  EXPECT_EQ(p.at({"table 1", "teapot", "super", "psnr_db"}), (Range{48.99, 48.99}));
  EXPECT_EQ(p.at({"table 1", "teapot", "super", "tni_power"}), (Range{1, 1.09}));
}

TEST(PublishedValues, IsRefusedWithItsPlaceIfInvalid) {
  const std::pair<const char*, const char*> wrong[] = {{"a: 1\n", "p.yaml:1:1: 'a'"},
                                                       {"a: {b: {c: {d: x}}}\n", "'d' must be a number"},
                                                       {"a: {b: {c: {d: .inf}}}\n", "'d' must be a number"},
                                                       {"a: {b: {c: {d: {low: 2, high: 1}}}}\n", "low: number"},
                                                       {"a: {b: {c: {d: {low: 2}}}}\n", "low: number"},
                                                       {"a: {b: {c: [1]}}\n", "'c' must be a mapping"}};
  for (const auto& [text, says] : wrong) {
    try {
      parse_published_values(text, "p.yaml");
      ADD_FAILURE() << text;
    } catch (const sim::InputError& error) {
      EXPECT_SAYS(std::string(error.what()), says);
    }
  }
}

TEST(Reproduce, SkipsMissingScenesAndNamesTheirFiles) {
  const TempFolder folder;
  tools::reproduce::Options options;
  options.paper = "kim2016";
  const tools::reproduce::View kitchen{
      .scene = "kitchen", .stand_in = "", .files = {"kitchen.glb", "kitchen-866k.glb"}};
  const auto complaint = [&] {
    try {
      return Runner(options).find_stand_in_scene(kitchen);
    } catch (const sim::InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_SAYS(complaint(), "--scenes DIR with kitchen.glb or kitchen-866k.glb");
  options.scenes = folder.path();
  EXPECT_SAYS(complaint(), "there is no kitchen.glb or kitchen-866k.glb");
  folder.write("kitchen-866k.glb", "");
  EXPECT_EQ(complaint(), (folder.path() / "kitchen-866k.glb").string());
}

TEST(Reproduce, UsesABuiltInSceneOnlyWithoutTheOriginal) {
  const TempFolder folder;
  tools::reproduce::Options options;
  const tools::reproduce::View car{.scene = "car", .stand_in = "car", .files = {"car-62k.glb"}};
  EXPECT_EQ(Runner(options).find_stand_in_scene(car), "car");
  options.scenes = folder.path();
  EXPECT_EQ(Runner(options).find_stand_in_scene(car), "car");
  folder.write("car-62k.glb", "");
  EXPECT_EQ(Runner(options).find_stand_in_scene(car), (folder.path() / "car-62k.glb").string());
}

TEST(Reproduce, ComparesARunWithAReferenceOnAnotherTree) {
  tools::reproduce::Options options;
  options.threads = 1;
  Runner runner(options);
  Case c{.view = {.scene = "teapot", .stand_in = "teapot", .files = {}},
         .setting = "hybrid",
         .width = 32,
         .height = 16,
         .run = {"full:1", {"bvh.numbers=hybrid"}},
         .reference = {"full:1"}};
  c.metrics = {{"", "box_bytes_ratio"}, {"", "node_bytes_ratio"}};
  const std::vector<Measured> measured = runner.measure_case(c);
  EXPECT_DOUBLE_EQ(measured.at(0).value.value(), 29.0 / 48) << "twelve planes of 19 bits against twelve floats";
  EXPECT_DOUBLE_EQ(measured.at(1).value.value(), 40.0 / 64);
  std::swap(c.run, c.reference);
  EXPECT_DOUBLE_EQ(runner.measure_case(c).at(0).value.value(), 48 / 29.0);
}

TEST(Reproduce, MeasuresFigure7OfLeeOnUnitsAloneAndTheFrameOnTheWholeMachine) {
  const Sets alone = tni_alone_settings();
  std::set<std::string> scopes;
  for (const Case& c : lee_cases(false)) {
    for (const PaperMetric& metric : c.metrics) {
      if (metric.experiment != "figure 7" && metric.experiment != "whole frame") continue;
      scopes.insert(metric.experiment);
      const Sets expected = metric.experiment == "figure 7" ? alone : Sets{};
      EXPECT_EQ(c.run.sets, expected) << metric.experiment << ", " << c.view.scene;
      EXPECT_EQ(c.reference.sets, expected) << metric.experiment << ", " << c.view.scene;
    }
  }
  EXPECT_EQ(scopes.size(), 2U);
}

TEST(Reproduce, CountsMoreOperationsForAnInterpolatedSampleThanForATracedOne) {
  tools::reproduce::Options options;
  options.threads = 1;
  Runner runner(options);
  Case c{.view = {.scene = "conference", .stand_in = "kim2016-conference", .files = {}},
         .setting = "1x1",
         .width = 128,
         .height = 128,
         .run = {"undersample"},
         .reference = {"full:1"}};
  c.metrics = {{"", "ops_of_traced"}, {"", "ops_of_interpolated"}};
  const std::vector<Measured> measured = runner.measure_case(c);
  EXPECT_GT(measured.at(0).value.value(), 100);
  EXPECT_GT(measured.at(1).value.value(), measured.at(0).value.value());
  c.run = c.reference;
  EXPECT_FALSE(runner.measure_case(c).at(1).value.has_value()) << "all samples are traced";
}

TEST(Reproduce, ExplainsHowToCompareMetrics) {
  Results results;
  results.note = "a note";
  EXPECT_SAYS(results_text(results), "\na note\n");
  EXPECT_SAYS(results_markdown(results, {}), "\na note\n");
}

TEST(Reproduce, WritesProgramsReferencesAndMetricsOverScenes) {
  Results results;
  for (const double speedup : {1.0, 3.0, 2.0}) {
    results.rows.push_back({.key = {"caches", fmt::format("scene {}", speedup), "large", "speedup"},
                            .stand_in = "",
                            .width = 8,
                            .height = 4,
                            .program = "full:1 --set a=2",
                            .reference = "full:1 --set a=1",
                            .measured = speedup,
                            .why_not = "",
                            .published = Range{1, 2.9}});
  }
  const std::string text = results_markdown(results, {});
  EXPECT_SAYS(text, "| large | `full:1 --set a=2` | `full:1 --set a=1` |");
  EXPECT_SAYS(text, "| large | speedup | 3 | 2.00 x | 1.00 x to 3.00 x | 1.00 x to 2.90 x |");
}

TEST(Reproduce, RefusesUnknownNamesBeforeItStarts) {
  const TempFolder folder;
  const std::string out = (folder.path() / "out").string();
  expect_refusal(raywatt({"reproduce", "lee2061", "-o", out}), {"lee2061", "did you mean 'lee2016'", "kim2016"});
  expect_refusal(raywatt({"reproduce", "lee2016", "--scenes", "/no/such/folder", "-o", out}),
                 {"--scenes", "not a folder"});
  expect_refusal(raywatt({"reproduce", "lee2016", "--config", "sgrt-2061", "-o", out}), {"sgrt-2061", "sgrt-2016"});
  EXPECT_TRUE(names_in(folder.path()).empty());
}

TEST(Mirrors, CoverAboutTheRequestedShareOfTheView) {
  tools::JobOptions options;
  options.scene = "kim2016-bathroom";
  options.sets = {"scene.triangles=15000"};
  tools::Inputs inputs = tools::load_inputs(options);
  double before = 0;
  for (const double share : {0.3, 0.6, 1.0}) {
    set_reflective_share(inputs, share, 1);
    const double reached = reflective_share(inputs, 1);
    EXPECT_NEAR(reached, share, 0.1);
    EXPECT_GT(reached, before);
    before = reached;
  }
}

}  // namespace
}  // namespace test
