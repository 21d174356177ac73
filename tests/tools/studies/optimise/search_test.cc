#include "tools/studies/optimise/search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "sim/hash.h"
#include "tests/full_size.h"
#include "tools/studies/optimise/multi_objective.h"
#include "tools/studies/optimise/surrogate.h"
#include "tools/studies/sweep/spec/plan.h"

// Tests of the search on spaces of 1,024 points: fronts found with a tenth of the evaluations are compared with the
// true fronts.

namespace test {
namespace {

using namespace tools::optimise;

constexpr std::size_t kBudget = 102, kFirst = 20, kBatch = 8;
const Goal kMin = {Goal::Kind::kMin, "f", 0, ""}, kMax = {Goal::Kind::kMax, "f", 0, ""};

/// A synthetic space: functions that compute the metrics of a point, whose axes range from 0 to 1.
struct MadeUp {
  std::vector<AxisShape> axes;
  std::vector<Goal> goals;
  std::function<std::vector<double>(const std::vector<double>& x)> f;
  std::function<bool(const Choice&)> is_wanted = [](const Choice&) { return true; };

  std::vector<double> metrics(const Choice& choice) const {
    std::vector<double> x;
    for (std::size_t a = 0; a < axes.size(); ++a) x.push_back(choice[a] / (axes[a].values - 1.0));
    return f(x);
  }
  std::vector<Choice> points() const {
    std::vector<std::uint32_t> sizes;
    for (const AxisShape& axis : axes) sizes.push_back(axis.values);
    return tools::sweep::choose_combinations({}, sizes, is_wanted);
  }
  Search search(std::uint64_t seed) const { return Search({axes, is_wanted}, goals, {.seed = seed}); }

  /// Returns the metrics of all points that meet the constraints.
  std::vector<Score> scores(const std::vector<Choice>& choices) const {
    Search judge = search(0);
    for (const Choice& choice : choices) judge.add_result(choice, metrics(choice));
    std::vector<Score> all;
    for (const auto& [point, score] : judge.feasible_scores()) all.push_back(score);
    return all;
  }
};

/// Runs a search and returns its points in order of evaluation.
std::vector<Choice> search_run(const MadeUp& space, std::uint64_t seed, std::size_t budget = kBudget) {
  Search search = space.search(seed);
  std::vector<Choice> all;
  while (all.size() < budget) {
    const std::vector<Choice> proposed =
        search.propose_points(all.empty() ? kFirst : std::min(kBatch, budget - all.size()));
    if (proposed.empty()) break;
    for (const Choice& choice : proposed) search.add_result(choice, space.metrics(choice));
    all.insert(all.end(), proposed.begin(), proposed.end());
  }
  return all;
}

/// Returns the hypervolume of the points as a share of that of the true front. Reference point: the worst corner.
double share(const MadeUp& space, const std::vector<Choice>& choices) {
  const std::vector<Score> all = space.scores(space.points());
  Score corner = all.front();
  for (const Score& score : all) {
    for (std::size_t o = 0; o < score.size(); ++o) corner[o] = std::min(corner[o], score[o]);
  }
  const auto size = [&](const std::vector<Score>& scores) {
    return corner.size() == 1 ? std::ranges::max(scores)[0] - corner[0] : hypervolume(scores, corner);
  };
  return size(space.scores(choices)) / size(all);
}

/// Returns this share as the median of five seeds at full size, otherwise of one seed.
double found(const MadeUp& space) {
  std::vector<double> shares;
  for (std::uint64_t seed = 1; seed <= full_or(5U, 1U); ++seed) {
    const std::vector<Choice> points = search_run(space, seed);
    EXPECT_LE(points.size(), kBudget);
    EXPECT_EQ(std::set<Choice>(points.begin(), points.end()).size(), points.size()) << "no point twice";
    shares.push_back(share(space, points));
  }
  std::ranges::sort(shares);
  return shares[shares.size() / 2];
}

std::vector<AxisShape> fours(std::size_t axes) { return std::vector<AxisShape>(axes, {4, true}); }

/// Synthetic throughput and power of a machine over five axes: cores, units, cache, clock, second cache.
std::vector<double> machine(const std::vector<double>& x) {
  const double cores = std::exp2(3 * x[0]), units = 1 + 3 * x[1], cache = std::exp2(3 * x[2]), clock = 200 + 600 * x[3];
  const double miss = 0.3 / std::sqrt(cache), miss2 = 0.5 / std::exp2(1.5 * x[4]);
  const double speed = 1 / (1 / (cores * units * clock) + 3e-3 * miss * miss2 + 1 / (2 * cores * clock));
  const double power = 0.05 * cores * (1 + 0.4 * units + 0.05 * cache) * std::pow(clock / 400, 2.2) +
                       0.03 * std::exp2(3 * x[4]) + 1e-4 * speed * (1 + 4 * miss + 30 * miss * miss2);
  return {speed, power};
}

const MadeUp kMachine = {fours(5), {kMax, kMin}, machine};

/// Concave, convex and disconnected fronts: ZDT 1 to 3 (Zitzler, Deb and Thiele, Comparison of Multiobjective
/// Evolutionary Algorithms, 2000).
MadeUp zdt(int number, std::vector<AxisShape> axes) {
  return {std::move(axes), {kMin, kMin}, [number](const std::vector<double>& x) {
            double g = 1;
            for (std::size_t a = 1; a < x.size(); ++a) g += 9 * x[a] / static_cast<double>(x.size() - 1);
            const double r = x[0] / g;
            const double h = number == 2 ? 1 - r * r : 1 - std::sqrt(r);
            return std::vector<double>{x[0], g * (h - (number == 3 ? r * std::sin(10 * std::numbers::pi * x[0]) : 0))};
          }};
}

TEST(Search, FindsTheFrontOfAMachine) { EXPECT_GE(found(kMachine), 0.98); }

TEST(Search, FindsAHollowFront) { EXPECT_GE(found(zdt(1, {{32, true}, {32, true}})), 0.98); }

TEST(Search, FindsABulgingFront) { EXPECT_GE(found(zdt(2, {{64, true}, {4, true}, {4, true}})), 0.98); }

TEST(Search, FindsABrokenFront) { EXPECT_GE(found(zdt(3, {{16, true}, {8, true}, {8, true}})), 0.98); }

TEST(Search, FindsAFrontUnderNoise) {
  MadeUp rough{{{8, true}, {8, true}, {4, true}, {4, true}}, {kMin, kMin}, [](const std::vector<double>& x) {
                 std::uint64_t h = 0;
                 for (const double v : x) h = sim::hash(h, static_cast<std::uint64_t>(v * 1000));
                 const double noise = sim::hash_to_unit_float(h), other = sim::hash_to_unit_float(sim::hash(h));
                 return std::vector<double>{x[0] * x[0] + x[2] + 0.2 * noise,
                                            (1 - x[0]) * (1 - x[0]) + x[1] + 0.5 * x[3] + 0.2 * other};
               }};
  EXPECT_GE(found(rough), 0.98);
}

TEST(Search, DoesNotChaseNoise) {
  // A hill over two axes; the third axis has only noise. If the errors are unknown, the search mistakes noise for
  // height and stays lower on the hill.
  const auto below_the_top = [](const Choice& c) {
    return 0.25 * ((c[0] - 4.0) * (c[0] - 4.0) + (c[1] - 4.0) * (c[1] - 4.0)) / 16;
  };
  const double size = 0.1, error = size / std::sqrt(6.0);  // standard deviation of the sum of two uniform draws
  const auto noise = [&](const Choice& c, std::uint64_t seed) {
    return size * (sim::hash_to_unit_float(sim::hash(seed, c[0], c[1], c[2])) +
                   sim::hash_to_unit_float(sim::hash(seed, c[2], c[1], c[0])) - 1);
  };
  const auto mean_loss = [&](bool tell_errors) {
    double loss = 0;
    std::size_t looks = 0;
    for (std::uint64_t seed = 1; seed <= full_or(24U, 12U); ++seed) {
      Search search({{{9, true}, {9, true}, {9, true}}, [](const Choice&) { return true; }}, {kMax}, {.seed = seed});
      bool has_top = false;
      for (std::size_t batch = 0; batch < 6; ++batch) {
        for (const Choice& point : search.propose_points(batch == 0 ? 24 : kBatch)) {
          search.add_result(point, std::vector<double>{1 - below_the_top(point) + noise(point, seed)},
                            tell_errors ? std::vector<double>{error} : std::vector<double>());
          has_top = has_top || below_the_top(point) == 0;
          if (batch == 0) continue;
          loss += below_the_top(point);
          looks += 1;
        }
      }
      EXPECT_TRUE(has_top) << "seed " << seed;
    }
    return loss / static_cast<double>(looks);
  };
  EXPECT_LT(mean_loss(true), 0.03) << "two steps from the top on one axis are 0.06";
  EXPECT_LT(mean_loss(true), 0.8 * mean_loss(false));
}

TEST(Search, FindsAFrontAmongUnorderedNames) {
  MadeUp names{{{4, true}, {4, true}, {4, true}, {16, false}}, {kMin, kMin}, [](const std::vector<double>& x) {
                 const int name = static_cast<int>(std::lround(x[3] * 15));
                 return std::vector<double>{
                     1 + x[0] + 0.5 * x[1] + name * 7 % 16 / 15.0,
                     2 - x[0] + 0.4 * x[2] * x[2] + 0.3 * std::abs(x[1] - 0.5) + (name * 5 + 3) % 16 / 15.0};
               }};
  EXPECT_GE(found(names), 0.98);
}

TEST(Search, FindsTheFrontUnderAConstraint) {
  MadeUp limited = kMachine;
  limited.goals.push_back({Goal::Kind::kBelow, "f", 0.5, ""});
  limited.f = [](const std::vector<double>& x) {
    std::vector<double> metrics = machine(x);
    metrics.push_back(metrics[1]);
    return metrics;
  };
  EXPECT_LT(limited.scores(limited.points()).size(), 400U) << "the constraint matters";
  EXPECT_GE(found(limited), 0.98);
}

TEST(Search, FindsTheBestOfOneObjective) {
  MadeUp single{fours(5), {kMin}, [](const std::vector<double>& x) {
                  double sum = 0;
                  for (std::size_t a = 0; a < x.size(); ++a) {
                    const double t = x[a] - 0.3 - 0.1 * static_cast<double>(a);
                    sum += t * t - 0.1 * std::cos(12 * t);
                  }
                  return std::vector<double>{sum};
                }};
  EXPECT_NEAR(found(single), 1, 1e-12) << "the very point";
}

TEST(Search, IsBetterThanRandomPoints) {
  std::vector<double> shares;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const tools::sweep::Subset subset{tools::sweep::Subset::Kind::kRandom, kBudget, seed};
    shares.push_back(share(
        kMachine, tools::sweep::choose_combinations(subset, {std::vector<std::uint32_t>(5, 4)}, kMachine.is_wanted)));
  }
  std::ranges::sort(shares);
  EXPECT_LT(shares[2], 0.97) << "the bar of these tests says something";
  EXPECT_GE(share(kMachine, search_run(kMachine, 1, 60)), 0.98) << "and sixty points do";
}

TEST(Search, ProposesTheSamePointsForTheSameSeed) {
  EXPECT_EQ(search_run(kMachine, 7, 44), search_run(kMachine, 7, 44));
  EXPECT_NE(search_run(kMachine, 7, 44), search_run(kMachine, 8, 44));
}

TEST(Search, ProposesOnlyValidPoints) {
  MadeUp part = kMachine;
  part.is_wanted = [](const Choice& c) { return (c[0] + c[1]) % 2 == 0; };
  for (const Choice& point : search_run(part, 1, 60)) EXPECT_TRUE(part.is_wanted(point));
}

TEST(Search, ProposesEveryPointOfASmallSpace) {
  MadeUp small{{{3, true}, {5, true}, {1, true}}, {kMin, kMin}, [](const std::vector<double>& x) {
                 return std::vector<double>{x[0] - x[1], x[1]};
               }};
  small.is_wanted = [](const Choice& c) { return c != Choice{1, 1, 0}; };
  EXPECT_EQ(search_run(small, 1).size(), 14U);
}

TEST(Search, ProposesTheLastValidPointOfAHugeSpace) {
  MadeUp rare{std::vector<AxisShape>(6, {8, true}), {kMin, kMin}, [](const std::vector<double>& x) {
                return std::vector<double>{x[0], -x[0]};
              }};
  rare.is_wanted = [](const Choice& c) { return std::ranges::all_of(c, [&](std::uint32_t v) { return v == c[0]; }); };
  EXPECT_GE(search_run(rare, 1).size(), 7U) << "of eight in 262,144";
}

TEST(Search, AvoidsRegionsWhereSimulationsFail) {
  Search search = kMachine.search(1);
  std::size_t asked = 0, in_vain = 0;
  while (asked < kBudget) {
    for (const Choice& choice : search.propose_points(asked == 0 ? kFirst : kBatch)) {
      const bool fails = choice[0] >= 2;  // in half of the space, with the greatest throughput
      search.add_result(choice, fails ? std::nullopt : std::optional(kMachine.metrics(choice)));
      asked += 1;
      in_vain += fails ? 1 : 0;
    }
  }
  EXPECT_LT(in_vain, 25U);
}

TEST(Search, ContinuesIfAllSimulationsFailed) {
  Search search = kMachine.search(1);
  for (int batch = 0; batch < 3; ++batch) {
    const std::vector<Choice> proposed = search.propose_points(8);
    EXPECT_EQ(proposed.size(), 8U);
    for (const Choice& choice : proposed) search.add_result(choice, std::nullopt);
  }
}

TEST(Search, SearchesFeasiblePointsFirst) {
  MadeUp narrow{fours(5), {kMax, kMin, {Goal::Kind::kAtMost, "f", 0.35, ""}}, [](const std::vector<double>& x) {
                  std::vector<double> metrics = machine(x);
                  double away = 0;
                  for (const double v : x) away += std::abs(v - 0.66);
                  metrics.push_back(away);
                  return metrics;
                }};
  EXPECT_EQ(narrow.scores(narrow.points()).size(), 1U);
  Search search = narrow.search(3);
  std::size_t asked = 0;
  while (search.feasible_scores().empty() && asked < kBudget) {
    for (const Choice& choice : search.propose_points(asked == 0 ? kFirst : kBatch)) {
      search.add_result(choice, narrow.metrics(choice));
      asked += 1;
    }
  }
  EXPECT_LT(asked, 80U) << "one point of 1,024";
}

/// Synthetic area, frame rate and power over cores, traversal units, L1, L2 and clock: 540 points with irregularities
/// like those of simulated frames.
struct SmallestMachine {
  static constexpr std::array kCores = {1.0, 2.0, 4.0, 6.0, 8.0}, kUnits = {1.0, 2.0, 4.0}, kCache = {4.0, 8.0, 16.0},
                              kSecond = {64.0, 128.0, 256.0}, kClock = {300.0, 400.0, 500.0, 600.0};
  static std::vector<double> metrics(const Choice& c) {
    const double cores = kCores.at(c[0]), units = kUnits.at(c[1]), cache = kCache.at(c[2]), second = kSecond.at(c[3]),
                 clock = kClock.at(c[4]);
    const double area = 1.5 + cores * (2.2 + 0.55 * units * (1 + 0.04 * cache)) + 0.009 * second;
    const double miss = 0.25 / std::pow(cache, 0.4), miss2 = 0.6 * std::pow(64 / second, 0.4);
    const double cycles =
        6e5 / (cores * std::pow(units, 0.6)) * (1 + 3 * miss * (0.5 + miss2)) + 9000 + 80 * miss * miss2 * clock;
    std::uint64_t h = 0;
    for (const std::uint32_t v : c) h = sim::hash(h, v);
    const double fps = 1e6 * clock / cycles * (1 + 0.05 * (sim::hash_to_unit_float(h) - 0.5));
    const double power = 0.00018 * cores * (0.6 + 0.2 * units + 0.01 * cache) * clock + 0.0006 * second +
                         2e-5 * fps * (1 + 3 * miss * miss2);
    return {area, fps, power};
  }
  /// Returns the number of searches, out of ten with 40 points each, that find an area within 2 % of the smallest
  /// feasible one. The limit of the frame rate is set so that `first_feasible` of the first points are feasible.
  static int found(std::size_t first_feasible) {
    constexpr double kError = 0.09, kMostPower = 1.2;
    int good = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const MadeUp space{{{5, true}, {3, true}, {3, true}, {3, true}, {4, true}}, {}, {}};
      std::vector<Goal> goals = {
          kMin, {Goal::Kind::kAbove, "fps", 0, ""}, {Goal::Kind::kBelow, "power", kMostPower, ""}};
      const auto new_search = [&] { return Search({space.axes, space.is_wanted}, goals, {.seed = seed}); };
      std::vector<double> rates = {0};
      const std::vector<Choice> first = new_search().propose_points(12);
      for (const Choice& point : first) {
        if (metrics(point)[2] < kMostPower) rates.push_back(metrics(point)[1]);
      }
      std::ranges::sort(rates, std::greater{});
      goals[1].limit =
          first_feasible == 0 ? 1.02 * rates[0] : (rates.at(first_feasible - 1) + rates.at(first_feasible)) / 2;
      double smallest = 1e9;
      for (const Choice& point : space.points()) {
        const std::vector<double> f = metrics(point);
        if (goals[1].is_met(f[1]) && goals[2].is_met(f[2])) smallest = std::min(smallest, f[0]);
      }
      EXPECT_LT(smallest, 1e9) << "some point is feasible, seed " << seed;
      Search search = new_search();
      for (std::size_t points = 0; points < 40;) {
        const std::vector<Choice> proposed =
            points == 0 ? search.propose_points(12) : search.propose_points(std::min(kBatch, 40 - points));
        for (const Choice& point : proposed) {
          const std::vector<double> f = metrics(point);
          search.add_result(point, f, {0, kError * f[1], kError * f[2]}, true);
        }
        points += proposed.size();
        if (points == 12) {
          EXPECT_EQ(search.feasible_scores().size(), first_feasible) << "seed " << seed;
        }
      }
      double best = -1e9;
      for (const auto& [point, score] : search.feasible_scores()) best = std::max(best, score[0]);
      good += -best <= 1.02 * smallest ? 1 : 0;
    }
    return good;
  }
};

TEST(Search, FindsTheSmallestMachineFromNoFeasiblePoint) { EXPECT_GE(SmallestMachine::found(0), 9); }

TEST(Search, FindsTheSmallestMachineFromOneFeasiblePoint) { EXPECT_GE(SmallestMachine::found(1), 9); }

TEST(Search, FindsTheSmallestMachineFromSeveralFeasiblePoints) { EXPECT_GE(SmallestMachine::found(3), 9); }

TEST(Search, FindsAFrontOfOnePoint) {
  // Two objectives, and a limit that only one of the first points meets, so that the feasible range is a single value.
  MadeUp limited = kMachine;
  limited.f = [](const std::vector<double>& x) {
    std::vector<double> metrics = machine(x);
    metrics.push_back(metrics[1]);
    return metrics;
  };
  std::vector<double> powers;
  for (const Choice& point : limited.search(1).propose_points(kFirst)) powers.push_back(limited.metrics(point)[1]);
  std::ranges::sort(powers);
  limited.goals.push_back({Goal::Kind::kBelow, "f", (powers[0] + powers[1]) / 2, ""});
  EXPECT_EQ(limited.scores(limited.search(1).propose_points(kFirst)).size(), 1U);
  EXPECT_GE(share(limited, search_run(limited, 1, 60)), 0.98);
}

// Goals of several figures: one per workload.

/// A machine with 4^5 points and a speed on each of three workloads, which different axes limit.
struct OnWorkloads {
  static constexpr std::size_t kWorkloads = 3;
  static double area(const std::vector<double>& x) { return 4 + 6 * x[0] + 3 * x[1] + 2 * x[2] + x[3] + 0.5 * x[4]; }
  static double speed(const std::vector<double>& x, std::size_t workload) {
    const double units = 1 + 3 * x[workload], cores = 1 + x[0] * 3, clock = 0.5 + x[4];
    return clock * std::sqrt(units * cores) + 0.1 * x[3];
  }
  MadeUp space{fours(5), {kMin, {Goal::Kind::kAbove, "speed", 3.0, ""}}, [](const std::vector<double>& x) {
                 return std::vector<double>{area(x), std::min({speed(x, 0), speed(x, 1), speed(x, 2)})};
               }};
  std::vector<double> position(const Choice& choice) const {
    std::vector<double> x;
    for (const std::uint32_t value : choice) x.push_back(value / 3.0);
    return x;
  }
  double least_area() const {
    double best = 1e9;
    for (const Choice& choice : space.points()) {
      const std::vector<double> metrics = space.metrics(choice);
      if (metrics[1] > 3.0) best = std::min(best, metrics[0]);
    }
    return best;
  }
  /// Returns the least area that a search finds. Machines stop at the first workload that breaks the limit.
  double found_area(std::uint64_t seed, bool knows_area, std::size_t budget) const {
    Search::Options options{.seed = seed};
    options.figures = {{0}, {1, 2, 3}};
    if (knows_area) options.exact = {[&](const Choice& c) { return area(position(c)); }};
    Search search({space.axes, space.is_wanted}, space.goals, options);
    for (std::size_t all = 0; all < budget;) {
      const std::vector<Choice> proposed =
          search.propose_points(all == 0 ? 12 : std::min<std::size_t>(4, budget - all));
      if (proposed.empty()) break;
      all += proposed.size();
      for (const Choice& choice : proposed) {
        const std::vector<double> x = position(choice);
        tools::optimise::MetricValues figures(4);
        figures[0] = area(x);
        for (std::size_t w = 0; w < kWorkloads; ++w) {
          figures[w + 1] = speed(x, w);
          if (speed(x, w) <= 3.0) break;
        }
        search.add_partial_result(choice, figures, {}, false);
      }
    }
    double best = 1e9;
    for (const auto& [point, score] : search.feasible_scores()) best = std::min(best, -score[0]);
    return best;
  }

  /// Returns how many of ten seeds find a machine within 2 % of the least area.
  std::size_t good_seeds(bool knows_area, std::size_t budget) const {
    std::size_t good = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      good += found_area(seed, knows_area, budget) <= 1.02 * least_area() ? 1 : 0;
    }
    return good;
  }
};

TEST(Search, FindsTheLeastAreaOnAllWorkloadsAlthoughRuledOutMachinesLackFigures) {
  EXPECT_GE(OnWorkloads().good_seeds(false, 48), 9U);
}

TEST(Search, NeedsFewerMachinesIfTheAreaIsKnown) { EXPECT_GE(OnWorkloads().good_seeds(true, 36), 9U); }

TEST(Search, CombinesFiguresOfAGoal) {
  using Fold = tools::sweep::SetMetric::Kind;
  const std::vector<double> values = {2, 4, 27};
  const auto combined = [&](Goal::Kind kind, const char* metric, Fold fold) {
    return Goal{kind, metric, 5, "", fold}.combine(values).value();
  };
  EXPECT_EQ(combined(Goal::Kind::kMax, "f", Fold::kWorst), 2);
  EXPECT_EQ(combined(Goal::Kind::kMin, "f", Fold::kWorst), 27);
  EXPECT_EQ(combined(Goal::Kind::kMin, "f", Fold::kMean), 11);
  EXPECT_NEAR(combined(Goal::Kind::kMin, "f", Fold::kGeomean), 6, 1e-12);
  EXPECT_EQ(combined(Goal::Kind::kBelow, "perf.fps", Fold::kWorst), 2) << "the metric's direction, not the limit's";
  EXPECT_EQ(combined(Goal::Kind::kBelow, "perf.fps", Fold::kEach), 27);
}

TEST(Search, ReadsALimitAgainstTheMetricsDirectionAsTheWorstValue) {
  using Fold = tools::sweep::SetMetric::Kind;
  Search::Options options;
  options.figures = {{0}, {1, 2}};
  const Goal below{Goal::Kind::kBelow, "totals.perf.fps", 100, "", Fold::kWorst};
  EXPECT_FALSE(below.applies_to_each_workload());
  Search search({fours(2), [](const Choice&) { return true; }}, {kMin, below}, options);
  search.add_result({0, 0}, std::vector<double>{5, 90, 200});
  search.add_result({0, 1}, std::vector<double>{5, 110, 200});
  EXPECT_TRUE(search.feasible_scores().contains({0, 0})) << "90 is the worst of both";
  EXPECT_FALSE(search.feasible_scores().contains({0, 1}));
}

TEST(Search, ComparesAGeometricMeanOfZeroWithItsLimit) {
  Search::Options options;
  options.figures = {{0}, {1, 2}};
  const Goal below{Goal::Kind::kBelow, "g", 1, "", tools::sweep::SetMetric::Kind::kGeomean};
  Search search({fours(2), [](const Choice&) { return true; }}, {kMin, below}, options);
  search.add_result({0, 0}, std::vector<double>{5, 0, 200});
  search.add_result({0, 1}, std::vector<double>{5, -1, 200});
  EXPECT_TRUE(search.feasible_scores().contains({0, 0}));
  EXPECT_FALSE(search.feasible_scores().contains({0, 1})) << "there is no geometric mean of negative values";
}

TEST(Search, PointsWithoutAFigureAreNotFeasible) {
  Search::Options options;
  options.figures = {{0}, {1, 2}};
  const Goal above{Goal::Kind::kAbove, "g", 1, ""};
  Search search({fours(2), [](const Choice&) { return true; }}, {kMin, above}, options);
  search.add_partial_result({0, 0}, {5.0, 2.0, std::nullopt}, {}, false);
  EXPECT_TRUE(search.feasible_scores().empty());
  search.add_partial_result({0, 1}, {5.0, 2.0, 3.0}, {}, false);
  EXPECT_EQ(search.feasible_scores().size(), 1U);
  search.replace_result({0, 1}, {5.0, 2.0, 0.5}, {}, false);
  EXPECT_TRUE(search.feasible_scores().empty()) << "whole frames broke the limit";
}

TEST(Acquisition, ComputesTheNormalDistribution) {
  EXPECT_DOUBLE_EQ(log_normal_cdf(0), std::log(0.5));
  EXPECT_NEAR(log_normal_cdf(1.959963984540054), std::log(0.975), 1e-14);
  EXPECT_NEAR(log_normal_cdf(-1.959963984540054), std::log(0.025), 1e-13);
  EXPECT_NEAR(log_normal_cdf(-40), -804.6084420137538, 1e-5);  // Johnson and others: -z^2/2 - log(z sqrt(2 pi)) - ...
}

TEST(Acquisition, IsFiniteIfProbabilitiesUnderflow) {
  for (const double z : {-29.9, -30.1, -38.0, -100.0, -1000.0}) {
    EXPECT_GT(log_normal_cdf(z), log_normal_cdf(z - 0.1)) << z;
    EXPECT_GT(log_expected_gain({z, 1}, 0), log_expected_gain({z - 0.1, 1}, 0)) << z;
    EXPECT_TRUE(std::isfinite(log_expected_gain({z, 1}, 0))) << z;
  }
}

TEST(Acquisition, ExpectsTheMeanGainAboveTheBest) {
  // A normal value at the best one, and far above it.
  EXPECT_NEAR(log_expected_gain({3, 2}, 3), std::log(2 / std::sqrt(2 * std::numbers::pi)), 1e-14);
  EXPECT_NEAR(log_expected_gain({103, 2}, 3), std::log(100), 1e-14);
  EXPECT_NEAR(std::exp(log_expected_gain({2, 1}, 3)), 0.08331547058768617, 1e-14);  // phi(1) - (1 - Phi(1))
}

TEST(Acquisition, IsExactForExactValues) {
  EXPECT_DOUBLE_EQ(log_expected_gain({5, 0}, 3), std::log(2));
  EXPECT_EQ(log_expected_gain({3, 0}, 3), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(log_probability({5, 0}, 3, true), 0);
  EXPECT_EQ(log_probability({5, 0}, 3, false), -std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(log_probability({5, 1}, 5, true), std::log(0.5));
}

const Score kOrigin = {0, 0};

TEST(ParetoFront, HasThePointsThatNoOtherDominates) {
  const std::vector<Score> scores = {{1, 3}, {2, 2}, {1, 2}, {3, 1}, {2, 1}};
  EXPECT_EQ(pareto_front_of(scores), (std::vector<std::size_t>{3, 1, 0})) << "the best in the first objective first";
}

TEST(ParetoFront, HasTheFirstOfEqualPoints) {
  EXPECT_EQ(pareto_front_of(std::vector<Score>{{1, 1}, {1, 1}}), (std::vector<std::size_t>{0}));
}

TEST(ParetoFront, IsTheBestPointOfOneObjective) {
  EXPECT_EQ(pareto_front_of(std::vector<Score>{{1}, {3}, {2}}), (std::vector<std::size_t>{1}));
}

TEST(Hypervolume, IsTheAreaBetweenTheCornerAndTheFront) {
  EXPECT_EQ(hypervolume(std::vector<Score>{{2, 3}}, kOrigin), 6);
  EXPECT_EQ(hypervolume(std::vector<Score>{{1, 3}, {2, 2}, {3, 1}}, kOrigin), 3 + 2 + 1);
  EXPECT_EQ(hypervolume(std::vector<Score>{{3, 1}, {1, 1}, {2, 2}, {1, 3}}, kOrigin), 3 + 2 + 1) << "in any order";
  EXPECT_EQ(hypervolume(std::vector<Score>{{2, 3}}, {1, 1}), 2);
}

TEST(Hypervolume, IgnoresPointsThatAreNotBetterThanTheCorner) {
  EXPECT_EQ(hypervolume(std::vector<Score>{{2, 0}, {0, 2}, {-1, 5}}, kOrigin), 0);
}

TEST(HypervolumeGain, IsTheIncreaseOfTheHypervolume) {
  const std::vector<Score> front = {{1, 4}, {3, 3}, {5, 1}};
  HypervolumeGain gain(kOrigin);
  for (const Score& score : front) gain.add(score);
  for (double x = -0.5; x < 7; x += 0.5) {
    for (double y = -0.5; y < 6; y += 0.5) {
      std::vector<Score> more = front;
      more.push_back({x, y});
      EXPECT_DOUBLE_EQ(gain.gain_of({x, y}), hypervolume(more, kOrigin) - hypervolume(front, kOrigin)) << x << " " << y;
    }
  }
  EXPECT_EQ(gain.gain_of({4, 2}), 1) << "by hand: from 3 to 4, from 1 to 2";
}

}  // namespace
}  // namespace test
