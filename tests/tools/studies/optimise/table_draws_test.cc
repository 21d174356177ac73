
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "sim/hash.h"
#include "tests/full_size.h"
#include "tests/tools/program.h"
#include "tools/pricing/energy_study.h"
#include "tools/studies/optimise/evaluation.h"

// Probabilities that machines meet limits, by noise and the bands of the tables.

namespace test {
namespace {

using namespace tools;
using namespace tools::optimise;

TEST(MetricUncertainty, QuantilesOfNoiseAloneAreNormal) {
  const MetricUncertainty spread{{100, Draws{4, 100, 2}, 0}, {}};
  EXPECT_NEAR(spread.quantile(0.5), 100, 1e-6);
  EXPECT_NEAR(spread.quantile(0.975), 100 + 1.959964, 1e-4);
  EXPECT_NEAR(spread.quantile(0.1), 100 - 1.281552, 1e-4);
  EXPECT_EQ((MetricUncertainty{{7, {}, 0}, {}}.quantile(0.9)), 7);
}

TEST(MetricUncertainty, QuantilesOfTablesAloneAreThoseOfTheFactors) {
  MetricUncertainty spread{{10, {}, 0}, {}};
  for (int i = 1; i <= 100; ++i) spread.factors.push_back(0.01 * i);
  EXPECT_NEAR(spread.quantile(0.9), 9, 0.11);
  EXPECT_NEAR(spread.quantile(0.5), 5, 0.11);
}

TEST(MetricUncertainty, TheQuantileMeetsALimitWithItsProbability) {
  MetricUncertainty spread{{3, Draws{5, 3, 0.4}, 0}, {}};
  for (std::uint64_t i = 0; i < kTableDraws; ++i)
    spread.factors.push_back(0.7 + 0.6 * sim::hash_to_unit_float(sim::hash(1, i)));
  for (const double share : {0.5, 0.8, 0.95}) {
    const Goal below{Goal::Kind::kBelow, "f", spread.quantile(share), ""};
    double met = 0;
    for (std::size_t draw = 0; draw < kTableDraws; ++draw) met += probability_met(below, spread.at(draw));
    EXPECT_NEAR(met / double{kTableDraws}, share, 1e-3);
  }
}

/// Predicted probability of 200 drawn designs against the share of their true values that meet the limit: other draws
/// of the energy tables, and other plays of the frame.
TEST(Probabilities, AreCalibratedOn200DrawnDesigns) {
  const TempFolder folder;
  constexpr std::size_t kPlays = 5, kFuture = 8;
  const std::size_t designs = full_or(200U, 10U);
  const double bound = full_or(0.05, 0.1);  // few designs are few draws of the tables
  const char* const kPath = "totals.power_w.nominal";
  double predicted = 0, frequency = 0, sure = 0, sure_met = 0;
  std::size_t sure_count = 0;
  for (std::size_t i = 0; i < designs; ++i) {
    const auto pick = [&](std::size_t axis, std::size_t values) { return sim::hash(53, i, axis) % values; };
    const std::string out = (folder.path() / std::to_string(i)).string();
    Words words = {"run",
                   "--scene",
                   "cornell",
                   "--resolution",
                   "64x32",
                   "--replicates",
                   std::to_string(kPlays + kFuture),
                   "--intervals",
                   "off",
                   "--quiet",
                   "-o",
                   out,
                   "--set",
                   fmt::format("cores={}", 1 + pick(0, 4)),
                   "--set",
                   fmt::format("tni.trvs={}", 1 + pick(1, 4)),
                   "--set",
                   fmt::format("tni.trv.l1.size={} KiB", 4 << pick(2, 3)),
                   "--set",
                   fmt::format("clocks.tni={} MHz", 300 + 50 * pick(3, 7))};
    ASSERT_EQ(raywatt(words).exit, 0);
    const ReportFile report = load_report(out);
    const auto plays =
        report.json["totals"]["replicates"]["figures"]["power_w"]["nominal"]["values"].get<std::vector<double>>();
    const std::vector<double> known(plays.begin(), plays.begin() + kPlays), future(plays.begin() + kPlays, plays.end());
    const Draws draws = draw_statistics(known);
    MetricUncertainty spread = TableDraws(report).uncertainty_of(kPath, {draws.mean, draws});
    // A limit near the power of the design, drawn too.
    const double wish = 0.7 + 0.6 * sim::hash_to_unit_float(sim::hash(53, i, 9));
    const Goal limit{Goal::Kind::kBelow, kPath, wish * draws.mean, ""};
    double chance = 0;
    for (std::size_t draw = 0; draw < kTableDraws; ++draw)
      chance += probability_met(limit, spread.at(draw)) / double{kTableDraws};
    // The true tables are other draws than those of the prediction.
    PricedRun run(report);
    const double nominal = nominal_energy_pj(run, "");
    const double future_mean = draw_statistics(future).mean;
    double met = 0;
    constexpr std::uint64_t kTruths = 40;
    for (const double pj : energy_by_draw_pj(run, "", kTruths, 1000 + i))
      met += limit.is_met(future_mean * pj / nominal) ? 1.0 / double{kTruths} : 0;
    predicted += chance / static_cast<double>(designs);
    frequency += met / static_cast<double>(designs);
    if (chance >= 0.8) {
      sure += chance;
      sure_met += met;
      sure_count += 1;
    }
  }
  EXPECT_NEAR(predicted, frequency, bound);
  EXPECT_GT(predicted, 0.2);
  EXPECT_LT(predicted, 0.8);
  if (!is_full_size()) return;  // few designs have few predictions above 0.8
  ASSERT_GT(sure_count, designs / 10);
  EXPECT_NEAR(sure / static_cast<double>(sure_count), sure_met / static_cast<double>(sure_count), bound);
}

}  // namespace
}  // namespace test
