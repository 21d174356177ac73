#include "tools/pricing/energy_study.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/full_size.h"
#include "tests/tools/pricing/two_designs.h"

// Tests of comparing two designs while values of the energy tables vary within their bands.

namespace test {
namespace {

using namespace tools;

struct TwoDesigns : testing::Test {
  TempFolder folder;
  ReportFile a = load_report(simulate_into_folder(folder.path() / "a"));
  ReportFile b =
      load_report(simulate_into_folder(folder.path() / "b", {"--set", "tni.trv.l1.size=32 KiB", "--set", "cores=2"}));
};

/// Returns randomly drawn table values as arguments of --set.
std::vector<std::string> sets_of(PricedRun& run, const EnergyDraw& draw) {
  std::vector<std::string> sets;
  run.apply_draw(draw);
  for (const EnergyEntry& entry : run.band_entries()) {
    for (const EnergyEntry::Figure& f : entry.figures) sets.push_back(fmt::format("{}={}", f.name, f.value->nominal));
  }
  run.restore_nominal();
  return sets;
}

TEST_F(TwoDesigns, UnderADrawAreWhatTheirReportsSayUnderThatTable) {
  const std::uint64_t draws = full_or<std::uint64_t>(200, 40);
  PricedRun of_a(a), of_b(b);
  const std::vector<double> drawn_a = energy_by_draw_pj(of_a, "", draws), drawn_b = energy_by_draw_pj(of_b, "", draws);
  const std::vector<double> tni = energy_by_draw_pj(of_a, "tni", draws);
  for (std::uint64_t i = 0; i < draws; ++i) {
    const PricedRun again_a(a, {.sets = sets_of(of_a, {kEnergySeed, i})});
    const PricedRun again_b(b, {.sets = sets_of(of_b, {kEnergySeed, i})});
    const double brute = again_b.energy().total_pj.nominal / again_a.energy().total_pj.nominal;
    ASSERT_EQ(drawn_b[i] / drawn_a[i], brute) << "draw " << i;
    ASSERT_EQ(tni[i], again_a.energy().blocks.at("tni").total().nominal) << "draw " << i;
  }
  EXPECT_EQ(of_a.energy().total_pj, PricedRun(a).energy().total_pj) << "restored";
}

TEST_F(TwoDesigns, UnderADrawAreWhatARunWithThatTableSays) {
  PricedRun of_a(a);
  Words more;
  for (const std::string& set : sets_of(of_a, {kEnergySeed, 17})) more.insert(more.end(), {"--set", set});
  const ReportFile simulated = load_report(simulate_into_folder(folder.path() / "again", more));
  const std::vector<double> drawn = energy_by_draw_pj(of_a, "", 18);
  EXPECT_EQ(PricedRun(simulated).energy().total_pj.nominal, drawn[17]);
  EXPECT_EQ(simulated.number("totals.energy_mj.nominal"), drawn[17] * 1e-9);
}

TEST_F(TwoDesigns, DrawOneQuantileForAllPointsOfACurveAndBothDesigns) {
  PricedRun of_a(a), of_b(b);
  of_a.apply_draw({1, 5});
  of_b.apply_draw({1, 5});
  for (std::size_t e = 0; e < of_a.band_entries().size(); ++e) {
    const EnergyEntry &x = of_a.band_entries()[e], &y = of_b.band_entries()[e];
    ASSERT_EQ(x.name, y.name);
    EXPECT_EQ(x.figures.front().value->nominal, y.figures.front().value->nominal) << x.name;
    if (x.name != "energy.events.cache.l1_read") continue;
    ASSERT_EQ(x.figures.size(), 15U) << "1 KiB to 16 MiB";
    for (const EnergyEntry::Figure& f : x.figures) {
      EXPECT_EQ(f.value->nominal, value_at_quantile(f.band, EnergyDraw{1, 5}.quantile_of(x))) << f.name;
    }
  }
}

TEST_F(TwoDesigns, HaveTheRatioOfTheirReportsUnderTablesTogether) {
  PricedRun of_a(a), of_b(b);
  const EnergyRatio ratio = energy_ratio(of_a, of_b, "");
  EXPECT_EQ(ratio.together.high, of_b.energy().total_pj.high / of_a.energy().total_pj.high);
  EXPECT_EQ(ratio.together.low, of_b.energy().total_pj.low / of_a.energy().total_pj.low);
  EXPECT_LT(ratio.drawn.from, ratio.drawn.median);
  EXPECT_LT(ratio.drawn.median, ratio.drawn.to);
  EXPECT_LT(ratio.drawn.from, ratio.together.nominal);
  EXPECT_GT(ratio.drawn.to, ratio.together.nominal);
  const std::vector<double> of_a_drawn = energy_by_draw_pj(of_a, ""), of_b_drawn = energy_by_draw_pj(of_b, "");
  double less = 0;
  for (std::size_t i = 0; i < of_a_drawn.size(); ++i) less += of_b_drawn[i] < of_a_drawn[i] ? 1 : 0;
  EXPECT_EQ(ratio.b_less, less / static_cast<double>(kEnergyDraws));
}

TEST_F(TwoDesigns, AreEqualToThemselvesWhateverTheTables) {
  PricedRun one(a), other(a);
  const EnergyRatio ratio = energy_ratio(one, other, "");
  EXPECT_EQ(ratio.drawn.from, 1);
  EXPECT_EQ(ratio.drawn.to, 1);
  EXPECT_EQ(ratio.b_less, 0);
  EXPECT_TRUE(tornado_bars(one, other, "").empty());
}

TEST_F(TwoDesigns, HaveATornadoOfOneEntryAtATime) {
  PricedRun of_a(a), of_b(b);
  const std::vector<TornadoBar> bars = tornado_bars(of_a, of_b, "");
  ASSERT_GT(bars.size(), 10U);
  EXPECT_TRUE(std::ranges::is_sorted(bars, std::greater<>(), &TornadoBar::ratio_swing));
  const auto bar = std::ranges::find(bars, "energy.events.tni.box_test", &TornadoBar::entry);
  ASSERT_NE(bar, bars.end());
  const PriceTable low{.sets = {"energy.events.tni.box_test=7.9"}};
  EXPECT_DOUBLE_EQ(bar->at_low,
                   PricedRun(b, low).energy().total_pj.nominal / PricedRun(a, low).energy().total_pj.nominal);
}

TEST(Quantile, IsTheBandsEndsAndItsMiddleTheNominalFigure) {
  const sim::Band band{2, 4, 16};
  EXPECT_EQ(value_at_quantile(band, 0), 2);
  EXPECT_EQ(value_at_quantile(band, 0.5), 4);
  EXPECT_DOUBLE_EQ(value_at_quantile(band, 0.75), 8);
  EXPECT_DOUBLE_EQ(value_at_quantile(band, 1), 16);
  EXPECT_DOUBLE_EQ(value_at_quantile({0, 4, 16}, 0.25), 2);
  EXPECT_EQ(value_at_quantile({3, 3, 3}, 0.3), 3);
}

TEST(Interval, IsOfTheSamplesWithStraightLinesBetween) {
  std::vector<double> samples;
  for (int i = 200; i >= 0; --i) samples.push_back(i);
  const Interval95 interval = interval_of(samples);
  EXPECT_DOUBLE_EQ(interval.from, 5);
  EXPECT_DOUBLE_EQ(interval.median, 100);
  EXPECT_DOUBLE_EQ(interval.to, 195);
  EXPECT_DOUBLE_EQ(interval_of({1, 2}).median, 1.5);
}

TEST(EnergyMetrics, AreThoseWithJoulesInThem) {
  EXPECT_FALSE(energy_metric("totals.cycles"));
  EXPECT_FALSE(energy_metric("totals.energy_mj.low"));
  EXPECT_EQ(energy_metric("totals.energy_by_block_mj.l2.nominal")->block, "l2");
  EXPECT_TRUE(energy_metric("totals.perf.frames_per_joule_tni")->inverse);
  EXPECT_EQ(energy_metric("totals.perf.frames_per_joule_tni")->block, "tni");
  EXPECT_FALSE(energy_metric("totals.perf.nj_per_ray")->inverse);
}

}  // namespace
}  // namespace test
