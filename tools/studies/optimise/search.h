#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "tools/studies/optimise/multi_objective.h"
#include "tools/studies/optimise/surrogate.h"
#include "tools/studies/optimise/task.h"

namespace tools::optimise {

/// Search space: its axes, and a predicate for the combinations that may be proposed.
struct Space {
  std::vector<AxisShape> axes;
  std::function<bool(const Choice&)> is_wanted;
};

/// Bayesian optimisation of one or two objectives under constraints. The caller simulates the proposed points.
///
/// 1. The first points are spread over the space.
/// 2. Then a Surrogate of each metric estimates it at all points, and NSGA-II searches the estimates.
/// 3. The points with the largest expected hypervolume gain are proposed.
/// 4. Noise is not optimised: noisy metrics are smoothed, and simulated points count with their smoothed values.
///
/// The same seed and the same results lead to the same points.
class Search {
 public:
  struct Options {
    std::uint64_t seed = 1;
    std::uint32_t population = 40;  ///< population of NSGA-II; a multiple of 4, at least 8
  };
  /// `goals`: one or two objectives, then constraints.
  Search(Space space, std::vector<Goal> goals, const Options& options);

  /// Returns `count` new points without a result; fewer if no others can be found.
  std::vector<Choice> propose_points(std::size_t count);

  /// Adds the metrics of a point, one per goal, or none if it cannot be simulated. `errors`: standard deviations of
  /// noisy metrics; `are_bounds`: they are assumed upper bounds, not measured.
  void add_result(const Choice& point, const std::optional<std::vector<double>>& metrics,
                  const std::vector<double>& errors = {}, bool are_bounds = false);
  /// Adds the approximate metrics of a first look at a point. The point may still be proposed.
  void add_first_look(const Choice& point, const std::vector<double>& metrics);

  /// Scores of the points with a result that meet all constraints.
  const std::map<Choice, Score>& feasible_scores() const { return feasible_scores_; }
  /// Returns the score of a point with these metrics, one per goal.
  Score score_of(const std::vector<double>& metrics) const;

 private:
  class Models;

  bool is_new(const Choice& point) const { return !results_known_.contains(point) && space_.is_wanted(point); }
  Choice draw_point();
  std::vector<Choice> spread_points(std::size_t count);
  void add_random(std::size_t count, std::set<Choice>& points);
  std::vector<Choice> neighbours_of_front() const;
  std::vector<Choice> find_candidates(Models& models, std::size_t count);
  std::vector<Choice> evolve_points(Models& models, double optimism, std::uint64_t seed);

  const Space space_;
  const std::vector<Goal> goals_;
  const Options options_;
  std::size_t objectives_ = 1;
  std::vector<std::size_t> genes_;  ///< axes with more than one value
  std::vector<std::uint32_t> sizes_;
  std::vector<Choice> all_;  ///< all points of a small space

  std::map<Choice, bool> results_known_;  ///< false: it cannot be simulated
  /// By goal: simulated metrics, their errors, and metrics of first looks.
  std::vector<Surrogate::Values> metrics_, errors_, looks_;
  bool errors_are_bounds_ = false;
  std::map<Choice, Score> feasible_scores_;
  std::vector<Surrogate> surrogates_;  ///< one per goal, then one for whether a point can be simulated
  std::uint64_t draws_ = 0;
};

}  // namespace tools::optimise
