#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tools/analysis/picture.h"
#include "traces/scene/images.h"

// Tests of `run --reference` and `verify`, which compare with a second run and with Embree.

namespace test {
namespace {

using Json = nlohmann::json;

const Words kRelatives = {"speedup",           "traversal_steps",   "dram_bytes", "tni_power",
                          "tni_perf_per_watt", "gpu_perf_per_watt", "rays"};

TEST(Reference, AgainstItselfEveryRatioIsOneAndThePicturesAreIdentical) {
  const TempFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  const ProcessResult ending = raywatt(small_run(out, {"--reference", "full:1"}));
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const Json totals = read_json(out / "report.json")["totals"];
  EXPECT_EQ(totals["identical"], true);
  EXPECT_TRUE(totals["psnr_db"].is_null());
  for (const std::string& name : kRelatives) EXPECT_EQ(totals["relative"][name], 1) << name;
  EXPECT_EQ(read_bytes(out / "reference.exr"), read_bytes(out / "image.exr"));
  EXPECT_SAYS(ending.out, "against reference");
  EXPECT_SAYS(ending.out, "identical");
  EXPECT_EQ(totals["reference"]["cycles"], totals["cycles"]);
  EXPECT_EQ(totals["reference"]["top_down"], totals["top_down"]["gpu"]);
  EXPECT_SAYS(ending.out, "reference's time");
}

TEST(Reference, OfFourTimesTheSamplesCostsMoreAndLooksAlmostTheSame) {
  const TempFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  const ProcessResult ending = raywatt(small_run(out, {"--reference", "full:4"}));
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const Json totals = read_json(out / "report.json")["totals"];
  EXPECT_EQ(totals["identical"], false);
  EXPECT_GT(totals["psnr_db"], 20);
  EXPECT_LT(totals["psnr_db"], 60);
  EXPECT_NEAR(totals["relative"]["rays"], 0.25, 0.02);
  EXPECT_NEAR(totals["relative"]["traversal_steps"], 0.25, 0.02);
  EXPECT_GT(totals["relative"]["speedup"], 1.5);
  EXPECT_GT(totals["relative"]["gpu_perf_per_watt"], 1.5);
  EXPECT_GT(totals["relative"]["tni_perf_per_watt"], 1.5);
  EXPECT_NE(read_bytes(out / "reference.exr"), read_bytes(out / "image.exr"));
}

// Foliage smaller than a pixel: three passes over a tile read its lines three times (docs/adaptive.md, When it loses).
TEST(Reference, NamesWhatGrewWhereLessWorkTakesMoreTime) {
  const TempFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  const Words words = {"run",         "--scene", "forest", "--resolution", "128x64", "--program", "multirate:under",
                       "--reference", "full:1",  "-o",     out.string()};
  const ProcessResult ending = raywatt(words);
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const Json totals = read_json(out / "report.json")["totals"], full = read_json(out / "reference.json")["totals"];
  const Json& relative = totals["relative"];
  EXPECT_LT(relative["traversal_steps"], 0.8);
  EXPECT_LT(relative["speedup"], 0.9);
  EXPECT_GT(relative["dram_bytes"], 1.3);
  EXPECT_DOUBLE_EQ(relative["dram_bytes"].get<double>(),
                   totals["dram_bytes"].get<double>() / full["dram_bytes"].get<double>());
  EXPECT_SAYS(ending.out, "slower because        tree misses take ");
}

TEST(Reference, NamesNothingWhereLessWorkTakesLessTimeOrMoreWorkTakesMore) {
  const TempFolder folder;
  const ProcessResult faster = raywatt(small_run(folder.path() / "faster", {"--reference", "full:4"}));
  EXPECT_EQ(faster.out.find("slower because"), std::string::npos) << faster.out;
  const ProcessResult larger =
      raywatt(small_run(folder.path() / "larger", {"--program", "full:4", "--reference", "full:1"}));
  ASSERT_EQ(larger.exit, 0) << larger.err;
  EXPECT_EQ(larger.out.find("slower because"), std::string::npos) << larger.out;
}

TEST(Reference, KeepsItsOwnReportWhichIsThatOfTheProgramAlone) {
  const TempFolder folder;
  const std::filesystem::path out = folder.path() / "out", alone = folder.path() / "alone";
  const Words more = {"--program", "multirate:under", "--reference", "full:1", "--replicates", "2"};
  const ProcessResult ending = raywatt(small_run(out, more));
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "raywatt compare " + (out / "reference.json").string());
  ASSERT_EQ(raywatt(small_run(alone, {"--replicates", "2"})).exit, 0);
  const Json own = read_json(out / "reference.json"), run = read_json(alone / "report.json");
  for (const char* part :
       {"schema", "partial", "program", "config", "scene", "warnings", "totals", "frames", "units"}) {
    EXPECT_EQ(own[part], run[part]) << part;
  }
  EXPECT_EQ(read_bytes(out / "reference.png"), read_bytes(alone / "image.png"));
  EXPECT_EQ(read_bytes(out / "reference-tiles.json"), read_bytes(alone / "tiles.json"));
  EXPECT_NE(read_bytes(out / "difference.png"), read_bytes(out / "reference.png"));
}

TEST(Reference, StatesTheFullEffectRateThatItIsPlayedAt) {
  const TempFolder folder;
  const std::filesystem::path out = folder.path() / "out", alone = folder.path() / "alone";
  const auto small = [](const std::filesystem::path& to, const Words& more) {
    Words words = {"run", "--resolution", "16x16", "--set", "render.effects=occlusion", "-o", to.string(), "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return raywatt(words).exit;
  };
  ASSERT_EQ(small(out, {"--set", "render.effect_rate=half", "--reference", "full:1"}), 0);
  ASSERT_EQ(small(alone, {}), 0);
  EXPECT_EQ(read_json(out / "report.json")["config"]["render"]["effect_rate"], "half");
  const Json own = read_json(out / "reference.json"), run = read_json(alone / "report.json");
  for (const char* part : {"config", "totals", "units"}) EXPECT_EQ(own[part], run[part]) << part;
  EXPECT_EQ(own["provenance"]["config_hash"], run["provenance"]["config_hash"]);
}

TEST(Reference, ComparedWithItsRunExplainsTheGain) {
  const TempFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out, {"--program", "multirate:under", "--reference", "full:1"})).exit, 0);
  const ProcessResult compared = raywatt({"compare", (out / "reference.json").string(), out.string(), "--json"});
  ASSERT_EQ(compared.exit, 0) << compared.err;
  const Json against = Json::parse(compared.out)["against"][0], totals = read_json(out / "report.json")["totals"];
  EXPECT_EQ(against["figures"]["cycles"]["a"], totals["reference"]["cycles"]);
  EXPECT_EQ(against["figures"]["cycles"]["b"], totals["cycles"]);
  EXPECT_FALSE(against["time"].empty());
  EXPECT_NEAR(against["picture"]["psnr_db"].get<double>(), totals["psnr_db"].get<double>(), 1e-9)
      << "the reference's picture, not the run's twice";
}

TEST(Reference, IsComparedByACommandThatAShellTakes) {
  const TempFolder folder;
  const std::string out = (folder.path() / "two words").string();
  const ProcessResult ending = raywatt({"run", "--resolution", "16x16", "-o", out, "--reference", "full:1"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "compare with: raywatt compare '" + out + "/reference.json' '" + out + "/report.json'");
}

TEST(Reference, OfAFormerRunGoesWithIt) {
  const TempFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out, {"--reference", "full:4"})).exit, 0);
  ASSERT_EQ(raywatt(small_run(out)).exit, 0);
  for (const char* name :
       {"reference.json", "reference-tiles.json", "reference.png", "difference.png", "reference.exr"}) {
    EXPECT_FALSE(std::filesystem::exists(out / name)) << name;
  }
}

const Words kMoving = {"--scene", "chess", "--set", "scene.triangles=2000"};

Json report_of_moving(const std::filesystem::path& out, const Words& more) {
  Words words = small_run(out, kMoving);
  words.insert(words.end(), more.begin(), more.end());
  const ProcessResult ending = raywatt(words);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return read_json(out / "report.json");
}

/// Returns the differences of the sRGB values of a run's picture and its reference picture.
std::vector<double> differences_in(const std::filesystem::path& run) {
  const std::vector<float> a = traces::read_exr(run / "image.exr").rgb, b = traces::read_exr(run / "reference.exr").rgb;
  std::vector<double> out;
  for (std::size_t i = 0; i < a.size(); ++i) {
    out.push_back(static_cast<double>(tools::srgb_encoded(a[i])) - static_cast<double>(tools::srgb_encoded(b[i])));
  }
  return out;
}

TEST(Reference, OfAnAnimationMeasuresTheChangesOfItsPictures) {
  const TempFolder folder;
  const Words programs = {"--program", "multirate:under", "--reference", "full:1", "--frames"};
  const auto run = [&](const std::string& frames) {
    Words more = programs;
    more.push_back(frames);
    return report_of_moving(folder.path() / frames, more);
  };
  const Json report = run("20:22"), &frames = report["frames"], &totals = report["totals"];
  EXPECT_FALSE(frames[0].contains("temporal_psnr_db"));
  std::vector<std::vector<double>> differences;
  for (const char* frame : {"20", "21", "22"}) {
    const Json alone = run(frame)["totals"];
    EXPECT_FALSE(alone.contains("temporal_psnr_db"));
    EXPECT_FALSE(alone.contains("worst_psnr_db"));
    differences.push_back(differences_in(folder.path() / frame));
  }
  for (std::size_t f = 1; f < 3; ++f) {
    double squares = 0;
    for (std::size_t i = 0; i < differences[f].size(); ++i)
      squares += std::pow(differences[f][i] - differences[f - 1][i], 2);
    EXPECT_NEAR(frames[f]["temporal_psnr_db"], -10 * std::log10(squares / static_cast<double>(differences[f].size())),
                1e-3);
  }
  EXPECT_EQ(totals["temporal_psnr_db"], std::min(frames[1]["temporal_psnr_db"], frames[2]["temporal_psnr_db"]));
  const auto by_psnr = [](const Json& a, const Json& b) { return a["psnr_db"] < b["psnr_db"]; };
  EXPECT_EQ(totals["worst_psnr_db"], (*std::ranges::min_element(frames, by_psnr))["psnr_db"]);
  EXPECT_SAYS(read_bytes(folder.path() / "20:22/report.txt"), "in the worst frame");
}

TEST(Reference, OfAnAnimationThatIsItselfHasNoFalseChange) {
  const TempFolder folder;
  const Json totals = report_of_moving(folder.path() / "out",
                                       {"--program", "full:1", "--reference", "full:1", "--frames", "20:21"})["totals"];
  ASSERT_TRUE(totals.contains("temporal_psnr_db"));
  EXPECT_TRUE(totals["temporal_psnr_db"].is_null());
  EXPECT_TRUE(totals["worst_psnr_db"].is_null());
}

TEST(Reference, OfAnAnimationWithoutOneNothingIsMeasured) {
  const TempFolder folder;
  EXPECT_FALSE(report_of_moving(folder.path() / "out", {"--frames", "20:21"})["totals"].contains("temporal_psnr_db"));
}

TEST(Reference, WithoutOneThereIsNothingRelative) {
  const TempFolder folder;
  ASSERT_EQ(raywatt(small_run(folder.path() / "out")).exit, 0);
  const Json totals = read_json(folder.path() / "out" / "report.json")["totals"];
  for (const char* name : {"psnr_db", "identical", "relative", "reference"})
    EXPECT_FALSE(totals.contains(name)) << name;
}

TEST(Verify, CornellHasNoRayThatEmbreeSeesOtherwise) {
  const TempFolder folder;
  const std::filesystem::path out = folder.path() / "out";
  const ProcessResult ending = raywatt({"verify", "--resolution", "64x32", "--threads", "2", "-o", out.string()});
  ASSERT_EQ(ending.exit, 0) << ending.out << ending.err;
  EXPECT_SAYS(ending.out, "0 missing hits, 0 extra hits, 0 distance errors");
  const Json verdict = read_json(out / "verify.json");
  EXPECT_EQ(verdict["schema"], "raywatt-verify/1");
  EXPECT_GT(verdict["rays"], 64 * 32) << "secondary rays too";
  for (const char* fault : {"missing_hits", "extra_hits", "distance_errors"}) EXPECT_EQ(verdict[fault], 0) << fault;
  EXPECT_LE(verdict["edge_ties"], 1);
  ASSERT_TRUE(verdict.contains("psnr_db"));
  ASSERT_TRUE(verdict["identical"].is_boolean());
  EXPECT_EQ(verdict["psnr_db"].is_null(), verdict["identical"].get<bool>());
  EXPECT_TRUE(verdict["identical"] || verdict["psnr_db"] >= 55) << verdict["psnr_db"];
  EXPECT_EQ(verdict["provenance"]["argv"][1], "verify");
  EXPECT_EQ(names_in(out), (Words{"embree.png", "image.png", "verify.json"}));
}

TEST(Verify, ComparesEveryRayOfTheRun) {
  const TempFolder folder;
  ASSERT_EQ(raywatt(small_run(folder.path() / "run", {"--scene", "teapot"})).exit, 0);
  ASSERT_EQ(raywatt({"verify", "--scene", "teapot", "--resolution", "64x32", "--quiet", "-o",
                     (folder.path() / "verify").string()})
                .exit,
            0);
  EXPECT_EQ(read_json(folder.path() / "verify" / "verify.json")["rays"],
            read_json(folder.path() / "run" / "report.json")["totals"]["rays"]["total"]);
  EXPECT_EQ(read_bytes(folder.path() / "verify" / "image.png"), read_bytes(folder.path() / "run" / "image.png"));
}

TEST(Verify, HasNoIdealResources) { expect_refusal(raywatt({"verify", "--ideal", "l1"}), {"--ideal"}); }

TEST(Verify, TakesTheFolderOfAFormerVerdictButNotOfARun) {
  const TempFolder folder;
  const Words run = {"run", "--resolution", "16x16", "-o", (folder.path() / "run").string()};
  const Words verify = {"verify", "--resolution", "16x16", "-o", (folder.path() / "verdict").string()};
  const Words onto_run = {"verify", "--resolution", "16x16", "-o", (folder.path() / "run").string()};
  EXPECT_EQ(raywatt(run).exit, 0);
  EXPECT_EQ(raywatt(verify).exit, 0);
  EXPECT_EQ(raywatt(verify).exit, 0);
  expect_refusal(raywatt(onto_run), {"holds files but no verify.json of a former run"});
}

}  // namespace
}  // namespace test
