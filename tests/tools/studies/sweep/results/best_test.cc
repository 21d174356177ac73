#include "tools/studies/sweep/results/best.h"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/hash.h"
#include "tests/tools/program.h"
#include "tests/tools/studies/sweep/results/made_sweep.h"
#include "tools/studies/sweep/results/figure_noise.h"

// Tests of `raywatt sweep best`.

namespace test {
namespace {

/// A sweep of four points with cycles of 300, 100, 100 and 200.
struct FourSizes : MadeSweep {
  FourSizes() {
    for (const double cycles : {300, 100, 100, 200}) finish(add({{"cores", std::to_string(size++)}}), cycles);
  }
  int size = 0;
};

std::string best(const MadeSweep& sweep, const tools::results::BestOptions& options) {
  return best_text(sweep.results(), sweep.points(), options);
}

TEST(Best, IsTheFirstOfThoseWithTheMostOrLeast) {
  const FourSizes sweep;
  EXPECT_SAYS(best(sweep, {"cycles", true, {}}), "most cycles of 4 points: point 0\n");
  EXPECT_SAYS(best(sweep, {"cycles", false, {}}),
              "least cycles of 4 points: point 1 (and 1 more with the same value)\n");
  EXPECT_SAYS(best(sweep, {"cycles", true, {"cycles<300", "cores!=3"}}),
              "most cycles of 2 points that meet --where: point 1 (and 1 more with the same value)\n");
}

/// Returns the report of a run of 1024x512 pixels with three replicates.
nlohmann::ordered_json replicated_report(double mean, double deviation) {
  nlohmann::ordered_json report = minimal_report(mean);
  report["resolution"] = {1024, 512};
  if (deviation == 0) return report;
  report["totals"]["replicates"] = {{"count", 3},
                                    {"figures", {{"cycles", {{"mean", mean}, {"deviation", deviation}}}}}};
  return report;
}

/// A sweep of one and two cores with two cache sizes. The number of cores changes cycles by 20 %, the cache by 0.5 %.
struct CoresAndCaches : MadeSweep {
  explicit CoresAndCaches(double deviation) {
    const double cycles[] = {1200, 1206, 1000, 1005};
    for (const int i : {0, 1, 2, 3}) {
      add({{"cores", i < 2 ? "1" : "2"}, {"l1", i % 2 == 0 ? "8 KiB" : "4 KiB"}});
      finish(static_cast<std::size_t>(i), replicated_report(cycles[i], deviation));
    }
  }
};

TEST(Best, ShowsFiguresThatConditionsCompareAndReadableSettings) {
  MadeSweep sweep;
  sweep.add({{"cores", "2"}, {"l1", "16 KiB"}});
  sweep.finish(0, 1234567);
  std::vector<tools::sweep::Point> points(sweep.points().begin(), sweep.points().end());
  points[0].sets = {"cores=2", "tni.trv.l1.size=16 KiB"};
  const std::string text =
      best_text(sweep.results(), points, {"cycles", true, {"top_down.cores[0].boxes<1 and cores=2", "cycles>1"}});
  EXPECT_SAYS(text, "top_down.cores[0].boxes  0.2500");
  EXPECT_SAYS(text, "--set cores=2 --set tni.trv.l1.size='16 KiB'\n");
  const std::size_t once = text.find("\ncycles ");
  ASSERT_NE(once, std::string::npos) << text;
  EXPECT_EQ(text.find("\ncycles ", once + 1), std::string::npos) << text;
}

TEST(Best, ListsWhatTiesUnderTheAssumedNoiseAndTheAxesThatDecide) {
  const std::string text = best(CoresAndCaches(0), {"cycles", false, {}});
  EXPECT_SAYS(text, "1 point ties with it (95 %, all points together); noise of 2 % is assumed");
  EXPECT_SAYS(text, "point     l1  cycles");
  EXPECT_SAYS(text, "matters for the first place: cores\n");
  EXPECT_SAYS(text, "does not matter there: l1\n");
  EXPECT_EQ(text.find("1206"), std::string::npos) << text;
  EXPECT_EQ(text.find("no full grid"), std::string::npos) << text;
}

TEST(Best, SaysThatSharesAreEstimatesWherePointsAreNoGrid) {
  CoresAndCaches sweep(0);
  sweep.finish(sweep.add({{"cores", "3"}, {"l1", "8 KiB"}}), replicated_report(900, 0));
  EXPECT_SAYS(best(sweep, {"cycles", false, {}}), "the points are no full grid: shares are estimates\n");
}

TEST(Best, NamesThePointsThatAreExtrapolated) {
  const CoresAndCaches sweep(0);
  const std::string said = "figures beyond what the tables cover, as warnings[] of the reports say: ";
  const auto set = [&](std::size_t point, int count) {
    auto report = replicated_report(1000, 0);
    report["totals"]["extrapolated"] = count;
    sweep.finish(point, report);
  };
  for (const std::size_t point : {0U, 1U, 2U, 3U}) set(point, 0);
  EXPECT_EQ(best(sweep, {"cycles", false, {}}).find(said), std::string::npos);
  set(1, 2);
  EXPECT_SAYS(best(sweep, {"cycles", false, {}}), said + "point 1\n");
  set(3, 1);
  EXPECT_SAYS(best(sweep, {"cycles", false, {}}), said + "points 1, 3\n");
  EXPECT_EQ(best(sweep, {"cycles", false, {"n=0"}}).find(said), std::string::npos) << "of those that qualify";
  EXPECT_SAYS(pareto_text(sweep.results(), {"cycles", "fps", {}, false}, 60), said + "points 1, 3\n");
}

TEST(Best, ReplicatesTellApartWhatTheAssumedNoiseDoesNot) {
  const std::string sure = best(CoresAndCaches(0.5), {"cycles", false, {}});
  EXPECT_SAYS(sure, "no other point ties with it");
  EXPECT_SAYS(sure, "matters for the first place: cores\nmatters little, less than 5 % of the variance: l1\n");
  EXPECT_SAYS(best(CoresAndCaches(20), {"cycles", false, {}}),
              "1 point ties with it (95 %, all points together); noise measured by 3 replicates per point\n");
}

TEST(Best, FiguresThatConditionsCompareAreMeansToo) {
  CoresAndCaches sweep(0.5);
  auto report = replicated_report(900, 0.5);
  report["totals"]["cycles"] = 2000;
  sweep.finish(0, report);
  EXPECT_SAYS(best(sweep, {"fps", true, {"cycles<950"}}), "\ncycles         900");
}

TEST(Best, DrawsOfAFigurePerAreaSayThatTheAreaIsNominal) {
  EXPECT_EQ(tools::results::energy_draws_note({}), "");
  MadeSweep sweep;
  sweep.add({{"cores", "1"}});
  sweep.finish(0, 1000);
  tools::results::Column figure{"totals.perf.frames_per_joule_per_mm2", {tools::results::Value(1.0)}};
  const tools::results::MetricNoise noise(sweep.results(), figure, {});
  EXPECT_EQ(tools::results::energy_draws_note({&noise}), "area is nominal in all draws\n");
}

TEST(Best, FiguresWithoutNoiseHaveNoTies) {
  EXPECT_EQ(best(CoresAndCaches(0), {"top_down.cores[0].boxes", true, {}}).find("tie"), std::string::npos);
}

TEST(Best, CommandLineTakesOneFigure) {
  const FourSizes sweep;
  sweep.collect();
  const std::string folder = sweep.folder().string();
  expect_refusal(raywatt({"sweep", "best", folder}), {"--max", "--min"});
  expect_refusal(raywatt({"sweep", "best", folder, "--max", "cycles", "--min", "fps"}), {"--max", "--min"});
  expect_refusal(raywatt({"sweep", "best", folder, "--max", "cycles", "--where", "cycles<1"}), {"no point"});
  expect_refusal(raywatt({"sweep", "best", folder, "--max", "low_w"}), {"low_w"});
  const ProcessResult ending = raywatt({"sweep", "best", folder, "--min", "cycles", "--where", "n>1"});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "point 2\n");
}

TEST(Best, SaysHowToRunItAgain) {
  const TempFolder temporary;
  const std::filesystem::path run = temporary.path() / "run", again = temporary.path() / "again";
  const Words settings = {"--program", "multirate:under", "--set", "cores=2"};
  ASSERT_EQ(raywatt(small_run(run, settings)).exit, 0);
  MadeSweep sweep;
  sweep.add({{"cores", "2"}}, "multirate:under");
  sweep.finish(0, nlohmann::ordered_json::parse(read_bytes(run / "report.json")));
  std::filesystem::copy_file(run / "config.yaml", sweep.point(0) / "config.yaml",
                             std::filesystem::copy_options::overwrite_existing);
  const std::string text = best(sweep, {"fps", true, {}});
  std::istringstream words(text.substr(text.find("raywatt run ") + std::string("raywatt ").size()));
  Words command;
  for (std::string word; words >> word;) command.push_back(word);
  command.insert(command.end(), {"-o", again.string()});
  ASSERT_EQ(raywatt(command).exit, 0) << text;
  const nlohmann::json a = read_json(run / "report.json"), b = read_json(again / "report.json");
  EXPECT_EQ(a["totals"], b["totals"]);
  EXPECT_EQ(a["units"], b["units"]);
}

// Tests of `raywatt sweep pareto`.

using tools::results::Objective;
using tools::results::ParetoFront;
using tools::results::Results;

/// A sweep whose points have given power and frame rate.
struct Plane : MadeSweep {
  explicit Plane(const std::vector<std::pair<double, double>>& points) {
    for (const auto& [watts, fps] : points) {
      auto report = minimal_report(100);
      report["totals"]["power_w"]["nominal"] = watts;
      report["totals"]["perf"]["fps"] = fps;
      finish(add({{"cores", std::to_string(lines++)}}), report);
    }
  }
  int lines = 0;
};

ParetoFront front_of(const Results& results, const std::string& x, const std::string& y) {
  return tools::results::find_front({results, x}, {results, y}, std::vector<bool>(results.rows().size(), true));
}

using Rows = std::vector<std::size_t>;

TEST(Pareto, HoldsWhatNoOtherPointBeats) {
  const Plane sweep({{1, 10}, {2, 20}, {3, 15}, {3, 30}, {1.5, 5}});
  const Results results = sweep.results();
  const ParetoFront front = front_of(results, "power_w.nominal", "fps");
  EXPECT_EQ(front.rows, (Rows{0, 1, 3}));
  EXPECT_EQ(front.other.size(), 2U);
}

TEST(Pareto, KnowsWhichWayAFigureIsBetterUnlessToldOtherwise) {
  const Plane sweep({{1, 10}, {2, 20}});
  const Results results = sweep.results();
  EXPECT_FALSE(Objective(results, "power_w.nominal").more_is_better);
  EXPECT_FALSE(Objective(results, "cycles").more_is_better);
  EXPECT_FALSE(Objective(results, "cores").more_is_better);
  EXPECT_TRUE(Objective(results, "fps").more_is_better);
  EXPECT_TRUE(Objective(results, "frames_per_joule_gpu").more_is_better);
  EXPECT_EQ(front_of(results, "max:power_w.nominal", "fps").rows, (Rows{1}));
  EXPECT_EQ(front_of(results, "power_w.nominal", "min:fps").rows, (Rows{0}));
}

TEST(Pareto, OfEqualPointsAllAreOnIt) {
  const Plane sweep({{1, 10}, {1, 10}, {1, 9}, {2, 10}});
  const Results results = sweep.results();
  EXPECT_EQ(front_of(results, "power_w.nominal", "fps").rows, (Rows{0, 1}));
}

TEST(Pareto, IsWhatComparingAllPairsGives) {
  std::vector<std::pair<double, double>> points;
  for (int i = 0; i < 60; ++i) {
    points.emplace_back(static_cast<double>(sim::hash(i, 1) % 12), static_cast<double>(sim::hash(i, 2) % 12));
  }
  Rows wanted;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto beats = [&](const auto& other) {
      return other != points[i] && other.first <= points[i].first && other.second >= points[i].second;
    };
    if (std::ranges::none_of(points, beats)) wanted.push_back(i);
  }
  const Plane sweep(points);
  const Results results = sweep.results();
  Rows rows = front_of(results, "power_w.nominal", "fps").rows;
  std::ranges::sort(rows);
  EXPECT_EQ(rows, wanted);
}

TEST(Pareto, DrawsTheFrontAsLettersAndTheOthersAsDots) {
  const Plane sweep({{1, 10}, {2, 20}, {3, 10}});
  const std::string text = pareto_text(sweep.results(), {"power_w.nominal", "fps", {}, false}, 60);
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size(); begin = text.find('\n', begin) + 1) {
    lines.push_back(text.substr(begin, text.find('\n', begin) - begin));
  }
  EXPECT_EQ(lines[0], "perf.fps (more is better)");
  EXPECT_TRUE(lines[1].starts_with("20 |") && lines[1].ends_with("b")) << text;
  EXPECT_TRUE(lines[20].starts_with("10 |a") && lines[20].ends_with(".")) << text;
  const std::size_t dot = lines[20].size(), b = lines[1].size();
  EXPECT_EQ(dot, 59U) << "as wide as the terminal, but for its last column";
  EXPECT_NEAR(static_cast<double>(b), (5 + 59) / 2.0, 1) << "half-way";
  EXPECT_SAYS(text, "2 of 3 points are on the front");
  EXPECT_SAYS(text, "\na  0      0            1.000     10.00\n");
  for (std::size_t i = 0; i < 24; ++i) EXPECT_LE(lines[i].size(), 60U) << lines[i];
}

TEST(Pareto, DrawsPointsThatAreAllAlike) {
  const Plane sweep({{1, 10}, {1, 10}});
  EXPECT_SAYS(pareto_text(sweep.results(), {"power_w.nominal", "fps", {}, false}, 10), "2 of 2 points");
}

/// A sweep of runs of 1024x512 pixels. The area has no noise; the frame rate has that of replicates, or the default.
struct NoisyPlane : MadeSweep {
  NoisyPlane(const std::vector<std::pair<double, double>>& points, double deviation) {
    for (const auto& [mm2, fps] : points) {
      auto report = minimal_report(100);
      report["resolution"] = {1024, 512};
      report["totals"]["area_mm2"] = mm2;
      report["totals"]["perf"]["fps"] = fps;
      if (deviation != 0) {
        report["totals"]["replicates"] = {
            {"count", 5}, {"figures", {{"perf", {{"fps", {{"mean", fps}, {"deviation", deviation}}}}}}}};
      }
      finish(add({{"cores", std::to_string(lines++)}}), report);
    }
  }
  int lines = 0;
};

TEST(Pareto, HasABandOfPointsThatNoneBeatsByMoreThanTheNoise) {
  const std::vector<std::pair<double, double>> points = {{1, 100}, {1, 99.5}, {1, 90}, {2, 99.9}, {2, 120}};
  const auto text = [&](double deviation) {
    return pareto_text(NoisyPlane(points, deviation).results(), {"area_mm2", "fps", {}, false}, 60);
  };
  const std::string assumed = text(0);
  EXPECT_SAYS(assumed, "2 of 5 points are on the front");
  EXPECT_SAYS(assumed, "1 more may be on the front, marked ~");
  EXPECT_SAYS(assumed, "\nperf.fps: noise of 2 % is assumed");
  EXPECT_SAYS(assumed, "\n~   1      1 ");
  EXPECT_SAYS(assumed, "\na~  0 ");
  EXPECT_SAYS(assumed, "\nb   4 ");
  const std::string measured = text(0.01);
  EXPECT_SAYS(measured, "noise measured by 5 replicates per point");
  EXPECT_EQ(measured.find('~'), std::string::npos) << measured;
  EXPECT_SAYS(text(40), "3 more may be on the front");
}

TEST(Pareto, NoiseOfOneFigureDecidesWhereTheOtherHasNone) {
  const auto text = [](double deviation) {
    return pareto_text(NoisyPlane({{1, 100}, {2, 99.9}}, deviation).results(), {"area_mm2", "fps", {}, false}, 60);
  };
  EXPECT_SAYS(text(1), "1 more may be on the front, marked ~") << "the larger one may be the faster one";
  EXPECT_EQ(text(0.01).find('~'), std::string::npos);
}

TEST(Pareto, CsvIsTheFrontAlone) {
  const Plane sweep({{1, 10}, {2, 20}, {3, 1}});
  const auto rows = cells_of(pareto_text(sweep.results(), {"power_w.nominal", "fps", {"n!=1"}, true}, 80));
  const std::vector<std::vector<std::string>> wanted = {
      {"front", "n", "id", "cores", "totals.power_w.nominal", "totals.perf.fps"},
      {"a", "0", sweep.id(0), "0", "1", "10"}};
  EXPECT_EQ(rows, wanted);
}

TEST(Pareto, SaysIfNoPointHasBothFigures) {
  const Plane sweep({{1, 10}});
  const Results results = sweep.results();
  EXPECT_THROW(pareto_text(results, {"power_w.nominal", "limiter", {}, false}, 80), sim::InputError);
  EXPECT_THROW(pareto_text(results, {"power_w.nominal", "fps", {"n=9"}, false}, 80), sim::InputError);
}

}  // namespace
}  // namespace test
