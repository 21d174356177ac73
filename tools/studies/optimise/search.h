#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "tools/studies/optimise/multi_objective.h"
#include "tools/studies/optimise/surrogate.h"
#include "tools/studies/optimise/task.h"

namespace tools::optimise {

/// A search space: its axes, and a predicate that is true for combinations of values that may be proposed.
struct Space {
  std::vector<AxisShape> axes;
  std::function<bool(const Choice&)> is_wanted;
};

/// The values of a point's metrics, one per metric and workload; nothing for a value that was not simulated.
using MetricValues = std::vector<std::optional<double>>;

/// Bayesian optimisation of one or two objectives under constraints. The caller simulates the proposed points.
///
/// 1. The first points are spread over the space.
/// 2. Then a Surrogate of each figure (a metric on one workload) estimates it, and NSGA-II searches the estimates.
/// 3. The points with the largest expected hypervolume gain are proposed.
/// 4. Lucky noise is not rewarded: noisy figures are smoothed, and simulated points count with smoothed values.
/// 5. A goal combines its figures by its function over workloads (Goal::combine()).
///
/// The same seed and the same results lead to the same points.
class Search {
 public:
  struct Options {
    std::uint64_t seed = 1;
    std::uint32_t population = 40;  ///< population of NSGA-II; a multiple of 4, at least 8
    /// By goal: indices of the figures that it combines, one or one per workload. Empty: one figure per goal.
    std::vector<std::vector<std::size_t>> figures{};
    /// By figure: computes it exactly without a simulation; null for most. May be shorter than the list of figures.
    std::vector<std::function<double(const Choice&)>> exact{};
  };
  /// `goals`: one or two objectives, then constraints.
  Search(Space space, std::vector<Goal> goals, const Options& options);

  /// Returns `count` points to simulate next. Returns fewer if no other points exist or could be better.
  std::vector<Choice> propose_points(std::size_t count);

  /// Adds the result of a point: all figures, or nothing if it cannot be simulated, which removes an earlier result.
  /// `errors`: standard errors of the figures; `are_bounds`: they are assumed upper bounds, not measured.
  void add_result(const Choice& point, const std::optional<std::vector<double>>& figures,
                  const std::vector<double>& errors = {}, bool are_bounds = false);
  /// Adds the result of a point on some workloads only. A point without results on all workloads is not feasible.
  void add_partial_result(const Choice& point, const MetricValues& figures, const std::vector<double>& errors,
                          bool are_bounds);
  /// Replaces the result of a point by a more accurate one.
  void replace_result(const Choice& point, const MetricValues& figures, const std::vector<double>& errors,
                      bool are_bounds);
  /// Adds the approximate result of a first look at a point. The point may still be proposed.
  void add_first_look(const Choice& point, const MetricValues& figures);

  /// Returns the scores of all simulated points that meet all constraints.
  const std::map<Choice, Score>& feasible_scores() const { return feasible_scores_; }
  /// Returns the score of a point with these values of the goals.
  Score score_of(std::span<const double> values) const;
  /// Returns the points that differ in one axis: by one step of an ordered axis, or by any value of another.
  std::vector<Choice> neighbours_of(const Choice& point) const;
  bool is_wanted(const Choice& point) const { return space_.is_wanted(point); }
  bool is_known(const Choice& point) const { return results_known_.contains(point); }
  /// Fits the surrogates to all results. Returns, for each point, the estimates of all metrics on all workloads;
  /// nothing where there are no results.
  std::vector<std::vector<std::optional<Estimate>>> estimate_figures(std::span<const Choice> points);
  /// Combines the estimates of a goal's metric on each workload into that of the goal; nothing if one is missing.
  std::optional<Estimate> combine_estimates(std::size_t goal, std::span<const std::optional<Estimate>> figures) const;

 private:
  class Models;

  bool is_new(const Choice& point) const { return !results_known_.contains(point) && space_.is_wanted(point); }
  Choice draw_point();
  std::vector<Choice> spread_points(std::size_t count);
  void add_random(std::size_t count, std::set<Choice>& points);
  std::vector<Choice> neighbours_of_front() const;
  std::vector<Choice> find_candidates(Models& models, std::size_t count);
  std::vector<Choice> evolve_points(Models& models, double optimism, std::uint64_t seed);
  bool is_exact(std::size_t figure) const { return figure < options_.exact.size() && options_.exact[figure]; }
  double exact_figure(std::size_t figure, const Choice& point);
  bool has_values(std::size_t figure) const { return is_exact(figure) || !values_[figure].empty(); }
  /// Returns the value of a goal at a simulated point; nothing if a workload that it needs has no result.
  std::optional<double> goal_value(std::size_t goal, const Choice& point) const;

  const Space space_;
  const std::vector<Goal> goals_;
  Options options_;
  std::size_t objectives_ = 1;
  std::vector<std::size_t> genes_;  ///< axes with more than one value
  std::vector<std::uint32_t> sizes_;
  std::vector<Choice> all_;  ///< all points of a small space

  std::map<Choice, bool> results_known_;  ///< simulated points; false: the point cannot be simulated
  /// By figure: simulated values, their errors, and values of first looks (approximate simulations).
  std::vector<Surrogate::Values> values_, errors_, looks_;
  std::vector<std::map<Choice, double>> exact_;  ///< by figure: values computed so far
  bool errors_are_upper_bounds_ = false;
  std::map<Choice, Score> feasible_scores_;
  std::vector<Surrogate> surrogates_;  ///< one per figure, then one that predicts whether a point can be simulated
  std::uint64_t draws_ = 0;
};

}  // namespace tools::optimise
