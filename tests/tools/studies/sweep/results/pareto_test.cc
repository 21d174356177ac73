#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/hash.h"
#include "tests/tools/studies/sweep/results/made_sweep.h"
#include "tools/studies/sweep/results/best.h"

// Tests of `raywatt sweep pareto`.

namespace test {
namespace {

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
