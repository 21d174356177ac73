#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tests/tools/studies/compare/compare_harness.h"
#include "tools/analysis/report_file.h"

// Tests of `raywatt compare`: metrics that changed, and the counters that explain them.

namespace test {
namespace {

using Json = nlohmann::json;

TEST_F(Runs, WithEqualInputsAreEqualToTheLastCounterAndPixel) {
  const Json c = compared("base", "same");
  for (const char* list : {"config", "time", "reasons", "ratios", "energy_by_block_mj", "counters", "other_work"}) {
    EXPECT_TRUE(c[list].empty()) << list << c[list];
  }
  EXPECT_EQ(c["figures"]["cycles"]["relative"], 1);
  EXPECT_EQ(c["picture"]["identical"], true);
  const std::string text = raywatt({"compare", path("base"), path("same")}).out;
  EXPECT_SAYS(text, "configurations are equal");
  EXPECT_SAYS(text, "all counters are equal");
  EXPECT_SAYS(text, "identical");
}

TEST_F(Runs, ListDifferentKeysAndTheSpeedup) {
  const Json c = compared("base", "ports");
  ASSERT_EQ(c["config"].size(), 1U);
  EXPECT_EQ(c["config"][0], (Json{{"key", "srp.switch_cycles"}, {"a", "8"}, {"b", "16"}}));
  const Json a = read_json(folder.path() / "base" / "report.json")["totals"];
  const Json b = read_json(folder.path() / "ports" / "report.json")["totals"];
  const Json& cycles = c["figures"]["cycles"];
  EXPECT_EQ(cycles["a"], a["cycles"]);
  EXPECT_EQ(cycles["b"], b["cycles"]);
  EXPECT_DOUBLE_EQ(cycles["relative"], b["cycles"].get<double>() / a["cycles"].get<double>());
  EXPECT_EQ(c["figures"]["power_w"]["b"], b["power_w"]["nominal"]);
  EXPECT_EQ(c["figures"]["rays"]["relative"], 1);
  EXPECT_EQ(c["figures"]["frames_per_joule_gpu"]["a"], a["perf"]["frames_per_joule_gpu"]);
  EXPECT_SAYS(raywatt({"compare", path("base"), path("ports")}).out, "srp.switch_cycles: 8 -> 16");
}

TEST_F(Runs, NameMetricsAsOtherVerbsDo) {
  std::vector<std::string> paths;
  const auto report = sim::parse_json(read_bytes(path("base") + "/report.json"));
  for (const tools::ReportNumber& number : tools::report_numbers(report)) paths.push_back(number.path);
  std::istringstream text(raywatt({"compare", path("base"), path("ports")}).out);
  std::size_t figures = 0;
  for (std::string line; std::getline(text, line) && !line.starts_with("picture");) {
    const std::string name = line.substr(0, line.find(' '));
    if (name.empty() || name.front() == '-') continue;
    EXPECT_EQ(tools::resolve_report_path(name, paths), "totals." + name) << "in full, as sweeps have it";
    ++figures;
  }
  EXPECT_GE(figures, 13U);
}

TEST_F(Runs, MarkExtrapolatedRuns) {
  const std::string beyond = changed("beyond.json", [](Json& report) { report["totals"]["extrapolated"] = 2; });
  const std::string err = raywatt({"compare", path("base"), beyond}).err,
                    said = " some metrics are extrapolated, see its warnings";
  EXPECT_SAYS(err, beyond + ":" + said);
  EXPECT_EQ(err.find(said), err.rfind(said)) << "base has none";
}

TEST_F(Runs, ListTheLargestExplanationsFirst) {
  const Json c = compared("base", "slow-l2");
  for (const char* list : {"time", "reasons", "energy_by_block_mj", "energy_by_event_mj"}) {
    ASSERT_GE(c[list].size(), 2U) << list;
    for (std::size_t i = 1; i < c[list].size(); ++i) {
      EXPECT_GE(std::abs(c[list][i - 1]["difference"].get<double>()), std::abs(c[list][i]["difference"].get<double>()));
    }
  }
  EXPECT_EQ(c["time"][0]["name"], "tree_misses.l2") << c["time"];
  EXPECT_EQ(c["ratios"][0]["name"].get<std::string>().substr(0, 7), "node L1");
}

TEST_F(Runs, GiveRatesAsShares) {
  const Json c = compared("base", "samples");
  bool has_row_hits = false;
  for (const Json& ratio : c["ratios"]) {
    const std::string name = ratio["name"];
    has_row_hits = has_row_hits || name == "DRAM row hit rate";
    if (!name.ends_with("rate")) continue;
    EXPECT_GE(ratio["a"].get<double>(), 0) << name;
    EXPECT_LE(ratio["a"].get<double>(), 1) << name;
  }
  EXPECT_TRUE(has_row_hits);
}

TEST_F(Runs, ExplainTheWholeDifferenceInCycles) {
  const Json c = compared("base", "slow-l2");
  double sum = 0;
  for (const Json& part : c["time"]) sum += part["difference"].get<double>();
  const Json& cycles = c["figures"]["cycles"];
  EXPECT_NEAR(sum, cycles["b"].get<double>() - cycles["a"].get<double>(), 1e-6 * cycles["a"].get<double>());
}

TEST_F(Runs, ExplainTheWholeDifferenceInEnergy) {
  const Json c = compared("base", "slow-l2");
  double sum = 0;
  for (const Json& event : c["energy_by_event_mj"]) {
    const std::string name = event["name"];
    const bool standby = name.find("standby") != std::string::npos || name == "dram dram.power_down";
    if (!standby) sum += event["difference"].get<double>();  // standby of the DRAM is part of leakage
  }
  const Json& energy = c["figures"]["energy_mj"];
  EXPECT_NEAR(sum, energy["b"].get<double>() - energy["a"].get<double>(), 1e-6 * energy["a"].get<double>());
}

TEST_F(Runs, WithOtherWorkAreComparedWithAWarning) {
  const auto warned = [&](const std::string& other, const std::string& why) {
    const ProcessResult ending = raywatt({"compare", path("base"), path(other)});
    EXPECT_EQ(ending.exit, 0);
    EXPECT_SAYS(ending.err, "raywatt: warning: ");
    EXPECT_SAYS(ending.err, why);
  };
  warned("teapot", "scenes: cornell and teapot");
  warned("larger", "resolutions: 32x16 and 48x32");
  warned("samples", "programs: full:1 and full:4");
  EXPECT_EQ(raywatt({"compare", path("base"), path("ports")}).err, "");
}

TEST_F(Runs, ReportPicturesOfDifferentSizes) {
  EXPECT_EQ(compared("base", "larger")["picture"]["why_not"], "sizes differ: 32x16 and 48x32");
  const double psnr = compared("base", "samples")["picture"]["psnr_db"];
  EXPECT_GT(psnr, 10);
  EXPECT_LT(psnr, 60);
}

TEST_F(Runs, CompareEightBitPicturesIfOneHasNoOther) {
  const std::filesystem::path copy = folder.path() / "copy";
  std::filesystem::copy(path("samples"), copy, std::filesystem::copy_options::recursive);
  std::filesystem::remove(copy / "image.exr");
  const double floats = compared("base", "samples")["picture"]["psnr_db"],
               bytes = compared("base", "copy")["picture"]["psnr_db"];
  EXPECT_NEAR(floats, bytes, 0.2);
  EXPECT_NE(floats, bytes);
  std::filesystem::create_symlink("image.exr", copy / "image.exr");
  EXPECT_EQ(compared("base", "copy")["picture"]["why_not"],
            (copy / "image.exr").string() + ": Too many levels of symbolic links");
  std::filesystem::remove(copy / "image.exr");
  std::filesystem::remove(copy / "image.png");
  EXPECT_SAYS(compared("base", "copy")["picture"]["why_not"].get<std::string>(), "not both");
  folder.write("copy/image.png", "no picture");
  EXPECT_SAYS(compared("base", "copy")["picture"]["why_not"].get<std::string>(), "image.png");
}

TEST_F(Runs, AppearInOneTable) {
  const std::string text = raywatt({"compare", path("base"), path("ports"), path("slow-l2")}).out;
  EXPECT_SAYS(text, "ports against base");
  EXPECT_SAYS(text, "slow-l2 against base");
  const std::string header = text.substr(0, text.find('\n'));
  for (const char* name : {"base", "ports", "slow-l2"}) EXPECT_SAYS(header, name);
}

TEST_F(Runs, MayBeOfOtherModelsInterruptedOrOlder) {
  const auto warned = [&](const std::string& other, const std::string& why) {
    const ProcessResult ending = raywatt({"compare", path("base"), other});
    EXPECT_EQ(ending.exit, 0) << ending.err;
    EXPECT_SAYS(ending.err, why);
  };
  warned(changed("other.json", [](Json& report) { report["provenance"]["model_id"] = "another"; }), "model_id");
  warned(changed("partial.json", [](Json& report) { report["partial"] = true; }), "was interrupted");
  warned(changed("old.json",
                 [](Json& report) {
                   report["totals"].erase("energy_by_event_mj");
                   report["totals"].erase("top_down");
                   report.erase("units");
                 }),
         "");
}

TEST_F(Runs, RefuseFilesThatAreNoReports) {
  const auto refused = [&](const std::string& other, const Words& parts) {
    expect_refusal(raywatt({"compare", path("base"), other}), parts);
    expect_refusal(raywatt({"compare", other, path("base"), "--json"}), parts);
  };
  refused((folder.path() / "nowhere").string(), {"nowhere"});
  refused(folder.path().string(), {"report.json"});
  refused(changed("verify.json", [](Json& report) { report["schema"] = "raywatt-verify/1"; }),
          {"verify.json", "schema 'raywatt-verify/1'", "raywatt-report/1"});
  refused(changed("future.json", [](Json& report) { report["schema"] = "raywatt-report/2"; }), {"raywatt-report/2"});
  refused(changed("none.json", [](Json& report) { report.erase("totals"); }), {"totals.cycles"});
  refused(folder.write("list.json", "[]").string(), {"no 'schema'"});
  refused(folder.write("odd.json", R"({"schema": {}})").string(), {"schema"});
  refused(folder.write("broken.json", R"({"schema": "raywatt-report/1")").string(), {"not JSON"});
  refused(folder
              .write("deep.json", R"({"schema": "raywatt-report/1", "units": )" + std::string(100000, '[') +
                                      std::string(100000, ']') + "}")
              .string(),
          {"nested"});
  expect_refusal(raywatt({"compare", path("base")}), {"runs"});
}

TEST_F(Runs, SurviveReportsOfStrangeShape) {
  for (const char* text : {R"({"schema": "raywatt-report/1", "totals": {"cycles": 0}})",
                           R"({"schema": "raywatt-report/1", "totals": {"cycles": 5, "rays": 7, "top_down": []},
                               "units": {"core0": 3}, "config": [], "scene": "none", "provenance": 1, "frames": {}})",
                           R"({"schema": "raywatt-report/1", "totals": {"cycles": 1e308}, "program": 7, "partial": "x",
                               "units": {"l2": {"bank0": {"elapsed": 0, "why": {"idle": 1}}}}, "resolution": {}})"}) {
    const std::string odd = folder.write("odd.json", text).string();
    EXPECT_EQ(raywatt({"compare", path("base"), odd}).exit, 0) << text;
    EXPECT_EQ(raywatt({"compare", odd, path("base"), odd, "--json"}).exit, 0) << text;
  }
}

// Tests of differences between runs and their noise.

TEST_F(Runs, UseTheAssumedNoiseWithoutReplicates) {
  const Json c = compared("base", "ports");
  const Json& noise = c["figures"]["cycles"]["noise"];
  EXPECT_EQ(noise["from"], "default");
  EXPECT_NEAR(noise["half_width"].get<double>(), 0.25, 0.025);
  EXPECT_EQ(noise["outside"], std::abs(noise["difference"].get<double>()) > noise["half_width"].get<double>());
  EXPECT_FALSE(c["figures"]["rays"].contains("noise")) << "rays are counted, whatever races there are";
  EXPECT_SAYS(raywatt({"compare", path("base"), path("ports")}).out,
              "noise: assumed for this size of picture; --replicates 5");
}

TEST_F(Runs, UseTheLargerNoiseIfOneHasReplicates) {
  const std::string noisy = changed("noisy.json", [](Json& report) {
    const double cycles = report["totals"]["cycles"];
    report["totals"]["replicates"] = {{"count", 4},
                                      {"figures", {{"cycles", {{"mean", cycles}, {"deviation", 0.2 * cycles}}}}}};
  });
  const Json one = Json::parse(raywatt({"compare", noisy, path("ports"), "--json"}).out);
  const Json noise = one["against"][0]["figures"]["cycles"]["noise"];
  EXPECT_EQ(noise["from"], "default");
  // Noise of the mean of four replicates, and of one replicate with the same deviation.
  EXPECT_NEAR(noise["half_width"].get<double>(), 1.96 * 0.2 * std::hypot(0.5, 1), 0.05);
  EXPECT_SAYS(raywatt({"compare", noisy, path("ports")}).out, "or of one run's replicates if larger; --replicates 5");
  const std::string tripled = changed("tripled.json", [](Json& report) {
    const double cycles = report["totals"]["cycles"];
    report["totals"]["replicates"] = {{"count", 4},
                                      {"figures", {{"cycles", {{"mean", 3 * cycles}, {"deviation", cycles}}}}}};
  });
  EXPECT_SAYS(raywatt({"compare", path("base"), tripled}).out, "=  mean x3 ± ") << "whatever the first plays say";
}

TEST_F(Runs, WithOtherClocksHaveNoVerdictOnCycles) {
  const std::string slow = changed("slow.json", [](Json& report) { report["config"]["clocks"]["tni"] = "400 MHz"; });
  const ProcessResult ending = raywatt({"compare", path("base"), slow});
  EXPECT_SAYS(ending.err, "have different T&I clocks (clocks.tni): compare times, not cycles");
  EXPECT_SAYS(ending.out, "another clock");
  const Json c = Json::parse(raywatt({"compare", path("base"), slow, "--json"}).out)["against"][0];
  EXPECT_FALSE(c["figures"]["cycles"].contains("noise"));
  EXPECT_TRUE(c["figures"]["time_ms"].contains("noise"));
}

TEST_F(Runs, AreSimulatedAgainForTheirNoise) {
  const ProcessResult ending = raywatt({"compare", path("base"), path("ports"), "--replicates", "3", "--json"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const Json cycles = Json::parse(ending.out)["against"][0]["figures"]["cycles"];
  EXPECT_EQ(cycles["noise"]["from"], "replicates");
  const Json plain = compared("base", "ports")["figures"]["cycles"];
  EXPECT_EQ(cycles["a"], plain["a"]) << "figures stay those of the runs";
  EXPECT_NE(cycles["noise"]["half_width"], plain["noise"]["half_width"]);
  const std::string other = changed("other.json", [](Json& report) { report["totals"]["cycles"] = 7; });
  expect_refusal(raywatt({"compare", path("base"), other, "--replicates", "2", "--progress", "none"}),
                 {"other.json: has 7 cycles, but a repetition takes "});
}

TEST_F(Runs, UseTheirReplicatesIfBothHaveThem) {
  const auto replicated = [&](double mean) {
    return [mean](Json& report) {
      report["totals"]["replicates"] = {{"count", 5}, {"figures", {{"cycles", {{"mean", mean}, {"deviation", 2.0}}}}}};
    };
  };
  const std::string a = changed("a.json", replicated(1000)), near = changed("near.json", replicated(1001)),
                    far = changed("far.json", replicated(1010));
  const auto noise = [&](const std::string& b) {
    return Json::parse(raywatt({"compare", a, b, "--json"}).out)["against"][0]["figures"]["cycles"]["noise"];
  };
  EXPECT_EQ(noise(near)["outside"], false);
  EXPECT_EQ(noise(far)["outside"], true);
  EXPECT_EQ(noise(far)["from"], "replicates");
  EXPECT_NEAR(noise(far)["difference"].get<double>(), 0.01, 1e-12);
  EXPECT_NEAR(noise(far)["half_width"].get<double>(), 2.306004 * std::sqrt(8.0 / 5) / 1000,
              1e-8);  // Student's t with eight degrees of freedom
  EXPECT_SAYS(raywatt({"compare", a, far}).out, "mean +1.00 % ± 0.29 %, outside");
  EXPECT_SAYS(raywatt({"compare", path("base"), path("ports")}).out,
              "The difference itself is within run-to-run noise.")
      << "a draw's interval knows nothing of the noise";
}

// Comparisons of two machines on several workloads.

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
