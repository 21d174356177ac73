#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/pricing/two_designs.h"
#include "tests/tools/studies/sweep/small_sweep.h"

// Tests of `raywatt energy`: printing tables, and pricing runs and sweeps.

namespace test {
namespace {

using Json = nlohmann::json;

TEST(EnergyShow, HasBandUnitSourceAndCounters) {
  const std::string text = output_of({"energy", "show", "tni.box_test"});
  EXPECT_SAYS(text, "7.9 / 24 / 50 pJ");
  EXPECT_SAYS(text, "computed, one AABB");
  EXPECT_SAYS(text, "14nm.yaml:");
  EXPECT_SAYS(text, "counted by core.tni.trv ");
  EXPECT_EQ(text.find("box_test_hybrid"), std::string::npos);
}

TEST(EnergyShow, HasTheCurveOverSize) {
  const std::string text = output_of({"energy", "show", "cache.l1_read"});
  EXPECT_SAYS(text, "@16KiB: 5 / 7.8 / 16 pJ");
  EXPECT_SAYS(text, ", 0.30 from 16 KiB to 32 KiB, ");
  EXPECT_SAYS(text, "counted by core.srp ");
}

TEST(EnergyShow, ShowsValuesOfTheCommandLine) {
  const std::string text = output_of({"energy", "show", "tni.box_test", "--set", "energy.events.tni.box_test=48"});
  EXPECT_SAYS(text, "48 pJ  (no band)");
  EXPECT_SAYS(text, "--set energy.events.tni.box_test=48");
}

TEST(EnergyShow, ShowsMappingsOfTheCommandLine) {
  const std::string set = "energy.events={tni.box_test: 48}";
  EXPECT_SAYS(output_of({"energy", "show", "tni.box_test", "--set", set}), "48 pJ  (no band)\n    --set " + set);
}

TEST(EnergyShow, ShowsLogicAndMemoryAndAll) {
  EXPECT_SAYS(output_of({"energy", "show", "logic.tni.trv"}), "16 units core.tni.trv");
  EXPECT_SAYS(output_of({"energy", "show", "parts.tni.trv.box_tester"}), "16 units core.tni.trv, each with 2");
  EXPECT_SAYS(output_of({"energy", "show", "dram.energy.phy"}), "counted by dram");
  const std::string all = output_of({"energy", "show"});
  for (const char* entry : {"tni.box_test", "clock_share", "srp.fp_add", "dram.energy.refresh"})
    EXPECT_SAYS(all, entry);
  expect_refusal(raywatt({"energy", "show", "tni.bxo_test"}), {"tni.bxo_test", "did you mean", "tni.box_test"});
}

TEST(EnergyPrice, OfARunShowsTheBandAndEveryBlock) {
  const TempFolder folder;
  const std::string out = simulate_into_folder(folder.path() / "a").string();
  const Words words = {"energy", "price", out, "--set", "energy.events.tni.box_test.nominal=48"};
  const std::string text = output_of(words);
  EXPECT_SAYS(text, "energy.events.tni.box_test: 7.9 / 24 / 50 -> 48 without a band");
  Words as_json = words;
  as_json.emplace_back("--json");
  const Json run = Json::parse(output_of(as_json))["runs"][0];
  EXPECT_GT(run["priced"]["energy_by_block_mj"]["tni"]["nominal"], run["own"]["energy_by_block_mj"]["tni"]["nominal"]);
  EXPECT_EQ(run["priced"]["energy_by_block_mj"]["srp"], run["own"]["energy_by_block_mj"]["srp"]);
  EXPECT_EQ(run["own"]["energy_mj"], read_json(folder.path() / "a" / "report.json")["totals"]["energy_mj"]);
}

TEST(EnergyPrice, OfASweepHasALineAPoint) {
  const TempFolder folder;
  const auto file = write_sweep(folder, "axes: {cores: [1, 2]}\n");
  ASSERT_EQ(raywatt(sweep_run(folder, file)).exit, 0);
  const std::string out = (folder.path() / "out").string();
  const Json runs = Json::parse(output_of({"energy", "price", out, "--json", "--set", "energy.clock_share=0"}))["runs"];
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[1]["axes"]["cores"], "2");
  EXPECT_EQ(runs[1]["sweep"], out) << "of several sweeps each point says whose it is";
  const auto& kinds = runs[1]["priced"]["energy_by_kind_mj"];
  EXPECT_LT(kinds["clock"]["nominal"].get<double>(),
            runs[1]["own"]["energy_by_kind_mj"]["clock"]["nominal"].get<double>());
  const std::string csv = output_of({"energy", "price", out, "--csv"});
  EXPECT_SAYS(csv, "run,n,cores,own.totals.energy_mj.nominal,totals.energy_mj.low");
  EXPECT_EQ(std::ranges::count(csv, '\n'), 3);
}

TEST(EnergyPrice, OfASweepCountsPointsWithoutAResult) {
  const TempFolder folder;
  const auto file = write_sweep(folder, "axes: {cores: [1, 2, 4]}\n");
  ASSERT_EQ(raywatt(sweep_run(folder, file)).exit, 0);
  const std::string out = (folder.path() / "out").string();
  Words reports;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path() / "store" / "points")) {
    if (entry.path().filename() == "report.json") reports.push_back(entry.path().string());
  }
  ASSERT_EQ(reports.size(), 3U);
  std::filesystem::remove_all(std::filesystem::path(reports[0]).parent_path());
  std::filesystem::resize_file(reports[1], std::filesystem::file_size(reports[1]) - 1);
  const ProcessResult two_gone = raywatt({"energy", "price", out, "--json"});
  EXPECT_EQ(two_gone.exit, 0);
  EXPECT_EQ(Json::parse(two_gone.out)["runs"].size(), 1U);
  EXPECT_SAYS(two_gone.err, out + ": 2 of 3 points have no result: 1 damaged, 1 missing");
  std::filesystem::resize_file(reports[2], 1);
  expect_refusal(raywatt({"energy", "price", out}), {out, "3 of 3 points have no result: 2 damaged, 1 missing"});
}

TEST(EnergyPrice, NamesTheReplicateAndTheExtrapolations) {
  const TempFolder folder;
  const std::string out =
      simulate_into_folder(folder.path() / "a", {"--replicates", "2", "--set", "tni.trv.l1.size=512B"}).string();
  const std::string text = output_of({"energy", "price", out});
  EXPECT_SAYS(text, "priced: the first of 2 replicates");
  EXPECT_SAYS(text, "note: energy.events: the array of tni.trv has 512 B, outside ");
  const Json run = Json::parse(output_of({"energy", "price", out, "--json"}))["runs"][0];
  EXPECT_EQ(run["plays"], 2);
  EXPECT_FALSE(run["extrapolated"].empty());
  const std::string plain = output_of({"energy", "price", simulate_into_folder(folder.path() / "b").string()});
  EXPECT_EQ(plain.find("priced: the first"), std::string::npos) << plain;
  EXPECT_EQ(plain.find("note:"), std::string::npos) << plain;
}

TEST(EnergyPrice, RefusesNamesThatNoUnitGoesBy) {
  const TempFolder folder;
  const std::string out = simulate_into_folder(folder.path() / "a").string();
  expect_refusal(raywatt({"energy", "price", out, "--set", "energy.logic.tni.trvv=1"}),
                 {"energy.logic.tni.trvv: no unit goes by this name", "did you mean 'tni.trv'?"});
  expect_refusal(raywatt({"run", "--resolution", "16x16", "-o", folder.path() / "b", "--set", "area.buffers.srpp=1"}),
                 {"area.buffers.srpp: no unit goes by this name", "did you mean 'srp'?"});
  const float ray[8] = {0, 0, 0, 0, 0, 0, 1, 1};  // origin, t_min, direction, t_max
  const std::string rays = folder.write("a.rays", std::string(reinterpret_cast<const char*>(ray), sizeof ray)).string(),
                    set = "energy.events.tni.box_tset=1";
  expect_refusal(raywatt({"run", "--rays", rays, "-o", (folder.path() / "c").string(), "--set", set}),
                 {"tni.box_test"});
  expect_refusal(raywatt({"dvfs", "--resolution", "16x16", "--set", set}), {"tni.box_test"});
  expect_refusal(raywatt({"energy", "show", "--set", set}), {"tni.box_test"});
  expect_refusal(raywatt({"config", "show", "--set", "latency.arrays.raed@4KiB=1"}),
                 {"latency.arrays.raed: no latency goes by this name; allowed: read"});
}

}  // namespace
}  // namespace test
