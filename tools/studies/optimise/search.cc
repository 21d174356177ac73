#include "tools/studies/optimise/search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <vector>

#include "sim/hash.h"
#include "tools/studies/optimise/multi_objective.h"
#include "tools/studies/optimise/surrogate.h"
#include "tools/studies/sweep/spec/plan.h"

namespace tools::optimise {

constexpr double kCorner = -0.1;     // reference point of the hypervolume; the worst score is 0
constexpr double kCuriosity = 1e-6;  // weight of the uncertainty, which decides if no gain is expected

/// Nodes and weights of a Gauss-Hermite quadrature over a normal distribution.
constexpr std::array<double, 5> kNodes = {-2.8569700138728056, -1.3556261799742657, 0, 1.3556261799742657,
                                          2.8569700138728056};
constexpr std::array<double, 5> kWeights = {0.0112574113277207, 0.2220759220056126, 0.5333333333333333,
                                            0.2220759220056126, 0.0112574113277207};

/// Surrogates fitted to all results, and the acquisition value of each point.
///
/// 1. The metrics of all points are modelled, feasible or not. Scores are scaled by the range over all points, so that
///    the scale does not depend on how many points are feasible.
/// 2. Until a point is feasible, the acquisition value is the probability of being feasible.
/// 3. After that it is this probability times the expected gain: for one objective the improvement over the best
///    feasible point in closed form, for two the hypervolume gain by quadrature.
/// 4. A chosen point counts with its estimate for the rest of the batch, as feasible if that is likely.
class Search::Models {
 public:
  explicit Models(Search& search) : search_(search), gain_(Score(search.objectives_, kCorner)) {
    for (std::size_t g = 0; g < search.goals_.size(); ++g) {
      search.surrogates_[g].fit(search.metrics_[g], search.looks_[g], search.errors_[g], search.errors_are_bounds_);
    }
    any_failed_ = std::ranges::any_of(search.results_known_, [](const auto& result) { return !result.second; });
    if (any_failed_) {
      Surrogate::Values computable;
      for (const auto& [point, had_metrics] : search.results_known_) computable.emplace(point, had_metrics ? 1 : 0);
      search.surrogates_.back().fit(computable, {});
    }
    set_range();
    for (const auto& [point, score] : search.feasible_scores_) {
      std::vector<Estimate> metrics;
      for (std::size_t o = 0; o < search.objectives_; ++o) metrics.push_back({smoothed_metric(point, o), 0});
      add_feasible({metrics, 0});
    }
  }

  struct Estimated {
    std::vector<Estimate> metrics;      ///< estimates of the objectives, on the scale of their surrogates
    double log_feasible = 0;            ///< log probability that the point can be simulated and meets all constraints
    std::optional<double> log_value{};  ///< the logarithm of the acquisition value, if it was needed
  };

  Estimated& estimate_at(const Choice& point) {
    const auto [entry, is_new] = estimated_.try_emplace(point);
    Estimated& e = entry->second;
    if (!is_new) return e;
    for (std::size_t g = 0; g < search_.goals_.size(); ++g) {
      const Goal& goal = search_.goals_[g];
      const Surrogate& surrogate = search_.surrogates_[g];
      const Estimate estimate = surrogate.estimate_at(point);
      if (goal.is_objective()) {
        e.metrics.push_back(estimate);
      } else {
        e.log_feasible += log_probability(estimate, surrogate.to_model_scale(goal.limit), !goal.is_upper());
      }
    }
    if (any_failed_) e.log_feasible += log_probability(search_.surrogates_.back().estimate_at(point), 0.5, true);
    return e;
  }

  /// Returns the score of a metric that is better than its estimated mean by `deviations` standard deviations. Scores
  /// of simulated points range from 0 to 1.
  double score_at(const Estimated& e, std::size_t objective, double deviations) const {
    const Estimate& metric = e.metrics[objective];
    const double better = metric.mean + (is_max(objective) ? 1 : -1) * deviations * metric.deviation;
    return (as_maximised(search_.surrogates_[objective].from_model_scale(better), objective) - low_[objective]) /
           range_[objective];
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

  /// Adds the point with its expected metrics (Kriging believer).
  void assume_estimate(const Choice& point) {
    if (const Estimated& e = estimate_at(point); e.log_feasible >= std::log(0.5)) add_feasible(e);
    for (std::size_t g = 0; g < search_.surrogates_.size(); ++g) {
      if (g == search_.goals_.size() && !any_failed_) continue;
      Surrogate& surrogate = search_.surrogates_[g];
      surrogate.add_pseudo_observation(point, surrogate.estimate_at(point).mean);
    }
    estimated_.clear();
  }

 private:
  /// Returns the logarithm of the expected gain: the improvement over the best feasible point, or the hypervolume gain.
  double log_gain(const Estimated& e) const {
    if (search_.objectives_ == 1) {
      return log_expected_gain({as_maximised(e.metrics[0].mean, 0), e.metrics[0].deviation}, best_);
    }
    double gain = 0;
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      for (std::size_t j = 0; j < kNodes.size(); ++j) {
        gain += kWeights[i] * kWeights[j] * gain_.gain_of({score_at(e, 0, kNodes[i]), score_at(e, 1, kNodes[j])});
      }
    }
    return std::log(gain + kCuriosity * score_uncertainty(e));
  }

  bool is_max(std::size_t objective) const { return search_.goals_[objective].kind == Goal::Kind::kMax; }
  /// Returns the value, negated if the objective is minimised.
  double as_maximised(double value, std::size_t objective) const { return is_max(objective) ? value : -value; }

  /// Returns the metric of a simulated point on the scale of its surrogate; a noisy one is replaced by its estimate.
  double smoothed_metric(const Choice& point, std::size_t objective) const {
    const Surrogate& surrogate = search_.surrogates_[objective];
    if (search_.errors_[objective].contains(point)) return surrogate.estimate_at(point).mean;
    return surrogate.to_model_scale(search_.metrics_[objective].at(point));
  }

  void add_feasible(const Estimated& e) {
    has_feasible_ = true;
    if (search_.objectives_ == 2) return gain_.add({score_at(e, 0, 0), score_at(e, 1, 0)});
    best_ = std::max(best_, as_maximised(e.metrics[0].mean, 0));
  }

  void set_range() {
    for (std::size_t o = 0; o < search_.objectives_; ++o) {
      std::vector<double> values;
      for (const auto& [point, metric] : search_.metrics_[o]) values.push_back(as_maximised(metric, o));
      const auto [least, most] = std::ranges::minmax(values);
      low_.push_back(least);
      range_.push_back(most > least ? most - least : 1);
    }
  }

  Search& search_;
  bool any_failed_ = false;
  /// By objective: lowest score, and range of the scores, over all points with metrics.
  std::vector<double> low_, range_;
  bool has_feasible_ = false;
  double best_ = -std::numeric_limits<double>::infinity();  ///< best value of a single objective over feasible points,
                                                            ///< negated if minimised
  HypervolumeGain gain_;
  std::map<Choice, Estimated> estimated_;
};

namespace {

constexpr std::uint64_t kSmallSpace = 1U << 12;  // up to this size all points are candidates
constexpr std::uint64_t kMostDraws = 1U << 20;   // attempts to draw a valid point of a larger space
constexpr std::uint32_t kGenerations = 30;       // generations of NSGA-II
constexpr std::size_t kRandom = 32;              // random candidates, in addition to those of NSGA-II
constexpr std::size_t kRanked = 64;              // candidates rated again after each choice of a batch
constexpr double kForbidden = 1e9, kKnown = 1e6, kInfeasible = 3;  // penalties; scores are about 0 to 1
constexpr double kHopeless = 1e5;  // largest fitness of a new point; NSGA-II needs finite numbers

/// Orders points by a hash of the seed, so that ties do not favour a corner of the space.
void shuffle_points(std::vector<Choice>& points, std::uint64_t seed) {
  std::ranges::sort(points, {}, [&](const Choice& point) {
    std::uint64_t h = seed;
    for (const std::uint32_t value : point) h = sim::hash(h, value);
    return std::pair(h, point);
  });
}

/// Returns a penalty of 0 to 1; 0 if the point is feasible at `optimism` standard deviations.
double infeasibility_penalty(double log_feasible, double optimism) {
  const double short_of = std::max(log_normal_cdf(-optimism) - log_feasible, 0.0);
  return std::isfinite(short_of) ? short_of / (1 + short_of) : 1;
}

}  // namespace

Search::Search(Space space, std::vector<Goal> goals, const Options& options)
    : space_(std::move(space)),
      goals_(std::move(goals)),
      options_(options),
      metrics_(goals_.size()),
      errors_(goals_.size()),
      looks_(goals_.size()) {
  objectives_ = static_cast<std::size_t>(std::ranges::count_if(goals_, &Goal::is_objective));
  for (std::size_t g = 0; g <= goals_.size(); ++g) surrogates_.emplace_back(space_.axes);
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    if (!goals_[g].is_objective() && !(goals_[g].limit > 0)) surrogates_[g].forbid_log();
  }
  std::uint64_t points = 1;
  for (std::size_t a = 0; a < space_.axes.size(); ++a) {
    sizes_.push_back(space_.axes[a].values);
    if (sizes_.back() > 1) genes_.push_back(a);
    points = std::min(points * sizes_.back(), 2 * kSmallSpace);
  }
  if (points <= kSmallSpace) all_ = sweep::choose_combinations({}, sizes_, space_.is_wanted);
}

Score Search::score_of(const std::vector<double>& metrics) const {
  Score score;
  for (std::size_t o = 0; o < objectives_; ++o) {
    score.push_back(goals_[o].kind == Goal::Kind::kMax ? metrics[o] : -metrics[o]);
  }
  return score;
}

void Search::add_result(const Choice& point, const std::optional<std::vector<double>>& metrics,
                        const std::vector<double>& errors, bool are_bounds) {
  if (!results_known_.emplace(point, metrics.has_value()).second || !metrics) return;
  errors_are_bounds_ = errors_are_bounds_ || are_bounds;
  bool is_feasible = true;
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    metrics_[g].emplace(point, metrics->at(g));
    if (!errors.empty() && errors.at(g) > 0) errors_[g].emplace(point, errors[g]);
    is_feasible = is_feasible && goals_[g].is_met(metrics->at(g));
  }
  if (is_feasible) feasible_scores_.emplace(point, score_of(*metrics));
}

void Search::add_first_look(const Choice& point, const std::vector<double>& metrics) {
  for (std::size_t g = 0; g < goals_.size(); ++g) looks_[g].emplace(point, metrics.at(g));
}

/// Draws a random combination of axis values, which may be invalid.
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

std::vector<Choice> Search::neighbours_of_front() const {
  std::vector<Choice> points, near;
  std::vector<Score> scores;
  for (const auto& [point, score] : feasible_scores_) {
    points.push_back(point);
    scores.push_back(score);
  }
  for (const std::size_t i : pareto_front_of(scores)) {
    for (const std::size_t a : genes_) {
      const std::uint32_t here = points[i][a];
      for (std::uint32_t value = 0; value < sizes_[a]; ++value) {
        const bool is_next = value + 1 == here || value == here + 1;
        if (value == here || (space_.axes[a].ordered && !is_next)) continue;
        near.push_back(points[i]);
        near.back()[a] = value;
      }
    }
  }
  return near;
}

/// Runs NSGA-II on the estimates. A search with one objective uses the acquisition value as a second one, so that both
/// good and uncertain points are found.
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

/// Returns the candidates: all points of a small space; of a large one those of NSGA-II, neighbours of the front and
/// random ones.
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
  if (metrics_.front().empty()) return spread_points(count);
  Models models(*this);
  std::vector<Choice> open = find_candidates(models, count), chosen;
  shuffle_points(open, sim::hash(options_.seed, results_known_.size()));
  const auto log_value = [&](const Choice& point) { return models.log_acquisition_value(point); };
  std::ranges::stable_sort(open, std::greater{}, log_value);
  open.resize(std::min(open.size(), std::max(kRanked, count)));
  while (chosen.size() < count && !open.empty()) {
    const auto best = std::ranges::max_element(open, {}, log_value);
    models.assume_estimate(*best);
    chosen.push_back(*best);
    open.erase(best);
  }
  return chosen;
}

}  // namespace tools::optimise
