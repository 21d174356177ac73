#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "tools/studies/optimise/goal.h"
#include "tools/studies/optimise/pareto_front.h"
#include "tools/studies/optimise/surrogate.h"

namespace tools::optimise {

/// The space that is searched.
struct Space {
  std::vector<AxisShape> axes;
  std::function<bool(const Choice&)> is_wanted;
};

/// Finds good points of a space from few of them. Does not compute any: proposes points, and is told their figures.
///
/// The first points are spread over the space. Then each figure is estimated everywhere from what is known (Surrogate),
/// NSGA-II searches these estimates, and of all that it brings those points are proposed from which most hypervolume is
/// expected. What noise moves is not hunted: figures are smoothed by their errors, and points that were told are worth
/// what the estimates make of them. The same seed and the same answers lead to the same choices.
class Search {
 public:
  struct Options {
    std::uint64_t seed = 1;
    std::uint32_t population = 40;  ///< NSGA-II's; a multiple of 4, at least 8
  };
  /// `goals`: one or two objectives, then constraints.
  Search(Space space, std::vector<Goal> goals, const Options& options);

  /// Different points of which nothing has been told; fewer than `count` only if no others can be found.
  std::vector<Choice> propose(std::size_t count);

  /// Adds a point's figures, one for each goal, or none if it cannot be computed. `errors`: standard deviations of
  /// noisy figures; `are_bounds`: they are assumed upper bounds, not measured.
  void tell(const Choice& point, const std::optional<std::vector<double>>& figures,
                     const std::vector<double>& errors = {}, bool are_bounds = false);
  /// The same, roughly: the point may still be proposed.
  void tell_look(const Choice& point, const std::vector<double>& figures);

  /// Scores of the points told so far that meet all constraints.
  const std::map<Choice, Score>& scores() const { return scores_; }
  /// The score of any figures.
  Score score_of(const std::vector<double>& figures) const;

 private:
  class Models;

  bool is_new(const Choice& point) const { return !told_.contains(point) && space_.is_wanted(point); }
  Choice draw();
  std::vector<Choice> spread(std::size_t count);
  void add_random(std::size_t count, std::set<Choice>& points);
  std::vector<Choice> neighbours_of_front() const;
  std::vector<Choice> candidates(Models& models, std::size_t count);
  std::vector<Choice> evolve(Models& models, double optimism, std::uint64_t seed);

  const Space space_;
  const std::vector<Goal> goals_;
  const Options options_;
  std::size_t objectives_ = 1;
  std::vector<std::size_t> genes_;  ///< axes with more than one value
  std::vector<std::uint32_t> sizes_;
  std::vector<Choice> all_;  ///< points of a space that is small

  std::map<Choice, bool> told_;                              ///< had it figures?
  std::vector<Surrogate::Values> figures_, errors_, looks_;  ///< for each goal
  bool errors_are_bounds_ = false;
  std::map<Choice, Score> scores_;
  std::vector<Surrogate> surrogates_;  ///< for each goal, then for whether a point can be computed
  std::uint64_t draws_ = 0;
};

}  // namespace tools::optimise
