#include "tools/studies/sweep/results/energy_band.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tools/studies/sweep/small_sweep.h"
#include "tools/studies/sweep/results/best.h"

// Tests of sweeps whose points are priced by random draws of the energy tables.

namespace test {
namespace {

using namespace tools::results;

const std::vector<std::size_t> kAll = {0, 1, 2, 3};

/// A simulated sweep of four points.
struct BandOfASweep : testing::Test {
  BandOfASweep() {
    const auto file = write_sweep(folder, "axes: {cores: [1, 2], tni.trv.l1.size: [8 KiB, 32 KiB]}\n");
    const ProcessResult ending = raywatt(sweep_run(folder, file));
    EXPECT_EQ(ending.exit, 0) << ending.err;
  }
  std::string ask(const std::string& verb, const Words& more) const {
    Words words = {"sweep", verb, (folder.path() / "out").string()};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult ending = raywatt(words);
    EXPECT_EQ(ending.exit, 0) << ending.err;
    return ending.out;
  }
  TempFolder folder;
};

TEST_F(BandOfASweep, HasTheNominalFigureTimesTheDrawsEnergyOverTheNominal) {
  const Results results(folder.path() / "out");
  EnergyBand band(results, kAll);
  const BandedMetric mj = band.price_metric(results, results.column("energy_mj.nominal"), false, kAll);
  const BandedMetric per_joule = band.price_metric(results, results.column("perf.frames_per_joule_gpu"), true, kAll);
  const BandedMetric cycles = band.price_metric(results, results.column("cycles"), false, kAll);
  ASSERT_EQ(mj.rows.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    tools::PricedRun run(tools::load_report(results.folder_of(results.rows()[mj.rows[i]])));
    const std::vector<double> pj = tools::energy_by_draw_pj(run, "");
    for (std::size_t d = 0; d < pj.size(); d += 97) {
      EXPECT_NEAR(mj.drawn[i][d] / (pj[d] * 1e-9), 1, 1e-12);
      EXPECT_NEAR(per_joule.drawn[i][d] * mj.drawn[i][d] / 1000, 1, 1e-12);
      EXPECT_EQ(cycles.drawn[i][d], cycles.nominal[i]);
    }
  }
}

TEST_F(BandOfASweep, RatiosAreThoseOfTheLowNominalAndHighTables) {
  const Results results(folder.path() / "out");
  EnergyBand band(results, kAll);
  const BandedMetric per_joule = band.price_metric(results, results.column("perf.frames_per_joule_gpu"), true, kAll);
  const tools::results::Column low = results.column("energy_mj.low"), nominal = results.column("energy_mj.nominal"),
                               high = results.column("energy_mj.high");
  const auto ratio = [&](const tools::results::Column& mj) {  // for frames per joule low and high are exchanged
    return magnitude_of(mj.values[per_joule.rows[0]])->value / magnitude_of(mj.values[per_joule.rows[2]])->value;
  };
  EXPECT_EQ(per_joule.ratio_text(2, 0),
            fmt::format("{:.3f} / {:.3f} / {:.3f}", ratio(low), ratio(nominal), ratio(high)));
}

TEST_F(BandOfASweep, SharesOnTheFrontAreThoseOfTheDrawsFronts) {
  const Results results(folder.path() / "out");
  EnergyBand band(results, kAll);
  const BandedMetric x = band.price_metric(results, results.column("energy_mj.nominal"), false, kAll);
  const BandedMetric y = band.price_metric(results, results.column("cycles"), false, kAll);
  const std::vector<double> shares = EnergyBand::shares_on_front(x, y);
  for (std::size_t i = 0; i < x.rows.size(); ++i) {
    double wanted = 0;
    for (std::size_t d = 0; d < tools::kEnergyDraws; ++d) {
      bool beaten = false;
      for (std::size_t k = 0; k < x.rows.size(); ++k) {
        const double dx = x.drawn[k][d] - x.drawn[i][d], dy = y.drawn[k][d] - y.drawn[i][d];
        beaten = beaten || (dx <= 0 && dy <= 0 && (dx < 0 || dy < 0));
      }
      wanted += beaten ? 0 : 1;
    }
    EXPECT_NEAR(shares[i], wanted / static_cast<double>(tools::kEnergyDraws), 1e-9) << i;
  }
}

TEST_F(BandOfASweep, IsToldByBestParetoAndSensitivity) {
  const std::string best = ask("best", {"--min", "energy_mj.nominal", "--energy", "band"});
  EXPECT_SAYS(best, "under 2000 draws of the energy tables, 4 points");
  EXPECT_SAYS(best, "best in");
  EXPECT_SAYS(best, "over the best, low / nominal / high tables");
  EXPECT_SAYS(best, "the draws vary the energy tables only; they do not include noise\n");
  EXPECT_EQ(ask("best", {"--min", "energy_mj.nominal"}),
            ask("best", {"--min", "energy_mj.nominal", "--energy", "nominal"}));
  const Words pareto = {"--x", "energy_mj.nominal", "--y", "fps", "--energy", "band"};
  EXPECT_SAYS(ask("pareto", pareto), "on the front in");
  EXPECT_SAYS(ask("pareto", pareto), " % ") << "shares as people read them";
  EXPECT_SAYS(ask("pareto", pareto), "energy_mj.nominal over the best, low / nominal / high tables");
  EXPECT_SAYS(ask("pareto", pareto), "1.000 / 1.000 / 1.000") << "the best over itself";
  const std::string tornado = ask("sensitivity", {"--metric", "energy_mj.nominal", "--energy", "band"});
  EXPECT_SAYS(tornado, "pairs turned");
  EXPECT_EQ(tornado.find("draws"), std::string::npos) << "it draws nothing";
  EXPECT_SAYS(tornado, "energy.");
  const std::string out = (folder.path() / "out").string();
  expect_refusal(raywatt({"sweep", "pareto", out, "--x", "cycles", "--y", "fps", "--energy", "band"}), {"depends on the energy tables"});
  expect_refusal(raywatt({"sweep", "sensitivity", out, "--metric", "cycles", "--energy", "band"}), {"depends on the energy tables"});
  expect_refusal(raywatt({"sweep", "best", out, "--min", "cycles", "--energy", "band"}),
                 {"cycles does not depend on the energy tables; allowed: energy_mj.nominal"});
  expect_refusal(raywatt({"sweep", "best", out, "--min", "cycles", "--energy", "all"}), {"--energy"});
}

}  // namespace
}  // namespace test
