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

// Tests of the machine's area in reports, in sweeps, and in conditions of sweeps.

double sum_of(const Json& spreads) {
  double sum = 0;
  for (const Json& s : spreads) sum += s["nominal"].get<double>();
  return sum;
}

TEST(AreaOfARun, SumsByBlockAndByPartAndDividesWhatTheFrameGives) {
  const TempFolder folder;
  const auto out = simulate_into_folder(folder.path() / "a");
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
  const Json a = read_json(simulate_into_folder(folder.path() / "a") / "report.json")["totals"];
  const auto out = simulate_into_folder(folder.path() / "b", {"--set", "area.extends=area/7nm"});
  const Json b = read_json(out / "report.json")["totals"];
  EXPECT_LT(b["area_mm2"].get<double>(), 0.7 * a["area_mm2"].get<double>());
  EXPECT_EQ(a["cycles"], b["cycles"]);
  EXPECT_EQ(a["energy_mj"], b["energy_mj"]);
  const auto warned = [](const std::filesystem::path& run) {
    return read_json(run / "report.json")["warnings"].dump().find("results mix processes") != std::string::npos;
  };
  EXPECT_FALSE(warned(folder.path() / "a"));
  EXPECT_TRUE(warned(out));
  const Words same = {"--set", "energy.process=14nm, 0.8 V"};
  EXPECT_FALSE(warned(simulate_into_folder(folder.path() / "c", same))) << "blanks do not make a process another";
  EXPECT_EQ(a["extrapolated"], 0);
  EXPECT_EQ(b["extrapolated"], 1) << "tables of two processes";
}

TEST(AreaOfARun, OfABlockThatTheTableDoesNotKnowIsRefused) {
  const TempFolder folder;
  const auto run_with = [&](const std::string& arrays) {
    const auto file = folder.write("c.yaml",
                                   "energy: {extends: energy/14nm}\ndram: {extends: dram/lpddr4-3200}\n"
                                   "area: {buffers: {tni: 1, srp: 1}, arrays: {" +
                                       arrays + "}}\n");
    return raywatt({"run", file.string(), "--resolution", "16x16", "--quiet", "-o", (folder.path() / "x").string()});
  };
  const ProcessResult known = run_with("tni: 1, srp: 1, tile_buffer: 1, l2: 1");
  EXPECT_EQ(known.exit, 0) << known.err;
  expect_refusal(run_with("tni: 1, srp: 1, tile_buffer: 1"),
                 {"area.arrays: no entry for unit 'l2.bank0'; allowed: 'l2.bank' or 'l2'"});
  expect_refusal(run_with("tni: 1, tni@8KiB: 1"), {"area.arrays.tni", "with and without a size"});
}

/// Nominal area of logic and pads in mm2, and leakage power, of a run with these settings.
struct Built {
  double logic, pads, leakage_w;
};
Built built(const TempFolder& folder, const Words& sets) {
  Words words;
  for (const std::string& set : sets) words.insert(words.end(), {"--set", set});
  static int runs = 0;
  const Json t =
      read_json(simulate_into_folder(folder.path() / std::to_string(++runs), words) / "report.json")["totals"];
  const auto parts = t["area_by_part_mm2"];
  return {parts["logic"]["nominal"].get<double>(), parts["pads"]["nominal"].get<double>(),
          t["energy_by_kind_mj"]["leakage"]["nominal"].get<double>() / t["time_ms"].get<double>()};
}

TEST(AreaOfARun, FollowsTheNumberOfFunctionalUnitsAndBoxTesters) {
  const TempFolder folder;
  const Built plain = built(folder, {});
  // Four cores with sixteen more units, fifteen fewer multipliers, three fewer dividers.
  EXPECT_NEAR(built(folder, {"srp.array.rows=8"}).logic - plain.logic, 4 * 16 * 0.0151, 1e-9);
  EXPECT_NEAR(built(folder, {"srp.array.mul_units=1"}).logic - plain.logic, -4 * 15 * 0.0081, 1e-9);
  EXPECT_NEAR(built(folder, {"srp.array.div_sqrt_units=1"}).logic - plain.logic, -4 * 3 * 0.0322, 1e-9);
  EXPECT_NEAR(built(folder, {"srp.array.mul_add=true"}).logic - plain.logic, 4 * 16 * 0.0009, 1e-9);
  EXPECT_NEAR(built(folder, {"tni.trv.box_testers=1"}).logic - plain.logic, -16 * 0.0363, 1e-9);
  // At 7 nm the same parts take 0.36 of the area.
  EXPECT_NEAR(built(folder, {"area.extends=7nm", "srp.array.rows=8"}).logic, 0.36 * (plain.logic + 4 * 16 * 0.0151),
              1e-9);
}

TEST(AreaOfARun, LeaksByTheSameLogic) {
  const TempFolder folder;
  const auto leakage = [&](Words sets) {
    const Built with = (sets.emplace_back("energy.logic_leakage=15"), built(folder, sets));
    sets.back() = "energy.logic_leakage=0";
    return with.leakage_w - built(folder, sets).leakage_w;
  };
  EXPECT_NEAR(leakage({"srp.array.rows=8"}) - leakage({}), 4 * 16 * 0.0151 * 0.015, 1e-9) << "15 mW/mm2, in W";
}

TEST(AreaOfARun, HasPadsByTheDataLinesOfItsMemory) {
  const TempFolder folder;
  EXPECT_DOUBLE_EQ(built(folder, {}).pads, 4) << "four channels of 16";
  EXPECT_DOUBLE_EQ(built(folder, {"dram.extends=lpddr3-1600"}).pads, 4) << "two channels of 32";
}

TEST(AreaOfASweep, IsAColumnAndACondition) {
  const TempFolder folder;
  const auto file = write_sweep(folder, "axes: {cores: [1, 2]}\n");
  ASSERT_EQ(raywatt(sweep_run(folder, file)).exit, 0);
  const std::string out = (folder.path() / "out").string();
  const ProcessResult table = raywatt({"sweep", "table", out, "--csv", "--columns", "cores,area_mm2"});
  ASSERT_EQ(table.exit, 0) << table.err;
  const double small = std::stod(table.out.substr(table.out.find("\n1,") + 3));
  const double large = std::stod(table.out.substr(table.out.find("\n2,") + 3));
  EXPECT_LT(small, large);
  const std::string limit = "area_mm2<=" + std::to_string((small + large) / 2);
  const ProcessResult met = raywatt({"sweep", "table", out, "--csv", "--columns", "cores", "--where", limit});
  EXPECT_EQ(met.out, "cores\n1\n");
  EXPECT_EQ(raywatt({"sweep", "best", out, "--max", "frames_per_joule_per_mm2", "--energy", "band"}).exit, 0);
}

}  // namespace
}  // namespace test
