#include "tools/studies/sweep/results/machine_set.h"

#include <cmath>

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "tests/tools/studies/sweep/results/made_sweep.h"
#include "tools/analysis/report_file.h"
#include "tools/studies/sweep/results/best.h"
#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/results/sensitivity.h"

// Machines of a sweep over several workloads, and metrics over them.

namespace test {
namespace {

using namespace tools::results;

nlohmann::ordered_json report_with_area(double cycles, double area = 1) {
  nlohmann::ordered_json report = minimal_report(cycles);
  report["resolution"] = {1024, 512};
  report["totals"]["area_mm2"] = area;
  return report;
}

/// Machines of 1, 2 and 4 cores on two workloads, each with its scene.
struct TwoWorkloads : MadeSweep {
  TwoWorkloads() {
    const double cycles[2][3] = {{100, 60, 50}, {80, 70, 30}};
    for (const int w : {0, 1}) {
      for (const int m : {0, 1, 2}) {
        const std::size_t n = add({{"workload", w == 0 ? "hall" : "tree"},
                                   {"scene", w == 0 ? "hall.glb" : "tree.glb"},
                                   {"cores", std::to_string(1 << m)}});
        finish(n, report_with_area(cycles[w][m], 10 + m));
      }
    }
  }
};

std::string best_machine(const MadeSweep& sweep, const BestOptions& options) {
  return best_text(sweep.results(), sweep.points(), options);
}

/// Error of a call, or its text.
std::string error_or_result(auto&& call) {
  try {
    return call();
  } catch (const sim::InputError& error) {
    return error.what();
  }
}

std::vector<double> numbers_at(const Column& column, const std::vector<std::size_t>& rows) {
  std::vector<double> values;
  for (const std::size_t row : rows) values.push_back(magnitude_of(column.values[row])->value);
  return values;
}

TEST(Machines, ArePointsThatDifferOnlyInTheirWorkload) {
  const TwoWorkloads sweep;
  const Results results = sweep.results();
  const MachineSet& machines = results.machines();
  EXPECT_EQ(machines.workloads, (Words{"hall", "tree"}));
  EXPECT_EQ(machines.axes, (Words{"cores", "program"})) << "the workload determines the scene";
  ASSERT_EQ(machines.rows.size(), 3U);
  EXPECT_EQ(*machines.rows[1][0], 1U);
  EXPECT_EQ(*machines.rows[1][1], 4U);
  EXPECT_EQ(machines.machine_of, (std::vector<std::size_t>{0, 1, 2, 0, 1, 2}));
  EXPECT_EQ(machines.points_of({1, 2}), (std::vector<std::size_t>{1, 2, 4, 5}));
}

TEST(Machines, AreSinglePointsWithoutAListOfWorkloads) {
  MadeSweep sweep;
  for (const char* cores : {"1", "2"}) sweep.finish(sweep.add({{"cores", cores}}), 100);
  const Results results = sweep.results();
  EXPECT_TRUE(results.machines().workloads.empty());
  EXPECT_EQ(results.machines().rows.size(), 2U);
  EXPECT_EQ(numbers_at(results.column("worst(cycles)"), {0, 1}), (std::vector<double>{100, 100}));
  EXPECT_SAYS(error_or_result([&] { return results.column("on(hall, cycles)").name; }),
              "'hall' is no workload; allowed: cycles, as there is no list of workloads");
  EXPECT_FALSE(std::filesystem::exists(sweep.folder() / "machines.csv"));
}

TEST(Machines, KeepAnAxisThatTheWorkloadDoesNotDetermine) {
  MadeSweep sweep;
  for (const char* workload : {"a", "b"}) {
    for (const char* resolution : {"64x32", "128x64"}) {
      sweep.finish(sweep.add({{"workload", workload}, {"resolution", resolution}}), 100);
    }
  }
  EXPECT_EQ(sweep.results().machines().rows.size(), 2U);
}

TEST(Machines, HaveMetricsOverTheirWorkloads) {
  const TwoWorkloads sweep;
  const Results results = sweep.results();
  const auto values = [&](const char* text) { return numbers_at(results.column(text), {0, 1, 2}); };
  EXPECT_EQ(values("worst(cycles)"), (std::vector<double>{100, 70, 50}));
  EXPECT_EQ(values("mean(cycles)"), (std::vector<double>{90, 65, 40}));
  EXPECT_EQ(values("on(tree, cycles)"), (std::vector<double>{80, 70, 30}));
  EXPECT_EQ(values("worst(fps)"), (std::vector<double>{1e4, 1e6 / 70, 2e4})) << "fps is better when high";
  EXPECT_NEAR(values("geomean(cycles)")[0], std::sqrt(8000), 1e-9);
  EXPECT_EQ(results.column("worst(cycles)").name, "worst(totals.cycles)");
  EXPECT_EQ(numbers_at(results.column("worst(cycles)"), {3, 4, 5}), values("worst(cycles)")) << "at each point";
  EXPECT_SAYS(error_or_result([&] { return results.column("on(trees, cycles)").name; }), "allowed: hall, tree");
  EXPECT_SAYS(error_or_result([&] { return results.column("worst(traversal_steps)").name; }),
              "it is not known whether more or less of traversal_steps is better; allowed: mean(traversal_steps)");
  EXPECT_EQ(numbers_at(results.column("worst(traversal_steps)", true), {0}), std::vector<double>{80});
}

TEST(Machines, WithoutAResultOnAWorkloadHaveNoAggregate) {
  TwoWorkloads sweep;
  sweep.remove(4);
  sweep.fail(4, "out of memory");
  const Results results = sweep.results();
  EXPECT_TRUE(is_absent(results.column("worst(cycles)").values[1]));
  EXPECT_TRUE(is_absent(results.column("on(tree, cycles)").values[1]));
  EXPECT_EQ(exact_text(results.column("on(hall, cycles)").values[1]), "60");
  EXPECT_SAYS(best_machine(sweep, {"worst(cycles)", false, {}}), "least worst(cycles) of 2 machines: machine 2\n");
  EXPECT_EQ(exact_text(machine_status(results).values[1]), "1 of 2 done");
}

TEST(Machines, AreRankedByBest) {
  const TwoWorkloads sweep;
  const std::string text = best_machine(sweep, {"worst(cycles)", false, {}});
  EXPECT_SAYS(text, "least worst(cycles) of 3 machines: machine 2\n");
  EXPECT_SAYS(text, "cores          4\n");
  EXPECT_SAYS(text, "run hall ");
  EXPECT_SAYS(text, "workload  point  cycles");
  EXPECT_SAYS(text, "no other machine ties with it");
  EXPECT_EQ(text.find("scene "), std::string::npos) << text;
  EXPECT_SAYS(best_machine(sweep, {"area_mm2", false, {"cycles<=70"}}),
              "least area_mm2 of 2 machines that meet --where: machine 1\n");
  EXPECT_SAYS(best_machine(sweep, {"area_mm2", false, {"mean(cycles)<=90"}}),
              "of 3 machines that meet --where: machine 0\n");
  EXPECT_SAYS(best_machine(sweep, {"on(hall, fps)", true, {"on(tree, cycles)>=70 and cores<4"}}),
              "most on(hall, perf.fps) of 2 machines that meet --where: machine 1\n");
}

TEST(Machines, AreNotRankedByAMetricOfEachWorkload) {
  const TwoWorkloads sweep;
  const std::string error =
      "'cycles' has a value for each of 2 workloads; allowed: worst(cycles), mean(cycles), geomean(cycles), on(NAME, "
      "cycles) with NAME one of hall, tree";
  EXPECT_EQ(error_or_result([&] { return best_machine(sweep, {"cycles", false, {}}); }), error);
  EXPECT_EQ(error_or_result([&] { return pareto_text(sweep.results(), {"cycles", "worst(fps)", {}}, 80); }), error);
  EXPECT_EQ(error_or_result([&] { return best_machine(sweep, {"cycles", false, {"workload!=none"}}); }), error);
  EXPECT_SAYS(best_machine(sweep, {"cycles", false, {"workload=tree"}}),
              "least cycles of 3 points that meet --where: point 5\n");
  EXPECT_SAYS(error_or_result([&] {
                return best_machine(sweep, {"worst(cycles)", false, {"workload=tree"}});
              }),
              "'worst(cycles)' is evaluated on all workloads, so --where may not select by workload; allowed: on(NAME, "
              "cycles) with NAME one of hall, tree");
}

TEST(Machines, AreRowsOfATableOfTheirMetrics) {
  const TwoWorkloads sweep;
  const Results results = sweep.results();
  const auto table = [&](Words columns, Words where = {}) {
    return results_table(results, {std::move(columns), "worst(cycles)", std::move(where), {}, true});
  };
  EXPECT_EQ(table({"n", "cores", "worst(cycles)", "on(tree, cycles)", "area_mm2"}),
            "machine,cores,worst(totals.cycles),\"on(tree, totals.cycles)\",totals.area_mm2\n"
            "2,4,50,30,12\n1,2,70,70,11\n0,1,100,80,10\n");
  EXPECT_EQ(table({"cores", "worst(cycles)"}, {"cycles>50"}), "cores,worst(totals.cycles)\n2,70\n1,100\n");
  EXPECT_EQ(table({"n", "cycles"}, {"worst(cycles)>=100"}), "n,totals.cycles\n0,100\n3,80\n")
      << "rows are points if no column is a function";
  EXPECT_SAYS(error_or_result([&] {
                return table({"cycles", "worst(cycles)"});
              }),
              "has a value for each of 2 workloads");
  TableOptions usual;
  usual.machines = true;
  EXPECT_SAYS(results_table(results, usual), "worst(perf.fps)");
}

TEST(Machines, AreOnTheFrontOfTheirMetrics) {
  const TwoWorkloads sweep;
  const std::string text = pareto_text(sweep.results(), {"area_mm2", "mean(fps)", {}, true}, 80);
  EXPECT_EQ(cells_of(text).size(), 4U) << text;
  EXPECT_SAYS(text, "front,machine,cores,totals.area_mm2,mean(totals.perf.fps)\na,0,1,10");
}

TEST(Machines, HaveSensitivitiesWithoutTheWorkload) {
  const TwoWorkloads sweep;
  const Results results = sweep.results();
  const std::vector<bool> all(6, true);
  const Sensitivity of_machines = find_sensitivity(results, "mean(cycles)", all);
  EXPECT_EQ(of_machines.points, 3U);
  ASSERT_EQ(of_machines.effects.size(), 1U);
  EXPECT_EQ(of_machines.effects[0].axis, "cores");
  EXPECT_EQ(find_sensitivity(results, "cycles", all).effects.size(), 2U) << "by point the workload is an axis";
}

TEST(Machines, HaveTheNoiseOfTheirPoints) {
  TwoWorkloads sweep;
  for (const std::size_t n : {0, 1, 2, 3, 4, 5}) {
    auto report = nlohmann::ordered_json::parse(read_bytes(sweep.point(n) / "report.json"));
    report["totals"]["replicates"] = {
        {"count", 4}, {"figures", {{"cycles", {{"mean", report["totals"]["cycles"]}, {"deviation", n < 3 ? 8 : 10}}}}}};
    sweep.finish(n, report);
  }
  const Results results = sweep.results();
  const std::vector<std::size_t> rows = {0, 1, 2};
  const MetricNoise mean(results, results.column("mean(cycles)"), rows);
  EXPECT_TRUE(mean.is_measured());
  EXPECT_NEAR(mean.error(0), std::hypot(4.0, 5.0) / 2, 1e-12);
  EXPECT_EQ(mean.replicate_count(0), 4U);
  const MetricNoise worst(results, results.column("worst(cycles)"), rows);
  EXPECT_NEAR(worst.error(0), 4, 1e-12) << "noise separates the workloads";
  EXPECT_NEAR(worst.error(1), 5 * std::sqrt(1 + std::log(2.0)), 1e-9) << "it does not";
  const std::string text = best_machine(sweep, {"worst(cycles)", false, {}});
  EXPECT_SAYS(text, "noise measured by 4 replicates per point");
}

TEST(Machines, HaveAFileWithAggregatesAndEveryMetricPerWorkload) {
  const TwoWorkloads sweep;
  sweep.collect();
  const std::string csv = read_bytes(sweep.folder() / "machines.csv");
  EXPECT_EQ(csv.substr(0, csv.find(",totals.area_mm2")), "machine,status,points,cores,program");
  EXPECT_SAYS(csv, ",worst(totals.cycles),mean(totals.cycles),geomean(totals.cycles),");
  EXPECT_SAYS(csv, ",\"on(hall, totals.limiter)\",\"on(tree, totals.limiter)\",");
  EXPECT_SAYS(csv, "\n1,done,1 4,2,full:1,11,70,65,");
  std::filesystem::remove(sweep.folder() / "machines.csv");
  EXPECT_FALSE(sweep.collect().unchanged);
  EXPECT_EQ(read_bytes(sweep.folder() / "machines.csv"), csv);
  EXPECT_TRUE(sweep.collect().unchanged);
}

TEST(Machines, AreAViewOfTheIndex) {
  const TwoWorkloads sweep;
  sweep.collect();
  SQLite::Database index((sweep.folder() / "index.sqlite").string());
  const auto value = [&](const std::string& what) {
    return index.execAndGet("SELECT " + what + " FROM machines WHERE machine = 1 AND path = 'totals.cycles'")
        .getDouble();
  };
  EXPECT_EQ(value("worst"), 70);
  EXPECT_EQ(value("mean"), 65);
}

TEST(Machines, WithPicturesThatEqualTheReferenceMeetAQualityConstraint) {
  TwoWorkloads sweep;
  auto report = report_with_area(60, 11);
  report["totals"]["psnr_db"] = 35.5;
  report["totals"]["identical"] = false;
  sweep.finish(4, report);
  const Results results = sweep.results();
  EXPECT_EQ(numbers_at(results.column("worst(psnr_db)"), {0, 1}), (std::vector<double>{tools::kIdenticalPsnr, 35.5}));
  EXPECT_SAYS(best_machine(sweep, {"area_mm2", true, {"psnr_db>=36"}}),
              "most area_mm2 of 2 machines that meet --where");
}

}  // namespace
}  // namespace test
