#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/pricing/two_designs.h"
#include "tests/tools/studies/sweep/small_sweep.h"

// Tests of the machine's area in reports, in sweeps, and in conditions of sweeps.

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
