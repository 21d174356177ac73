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

}  // namespace
}  // namespace test
