#include "tools/studies/optimise/search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <vector>

#include <boost/math/special_functions/erf.hpp>

#include "sim/hash.h"
#include "tools/studies/optimise/multi_objective.h"
#include "tools/studies/optimise/surrogate.h"
#include "tools/studies/sweep/spec/plan.h"

namespace tools::optimise {

constexpr double kCorner = -0.1;             // reference point of the hypervolume; the worst score is 0
constexpr double kUncertaintyWeight = 1e-6;  // for points without expected gain

/// Nodes and weights of a Gauss-Hermite quadrature over a normal distribution.
constexpr std::array<double, 5> kNodes = {-2.8569700138728056, -1.3556261799742657, 0, 1.3556261799742657,
                                          2.8569700138728056};
constexpr std::array<double, 5> kWeights = {0.0112574113277207, 0.2220759220056126, 0.5333333333333333,
                                            0.2220759220056126, 0.0112574113277207};

/// Number of quasi-random draws that estimate a goal that combines several workloads.
constexpr std::size_t kCombinationDraws = 128;

/// Returns a quasi-random standard normal number, from the van der Corput sequence in the base kPrimes[dimension].
double normal_draw(std::size_t draw, std::size_t dimension) {
  constexpr std::array<std::size_t, 12> kPrimes = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  const std::size_t base = kPrimes.at(dimension);
  double share = 0, weight = 1;
  for (std::size_t n = draw + 1; n != 0; n /= base) {
    weight /= static_cast<double>(base);
    share += weight * static_cast<double>(n % base);
  }
  // No long double: boost initialises it at program start, which fails under profilers with 64-bit floating point.
  using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  return std::numbers::sqrt2 * boost::math::erf_inv(2 * share - 1, Policy());
}

/// Surrogates fitted to all results, and the acquisition value of each point.
///
/// 1. The models use the results of all points, feasible or not. Scores are scaled by their range over all points, so
///    that the scale does not depend on how many points are feasible.
/// 2. While no simulated point is feasible, the acquisition value of a point is the probability that it is feasible.
/// 3. After that it is this probability times the expected gain. For one objective, the gain is the improvement over
///    the best feasible point, in closed form. For two, it is the hypervolume gain, by quadrature.
/// 4. A point chosen for a batch counts as simulated with its estimate when the next one is chosen. It counts as
///    feasible if that is likely.
/// 5. A goal that combines several workloads is estimated by random draws, independent for each workload.
class Search::Models {
 public:
  explicit Models(Search& search) : search_(search), gain_(Score(search.objectives_, kCorner)) {
    for (std::size_t f = 0; f < search.values_.size(); ++f) {
      if (search.is_exact(f) || search.values_[f].empty()) continue;
      search.surrogates_[f].fit(search.values_[f], search.looks_[f], search.errors_[f],
                                search.errors_are_upper_bounds_);
    }
    any_failed_ = std::ranges::any_of(search.results_known_, [](const auto& result) { return !result.second; });
    if (any_failed_) {
      Surrogate::Values computable;
      for (const auto& [point, had_figures] : search.results_known_) computable.emplace(point, had_figures ? 1 : 0);
      search.surrogates_.back().fit(computable, {});
    }
    set_range();
    for (const auto& [point, score] : search.feasible_scores_) {
      std::vector<Estimate> metrics;
      for (std::size_t o = 0; o < search.objectives_; ++o) metrics.push_back({smoothed_goal(point, o), 0});
      add_feasible({metrics, 0});
    }
  }

  struct Estimated {
    std::vector<Estimate> metrics;      ///< estimates of the objectives, on the scale of their models
    double log_feasible = 0;            ///< log probability that the point can be simulated and meets all constraints
    std::optional<double> log_value{};  ///< logarithm of the acquisition value, computed when it is first needed
  };

  Estimated& estimate_at(const Choice& point) {
    const auto [entry, is_new] = estimated_.try_emplace(point);
    Estimated& e = entry->second;
    if (!is_new) return e;
    for (std::size_t g = 0; g < search_.goals_.size(); ++g) {
      const Goal& goal = search_.goals_[g];
      if (goal.is_objective()) {
        e.metrics.push_back(estimate_goal(g, point));
      } else {
        e.log_feasible += log_probability_of(g, point);
      }
    }
    if (any_failed_) e.log_feasible += log_probability(search_.surrogates_.back().estimate_at(point), 0.5, true);
    return e;
  }

  /// Returns the score of an objective that is better than its estimated mean by `deviations` standard deviations.
  /// Scores of simulated points range from 0 to 1.
  double score_at(const Estimated& e, std::size_t objective, double deviations) const {
    const Estimate& metric = e.metrics[objective];
    const double better = metric.mean + (is_max(objective) ? 1 : -1) * deviations * metric.deviation;
    return (negate_if_minimised(from_goal_scale(objective, better), objective) - low_[objective]) / range_[objective];
  }

  /// Returns half of the difference between the scores at +1 and -1 standard deviations, summed over objectives.
  double score_uncertainty(const Estimated& e) const {
    double sum = 0;
    for (std::size_t o = 0; o < e.metrics.size(); ++o) sum += std::abs(score_at(e, o, 1) - score_at(e, o, -1)) / 2;
    return sum;
  }

  /// Returns the logarithm of the acquisition value of a point.
  double log_acquisition_value(const Choice& point) {
    Estimated& e = estimate_at(point);
    if (!e.log_value) e.log_value = e.log_feasible + (has_feasible_ ? log_gain(e) : 0);
    return *e.log_value;
  }

  /// Returns the estimate of a figure (a metric on one workload) in the metric's unit; nothing if it has no results.
  std::optional<Estimate> plain_estimate(std::size_t figure, const Choice& point) const {
    if (!search_.has_values(figure)) return std::nullopt;
    const Estimate e = estimate_figure(figure, point);
    const double low = from_figure_scale(figure, e.mean - e.deviation),
                 high = from_figure_scale(figure, e.mean + e.deviation);
    return Estimate{from_figure_scale(figure, e.mean), (high - low) / 2};
  }

  /// Treats the point as if it had been simulated, with its estimates as results (Kriging believer).
  void assume_estimate(const Choice& point) {
    if (const Estimated& e = estimate_at(point); e.log_feasible >= std::log(0.5)) add_feasible(e);
    for (std::size_t f = 0; f < search_.surrogates_.size(); ++f) {
      const bool is_fitted = f == search_.values_.size() ? any_failed_ : !search_.values_[f].empty();
      if (!is_fitted || search_.is_exact(f)) continue;
      Surrogate& surrogate = search_.surrogates_[f];
      surrogate.add_pseudo_observation(point, surrogate.estimate_at(point).mean);
    }
    estimated_.clear();
  }

 private:
  const std::vector<std::size_t>& figures_of(std::size_t goal) const { return search_.options_.figures[goal]; }

  /// Returns the estimate of a figure (a metric on one workload) on its model's scale, which may be logarithmic.
  Estimate estimate_figure(std::size_t figure, const Choice& point) const {
    if (search_.is_exact(figure)) return {search_.exact_figure(figure, point), 0};
    return search_.surrogates_[figure].estimate_at(point);
  }
  double from_figure_scale(std::size_t figure, double value) const {
    return search_.is_exact(figure) ? value : search_.surrogates_[figure].from_model_scale(value);
  }
  double to_figure_scale(std::size_t figure, double value) const {
    return search_.is_exact(figure) ? value : search_.surrogates_[figure].to_model_scale(value);
  }
  // A goal of one figure has the scale of the figure's model; a goal that combines workloads has the metric's unit.
  double from_goal_scale(std::size_t goal, double value) const {
    const std::vector<std::size_t>& figures = figures_of(goal);
    return figures.size() == 1 ? from_figure_scale(figures.front(), value) : value;
  }
  double to_goal_scale(std::size_t goal, double value) const {
    const std::vector<std::size_t>& figures = figures_of(goal);
    return figures.size() == 1 ? to_figure_scale(figures.front(), value) : value;
  }

  bool has_values(std::size_t goal) const {
    return std::ranges::all_of(figures_of(goal), [&](std::size_t f) { return search_.has_values(f); });
  }

  /// Returns the estimate of a goal on the goal's scale (rule 5).
  Estimate estimate_goal(std::size_t goal, const Choice& point) const {
    const std::vector<std::size_t>& figures = figures_of(goal);
    if (!has_values(goal)) return {0, 1};
    if (figures.size() == 1) return estimate_figure(figures.front(), point);
    std::vector<Estimate> each;
    for (const std::size_t f : figures) each.push_back(estimate_figure(f, point));
    double sum = 0, sum2 = 0;
    std::vector<double> drawn(each.size());
    for (std::size_t draw = 0; draw < kCombinationDraws; ++draw) {
      for (std::size_t i = 0; i < each.size(); ++i) {
        drawn[i] =
            from_figure_scale(figures[i], each[i].mean + each[i].deviation * normal_draws_[draw][i % kDimensions]);
      }
      const double value = search_.goals_[goal].combine(drawn).value_or(0);
      sum += value;
      sum2 += value * value;
    }
    const double mean = sum / kCombinationDraws;
    return {mean, std::sqrt(std::max(sum2 / kCombinationDraws - mean * mean, 0.0))};
  }

  /// Returns the log probability that a constraint is met at a point. Metrics without any result are ignored.
  double log_probability_of(std::size_t g, const Choice& point) const {
    const Goal& goal = search_.goals_[g];
    if (figures_of(g).size() > 1 && !goal.applies_to_each_workload()) {
      return has_values(g)
                 ? log_probability(estimate_goal(g, point), to_goal_scale(g, goal.limit), !goal.is_upper_limit())
                 : 0;
    }
    double sum = 0;
    for (const std::size_t f : figures_of(g)) {
      if (!search_.has_values(f)) continue;
      sum += log_probability(estimate_figure(f, point), to_figure_scale(f, goal.limit), !goal.is_upper_limit());
    }
    return sum;
  }

  /// Returns the logarithm of the expected gain (rule 3).
  double log_gain(const Estimated& e) const {
    if (search_.objectives_ == 1) {
      return log_expected_gain({negate_if_minimised(e.metrics[0].mean, 0), e.metrics[0].deviation}, best_);
    }
    double gain = 0;
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      for (std::size_t j = 0; j < kNodes.size(); ++j) {
        gain += kWeights[i] * kWeights[j] * gain_.gain_of({score_at(e, 0, kNodes[i]), score_at(e, 1, kNodes[j])});
      }
    }
    return std::log(gain + kUncertaintyWeight * score_uncertainty(e));
  }

  bool is_max(std::size_t objective) const { return search_.goals_[objective].kind == Goal::Kind::kMax; }
  /// Returns the value, negated if the objective is minimised.
  double negate_if_minimised(double value, std::size_t objective) const { return is_max(objective) ? value : -value; }

  /// Returns an objective's value at a simulated point, on the goal's scale. A noisy value is replaced by its estimate.
  double smoothed_goal(const Choice& point, std::size_t objective) const {
    const auto is_noisy = [&](std::size_t f) { return search_.errors_[f].contains(point); };
    if (std::ranges::any_of(figures_of(objective), is_noisy)) return estimate_goal(objective, point).mean;
    return to_goal_scale(objective, search_.goal_value(objective, point).value());
  }

  void add_feasible(const Estimated& e) {
    has_feasible_ = true;
    if (search_.objectives_ == 2) return gain_.add({score_at(e, 0, 0), score_at(e, 1, 0)});
    best_ = std::max(best_, negate_if_minimised(e.metrics[0].mean, 0));
  }

  void set_range() {
    for (std::size_t o = 0; o < search_.objectives_; ++o) {
      std::vector<double> values;
      for (const auto& [point, had_figures] : search_.results_known_) {
        const auto value = had_figures ? search_.goal_value(o, point) : std::nullopt;
        if (value) values.push_back(negate_if_minimised(*value, o));
      }
      const auto [least, most] =
          values.empty() ? std::ranges::minmax_result<double>{0, 0} : std::ranges::minmax(values);
      low_.push_back(least);
      range_.push_back(most > least ? most - least : 1);
    }
  }

  static constexpr std::size_t kDimensions = 12;
  using NormalDraws = std::array<std::array<double, kDimensions>, kCombinationDraws>;
  static const NormalDraws& normal_draws() {
    static const NormalDraws kDraws = [] {
      NormalDraws draws{};
      for (std::size_t d = 0; d < kCombinationDraws; ++d) {
        for (std::size_t i = 0; i < kDimensions; ++i) draws[d][i] = normal_draw(d, i);
      }
      return draws;
    }();
    return kDraws;
  }

  Search& search_;
  const NormalDraws& normal_draws_ = normal_draws();
  bool any_failed_ = false;
  /// By objective: lowest value (negated if minimised) and range of the values, over all points with results.
  std::vector<double> low_, range_;
  bool has_feasible_ = false;
  double best_ = -std::numeric_limits<double>::infinity();  ///< best value of a single objective over feasible points,
                                                            ///< negated if minimised
  HypervolumeGain gain_;
  std::map<Choice, Estimated> estimated_;
};

namespace {

constexpr std::uint64_t kSmallSpace = 1U << 12;  // number of points up to which all points of a space are candidates
constexpr std::uint64_t kMostDraws = 1U << 20;   // attempts to draw a valid point of a larger space
constexpr std::uint32_t kGenerations = 30;       // generations of NSGA-II
constexpr std::size_t kRandom = 32;              // random candidates, in addition to those of NSGA-II
constexpr std::size_t kRanked = 64;  // best candidates, which are evaluated again after each choice for a batch
constexpr double kForbidden = 1e9, kKnown = 1e6, kInfeasible = 3;  // penalties; scores are about 0 to 1
constexpr double kHopeless = 1e5;  // upper bound of the fitness of a new point, because NSGA-II needs finite numbers

/// Orders points by a hash of the seed, so that ties do not favour a corner of the space.
void shuffle_points(std::vector<Choice>& points, std::uint64_t seed) {
  std::ranges::sort(points, {}, [&](const Choice& point) {
    std::uint64_t h = seed;
    for (const std::uint32_t value : point) h = sim::hash(h, value);
    return std::pair(h, point);
  });
}

/// Returns a penalty of 0 to 1 for a point that may break limits. `log_feasible`: logarithm of the probability that it
/// meets all limits. The penalty is 0 from the probability on that a normal variable is `optimism` deviations above its
/// mean.
double infeasibility_penalty(double log_feasible, double optimism) {
  const double short_of = std::max(log_normal_cdf(-optimism) - log_feasible, 0.0);
  return std::isfinite(short_of) ? short_of / (1 + short_of) : 1;
}

}  // namespace

Search::Search(Space space, std::vector<Goal> goals, const Options& options)
    : space_(std::move(space)), goals_(std::move(goals)), options_(options) {
  objectives_ = static_cast<std::size_t>(std::ranges::count_if(goals_, &Goal::is_objective));
  std::size_t count = 0;
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    if (options_.figures.size() <= g) options_.figures.push_back({g});
    for (const std::size_t f : options_.figures[g]) count = std::max(count, f + 1);
  }
  values_.resize(count);
  errors_.resize(count);
  looks_.resize(count);
  exact_.resize(count);
  for (std::size_t f = 0; f <= count; ++f) surrogates_.emplace_back(space_.axes);
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    if (goals_[g].is_objective() || goals_[g].limit > 0) continue;
    for (const std::size_t f : options_.figures[g]) surrogates_[f].forbid_log();
  }
  std::uint64_t points = 1;
  for (std::size_t a = 0; a < space_.axes.size(); ++a) {
    sizes_.push_back(space_.axes[a].values);
    if (sizes_.back() > 1) genes_.push_back(a);
    points = std::min(points * sizes_.back(), 2 * kSmallSpace);
  }
  if (points <= kSmallSpace) all_ = sweep::choose_combinations({}, sizes_, space_.is_wanted);
}

Score Search::score_of(std::span<const double> values) const {
  Score score;
  for (std::size_t o = 0; o < objectives_; ++o) {
    score.push_back(goals_[o].kind == Goal::Kind::kMax ? values[o] : -values[o]);
  }
  return score;
}

std::optional<double> Search::goal_value(std::size_t goal, const Choice& point) const {
  std::vector<double> values;
  for (const std::size_t f : options_.figures[goal]) {
    const auto found = values_[f].find(point);
    if (found == values_[f].end()) return std::nullopt;
    values.push_back(found->second);
  }
  return goals_[goal].combine(values);
}

double Search::exact_figure(std::size_t figure, const Choice& point) {
  const auto [entry, is_new] = exact_[figure].try_emplace(point);
  if (is_new) entry->second = options_.exact[figure](point);
  return entry->second;
}

void Search::add_result(const Choice& point, const std::optional<std::vector<double>>& figures,
                        const std::vector<double>& errors, bool are_bounds) {
  if (figures) return add_partial_result(point, {figures->begin(), figures->end()}, errors, are_bounds);
  results_known_.insert_or_assign(point, false);
  for (Surrogate::Values& values : values_) values.erase(point);
  feasible_scores_.erase(point);
}

void Search::add_partial_result(const Choice& point, const MetricValues& figures, const std::vector<double>& errors,
                                bool are_bounds) {
  if (results_known_.emplace(point, true).second) replace_result(point, figures, errors, are_bounds);
}

void Search::replace_result(const Choice& point, const MetricValues& figures, const std::vector<double>& errors,
                            bool are_bounds) {
  errors_are_upper_bounds_ = errors_are_upper_bounds_ || are_bounds;
  for (std::size_t f = 0; f < values_.size(); ++f) {
    if (!figures.at(f)) continue;
    values_[f][point] = *figures[f];
    errors_[f].erase(point);
    if (!errors.empty() && errors.at(f) > 0) errors_[f].emplace(point, errors[f]);
  }
  bool is_feasible = true;
  std::vector<double> values;
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    const std::optional<double> value = goal_value(g, point);
    is_feasible = is_feasible && value && goals_[g].is_met(*value);
    values.push_back(value.value_or(0));
  }
  feasible_scores_.erase(point);
  if (is_feasible) feasible_scores_.emplace(point, score_of(values));
}

void Search::add_first_look(const Choice& point, const MetricValues& figures) {
  for (std::size_t f = 0; f < looks_.size(); ++f) {
    if (figures.at(f)) looks_[f].emplace(point, *figures[f]);
  }
}

/// Draws a random combination of axis values, which need not be allowed (Space::is_wanted).
Choice Search::draw_point() {
  Choice point(sizes_.size());
  ++draws_;
  for (std::size_t a = 0; a < sizes_.size(); ++a) {
    point[a] = static_cast<std::uint32_t>(((sim::hash(options_.seed, draws_, a) >> 32) * sizes_[a]) >> 32);
  }
  return point;
}

void Search::add_random(std::size_t count, std::set<Choice>& points) {
  const auto add = [&](const Choice& point) {
    if (is_new(point) && points.insert(point).second) --count;
  };
  for (std::uint64_t d = 0; d < (all_.empty() ? kMostDraws : 4 * count) && count != 0; ++d) add(draw_point());
  if (count == 0 || all_.empty()) return;
  std::vector<std::size_t> order(all_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::uint64_t seed = sim::hash(options_.seed, ++draws_);
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::pair(sim::hash(seed, i), i); });
  for (std::size_t i = 0; i < order.size() && count != 0; ++i) add(all_[order[i]]);
}

/// Returns the first points of a search: two opposite corners of the space and a Latin hypercube.
std::vector<Choice> Search::spread_points(std::size_t count) {
  std::set<Choice> points;
  Choice low(sizes_.size(), 0), high = low;
  for (std::size_t a = 0; a < sizes_.size(); ++a) high[a] = sizes_[a] - 1;
  for (const Choice& corner : {low, high}) {
    if (points.size() < count && is_new(corner)) points.insert(corner);
  }
  if (points.size() < count) {
    const sweep::Subset subset{sweep::Subset::Kind::kLatinHypercube, count - points.size(),
                               sim::hash(options_.seed, results_known_.size())};
    for (const Choice& point : sweep::choose_combinations(subset, sizes_, space_.is_wanted)) {
      if (points.size() < count && is_new(point)) points.insert(point);
    }
  }
  add_random(count - points.size(), points);
  return {points.begin(), points.end()};
}

std::vector<Choice> Search::neighbours_of(const Choice& point) const {
  std::vector<Choice> near;
  for (const std::size_t a : genes_) {
    const std::uint32_t here = point[a];
    for (std::uint32_t value = 0; value < sizes_[a]; ++value) {
      const bool is_next = value + 1 == here || value == here + 1;
      if (value == here || (space_.axes[a].ordered && !is_next)) continue;
      near.push_back(point);
      near.back()[a] = value;
    }
  }
  return near;
}

std::vector<Choice> Search::neighbours_of_front() const {
  std::vector<Choice> points, near;
  std::vector<Score> scores;
  for (const auto& [point, score] : feasible_scores_) {
    points.push_back(point);
    scores.push_back(score);
  }
  for (const std::size_t i : pareto_front_of(scores))
    std::ranges::move(neighbours_of(points[i]), std::back_inserter(near));
  return near;
}

/// Runs NSGA-II on the estimates. With one objective, the acquisition value is the second objective of NSGA-II, so that
/// it finds both good and uncertain points.
std::vector<Choice> Search::evolve_points(Models& models, double optimism, std::uint64_t seed) {
  if (genes_.empty()) return {};
  const auto to_point = [&](const Choice& genes) {
    Choice point(sizes_.size(), 0);
    for (std::size_t g = 0; g < genes_.size(); ++g) point[genes_[g]] = genes[g];
    return point;
  };
  GeneticTask task;
  for (const std::size_t a : genes_) task.values.push_back(sizes_[a]);
  task.generations = kGenerations;
  task.seed = static_cast<std::uint32_t>(sim::hash(options_.seed, results_known_.size(), seed));
  task.fitness = [&](std::span<const Choice> generation) {
    std::vector<double> fitness;
    for (const Choice& genes : generation) {
      const Choice point = to_point(genes);
      const Models::Estimated& e = models.estimate_at(point);
      const double known = !space_.is_wanted(point) ? kForbidden : results_known_.contains(point) ? kKnown : 0;
      const double penalty = known + kInfeasible * infeasibility_penalty(e.log_feasible, optimism);
      fitness.push_back(objectives_ == 2 ? penalty - models.score_at(e, 0, optimism)
                                         : known + std::min(-models.log_acquisition_value(point), kHopeless));
      fitness.push_back(penalty - models.score_at(e, objectives_ - 1, optimism));
    }
    return fitness;
  };
  std::vector<Choice> begin = neighbours_of_front();
  std::erase_if(begin, [&](const Choice& point) { return !is_new(point); });
  shuffle_points(begin, task.seed);
  begin.resize(std::min<std::size_t>(begin.size(), options_.population / 2));
  while (begin.size() < options_.population) begin.push_back(draw_point());
  for (const Choice& point : begin) {
    Choice genes;
    for (const std::size_t a : genes_) genes.push_back(point[a]);
    task.first_generation.push_back(std::move(genes));
  }
  std::vector<Choice> points;
  for (const Choice& genes : pagmo_module().run_nsga2(task)) points.push_back(to_point(genes));
  return points;
}

/// Returns the candidates among which the next points are chosen. In a small space these are all points; else points of
/// NSGA-II, neighbours of the front and random points.
std::vector<Choice> Search::find_candidates(Models& models, std::size_t count) {
  std::set<Choice> points;
  const auto add = [&](const std::vector<Choice>& more) {
    std::ranges::copy_if(more, std::inserter(points, points.end()), [&](const Choice& p) { return is_new(p); });
  };
  if (!all_.empty()) {
    add(all_);
  } else {
    add(evolve_points(models, 0, 0));
    add(evolve_points(models, 1.5, 1));
    add(neighbours_of_front());
    add_random(std::max(kRandom, count), points);
  }
  return {points.begin(), points.end()};
}

std::vector<Choice> Search::propose_points(std::size_t count) {
  if (std::ranges::all_of(values_, &Surrogate::Values::empty)) return spread_points(count);
  Models models(*this);
  std::vector<Choice> open = find_candidates(models, count), chosen;
  shuffle_points(open, sim::hash(options_.seed, results_known_.size()));
  const auto log_value = [&](const Choice& point) { return models.log_acquisition_value(point); };
  std::ranges::stable_sort(open, std::greater{}, log_value);
  open.resize(std::min(open.size(), std::max(kRanked, count)));
  while (chosen.size() < count && !open.empty()) {
    const auto best = std::ranges::max_element(open, {}, log_value);
    if (std::isinf(log_value(*best)) && !options_.exact.empty()) break;  // no other point can be better
    models.assume_estimate(*best);
    chosen.push_back(*best);
    open.erase(best);
  }
  return chosen;
}

std::optional<Estimate> Search::combine_estimates(std::size_t goal,
                                                  std::span<const std::optional<Estimate>> figures) const {
  std::vector<double> means;
  double variance = 0;
  for (const std::size_t f : options_.figures[goal]) {
    if (!figures[f]) return std::nullopt;
    means.push_back(figures[f]->mean);
    variance = std::max(variance, figures[f]->deviation * figures[f]->deviation);
  }
  const std::optional<double> mean = goals_[goal].combine(means);
  return mean ? std::optional(Estimate{*mean, std::sqrt(variance)}) : std::nullopt;
}

std::vector<std::vector<std::optional<Estimate>>> Search::estimate_figures(std::span<const Choice> points) {
  const Models models(*this);
  std::vector<std::vector<std::optional<Estimate>>> all;
  for (const Choice& point : points) {
    std::vector<std::optional<Estimate>>& figures = all.emplace_back();
    for (std::size_t f = 0; f < values_.size(); ++f) figures.push_back(models.plain_estimate(f, point));
  }
  return all;
}

}  // namespace tools::optimise
