#include "tools/studies/bench/bench.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

// Tests of `raywatt bench`, alone and compared with another build.

namespace test {
namespace {

Words bench(const Words& more) {
  Words words = {"bench", "--resolution", "64x32", "--runs", "2"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Returns the JSON output of `raywatt bench` with these arguments.
nlohmann::json json_of(Words words) {
  words.emplace_back("--json");
  const ProcessResult ending = raywatt(words);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(ending.err, "");
  return nlohmann::json::parse(ending.out);
}

nlohmann::json metrics(const Words& more = {}) { return json_of(bench(more)); }

TEST(Bench, MeasuresEveryMetricOfEveryScene) {
  const nlohmann::json result = metrics({"--threads", "2"});
  EXPECT_EQ(result["runs"], 2);
  EXPECT_EQ(result["threads"], 2);
  ASSERT_EQ(result["scenes"].size(), 2U);
  for (const nlohmann::json& scene : result["scenes"]) {
    for (const tools::BenchMetric& metric : tools::bench_metrics()) {
      if (metric.kind == tools::BenchMetric::Kind::kFact) continue;
      EXPECT_GT(scene[metric.name], 0) << metric.name;
    }
    EXPECT_EQ(scene["sampling_cycles_error_percent"], 0) << "so small a frame is timed whole";
    EXPECT_EQ(scene["sampling_cycles_inside"], 1);
    EXPECT_GT(scene["functional_rays_per_s"], scene["one_thread_rays_per_s"]);
  }
}

TEST(Bench, PrintsAColumnForEveryMetric) {
  const std::string table = raywatt(bench({"--scene", "teapot"})).out;
  for (const tools::BenchMetric& metric : tools::bench_metrics()) EXPECT_SAYS(table, metric.header);
  EXPECT_SAYS(table, "teapot");
  EXPECT_EQ(std::ranges::count(table, '\n'), 7) << "two tables of three lines, one between them\n" << table;
}

TEST(Bench, OmitsSamplesOfProgramsWithoutSamples) {
  const nlohmann::json result = metrics({"--scene", "teapot", "--program", "multirate:under"});
  EXPECT_GT(result["scenes"][0]["replay_s_per_timing_s"], 0);
  EXPECT_FALSE(result["scenes"][0].contains("sampling_speedup"));
}

TEST(Bench, PeakMemoryIsThatOfTheScene) {
  const nlohmann::json both = metrics({"--scene", "chess", "--scene", "cornell"});
  EXPECT_LT(both["scenes"][1]["peak_rss_mb"].get<double>(), 0.9 * both["scenes"][0]["peak_rss_mb"].get<double>())
      << "the smaller scene comes last";
}

TEST(Bench, RefusesAMissingSceneWithOneLine) {
  expect_refusal(raywatt(bench({"--scene", "teapott"})), {"teapott", "did you mean 'teapot'"});
}

/// Returns saved metrics of a build: one scene, each metric with value `value`.
nlohmann::ordered_json saved(double value, const std::string& scene = "teapot") {
  nlohmann::ordered_json metrics = {{"scene", scene}};
  for (const tools::BenchMetric& metric : tools::bench_metrics()) metrics[metric.name] = value;
  return {{"schema", "raywatt-bench/2"}, {"scenes", {metrics}}};
}

TEST(Bench, PrintsTheRatioOfEachMetric) {
  const TempFolder folder;
  const std::string ours = folder.write("ours.json", saved(30).dump()).string();
  const std::string theirs = folder.write("theirs.json", saved(10).dump()).string();
  const nlohmann::json result = json_of({"bench", "--measured", ours, "--against", theirs});
  const nlohmann::json& against = result["scenes"][0]["against"];
  EXPECT_DOUBLE_EQ(against["simulated_rays_per_s"], 3) << "three times as many";
  EXPECT_DOUBLE_EQ(against["ns_per_step"], 1.0 / 3) << "three times as long";
  EXPECT_DOUBLE_EQ(against["peak_rss_mb"], 1.0 / 3);
  EXPECT_DOUBLE_EQ(against["sampling_speedup"], 3);
  EXPECT_FALSE(against.contains("sampling_cycles_inside")) << "a fact, not a speed";
  EXPECT_SAYS(raywatt(Words({"bench", "--measured", ours, "--against", theirs})).out, "x3.00");
}

TEST(Bench, TakesMediansOfAppendedResults) {
  const TempFolder folder;
  const std::string many = saved(5).dump(2) + "\n" + saved(1).dump() + saved(100).dump(2) + "\n";
  const nlohmann::json result = json_of({"bench", "--measured", folder.write("many.json", many).string()});
  EXPECT_EQ(result["scenes"][0]["ns_per_step"], 5);
}

TEST(Bench, ComparesOnlyMetricsThatTheOtherBuildHas) {
  const TempFolder folder;
  const nlohmann::json before = {{"schema", "raywatt-bench/1"},
                                 {"scenes",
                                  {{{"scene", "teapot"},
                                    {"functional_rays_per_s", 20},
                                    {"simulated_rays_per_s", 10},
                                    {"ns_per_step", 40},
                                    {"peak_rss_mb", 7}}}}};
  const nlohmann::json result = json_of({"bench", "--measured", folder.write("ours.json", saved(40).dump()).string(),
                                         "--against", folder.write("before.json", before.dump()).string()});
  const nlohmann::json against = result["scenes"][0]["against"];
  EXPECT_EQ(against,
            (nlohmann::json{{"recording_rays_per_s", 2.0}, {"one_thread_rays_per_s", 4.0}, {"ns_per_step", 1.0}}))
      << "one thread, peak memory of all scenes before";
}

TEST(Bench, OmitsScenesThatTheOtherBuildLacks) {
  const TempFolder folder;
  nlohmann::ordered_json both = saved(1);
  both["scenes"].push_back(saved(1, "chess")["scenes"][0]);
  const std::string ours = folder.write("ours.json", both.dump()).string();
  const std::string theirs = folder.write("theirs.json", saved(1, "chess").dump()).string();
  const nlohmann::json result = json_of({"bench", "--measured", ours, "--against", theirs});
  EXPECT_FALSE(result["scenes"][0].contains("against"));
  EXPECT_TRUE(result["scenes"][1].contains("against"));
  expect_refusal(
      raywatt({"bench", "--measured", folder.write("ours.json", saved(1).dump()).string(), "--against", theirs}),
      {"theirs.json: has no scene in common", "its scenes: chess"});
  expect_refusal(raywatt(bench({"--scene", "cornell", "--against", theirs})), {"no scene in common"});
}

TEST(Bench, RecordsItsConditions) {
  const nlohmann::json result = metrics({"--scene", "cornell", "--program", "full:1", "--set", "cores=2"});
  EXPECT_EQ(result["program"], "full:1");
  EXPECT_EQ(result["config"], "sgrt-2016");
  EXPECT_EQ(result["set"], nlohmann::json{"cores=2"});
  EXPECT_EQ(result["scenes"][0]["resolution"], nlohmann::json({64, 32}));
  EXPECT_EQ(result["scenes"][0]["config_hash"].get<std::string>().size(), 64U);
}

TEST(Bench, RefusesToCompareDifferentConditions) {
  const TempFolder folder;
  const nlohmann::json theirs = metrics({"--scene", "cornell", "--threads", "1"});
  const std::string file = folder.write("b1.json", theirs.dump()).string();
  const auto against = [&](const Words& more) {
    Words words = {"bench", "--scene", "cornell", "--threads", "1", "--runs", "1", "--against", file};
    words.insert(words.end(), more.begin(), more.end());
    return raywatt(words);
  };
  EXPECT_EQ(against({"--resolution", "64x32"}).exit, 0);
  expect_refusal(against({"--resolution", "32x32"}),
                 {"b1.json: cannot be compared", "cornell has resolution [64,32] instead of [32,32]"});
  expect_refusal(against({"--resolution", "64x32", "--program", "full:4"}),
                 {R"(program "full:1" instead of "full:4")"});
  expect_refusal(against({"--resolution", "64x32", "--set", "cores=2"}), {R"(set [] instead of ["cores=2"])"});
  nlohmann::json other = theirs;
  other["threads"] = 2;
  expect_refusal(raywatt({"bench", "--measured", folder.write("b2.json", other.dump()).string(), "--against", file}),
                 {"threads 1 instead of 2"});
  other = theirs;
  other["scenes"][0]["config_hash"] = "of another file of that name";
  const std::string changed = folder.write("b2.json", other.dump()).string();
  expect_refusal(raywatt({"bench", "--measured", changed, "--against", file}), {"config_hash"});
  other["git"] = "another build";
  folder.write("b2.json", other.dump());
  EXPECT_EQ(raywatt({"bench", "--measured", changed, "--against", file}).exit, 0) << "it may have other keys";
  expect_refusal(raywatt({"bench", "--measured",
                          folder
                              .write(
                                  "two.json", theirs.dump() +
                                                  [&] {
                                                    other = theirs;
                                                    other["program"] = "full:4";
                                                    return other.dump();
                                                  }())
                              .string()}),
                 {"two.json", "results of different kinds", "program"});
}

TEST(Bench, RefusesMeasuringOptionsWithSavedMetrics) {
  const TempFolder folder;
  const std::string ours = folder.write("ours.json", saved(1).dump()).string();
  for (const Words& words : std::vector<Words>{
           {"--scene", "chess"}, {"--program", "full:4"}, {"--runs", "1"}, {"--set", "cores=2"}, {"sgrt-2016"}}) {
    Words all = {"bench", "--measured", ours};
    all.insert(all.end(), words.begin(), words.end());
    expect_refusal(raywatt(all), {"excludes --measured"});
  }
}

TEST(Bench, RefusesFilesWithoutMetrics) {
  const TempFolder folder;
  for (const char* text :
       {"", "{", "[]", "{}", R"({"schema": "raywatt-bench/2", "sc)", "7", R"({"schema": "raywatt-report/1"})",
        R"({"schema": "raywatt-bench/2"})", R"({"schema": "raywatt-bench/2", "scenes": 3})",
        R"({"schema": "raywatt-bench/2", "scenes": [{}]})",
        R"({"schema": "raywatt-bench/2", "scenes": [{"scene": "a", "ns_per_step": "fast"}]})"}) {
    const std::string file = folder.write("bad.json", text).string();
    const ProcessResult ending = raywatt(bench({"--against", file}));
    expect_refusal(ending, {"bad.json", "bench --json"});
    EXPECT_EQ(ending.err.find("exception"), std::string::npos) << ending.err;
  }
  expect_refusal(raywatt(bench({"--against", (folder.path() / "none.json").string()})), {"none.json"});
  const std::string deep = folder.write("deep.json", std::string(200'000, '[')).string();
  expect_refusal(raywatt(bench({"--against", deep})), {"deep.json"});
}

}  // namespace
}  // namespace test
