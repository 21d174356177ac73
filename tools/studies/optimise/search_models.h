#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "tools/studies/optimise/acquisition.h"
#include "tools/studies/optimise/search.h"

namespace tools::optimise {

constexpr double kCorner = -0.1;     // reference point of the hypervolume: a little worse than the worst, which is at 0
constexpr double kCuriosity = 1e-6;  // for what is uncertain, if nothing promises a gain

/// Nodes and weights of a Gauss-Hermite quadrature over a normal distribution.
constexpr std::array<double, 5> kNodes = {-2.8569700138728056, -1.3556261799742657, 0, 1.3556261799742657,
                                          2.8569700138728056};
constexpr std::array<double, 5> kWeights = {0.0112574113277207, 0.2220759220056126, 0.5333333333333333,
                                            0.2220759220056126, 0.0112574113277207};

/// Estimates from all results that the search has, and what each other point promises.
///
/// 1. Figures of all points are modelled, feasible or not. Scores are scaled by the range of all of them, so that the
///    scale exists whether no point is feasible, or one, or many.
/// 2. As long as no point is feasible, a point promises its probability to be feasible.
/// 3. After that it promises this probability times the gain that is expected of it: of one objective the improvement
///    over the best feasible point in closed form, of two the hypervolume by quadrature.
/// 4. A point that is chosen counts as its estimate for the rest of the batch, as feasible if that is likely.
class Search::Models {
 public:
  explicit Models(Search& search) : search_(search), gain_(Score(search.objectives_, kCorner)) {
    for (std::size_t g = 0; g < search.goals_.size(); ++g) {
      search.surrogates_[g].fit(search.figures_[g], search.looks_[g], search.errors_[g], search.errors_are_bounds_);
    }
    any_failed_ = std::ranges::any_of(search.told_, [](const auto& told) { return !told.second; });
    if (any_failed_) {
      Surrogate::Values computable;
      for (const auto& [point, had_figures] : search.told_) computable.emplace(point, had_figures ? 1 : 0);
      search.surrogates_.back().fit(computable, {});
    }
    set_range();
    for (const auto& [point, score] : search.scores_) {
      std::vector<Estimate> figures;
      for (std::size_t o = 0; o < search.objectives_; ++o) figures.push_back({smoothed(point, o), 0});
      add_feasible({figures, 0});
    }
  }

  struct Estimated {
    std::vector<Estimate> figures;  ///< objectives, as the surrogates have them
    double log_feasible = 0;  ///< logarithm of the probability that the point can be computed and meets all constraints
  };

  const Estimated& at(const Choice& point) {
    const auto [entry, is_new] = estimated_.try_emplace(point);
    Estimated& e = entry->second;
    if (!is_new) return e;
    for (std::size_t g = 0; g < search_.goals_.size(); ++g) {
      const Goal& goal = search_.goals_[g];
      const Surrogate& surrogate = search_.surrogates_[g];
      const Estimate estimate = surrogate.at(point);
      if (goal.is_objective()) {
        e.figures.push_back(estimate);
      } else {
        e.log_feasible += log_probability(estimate, surrogate.forward(goal.limit), !goal.is_upper());
      }
    }
    if (any_failed_) e.log_feasible += log_probability(search_.surrogates_.back().at(point), 0.5, true);
    return e;
  }

  /// The score if the figure is better than its mean by a number of deviations: 0 to 1 within the range of known ones.
  double score(const Estimated& e, std::size_t objective, double deviations) const {
    const Estimate& figure = e.figures[objective];
    const double better = figure.mean + (is_max(objective) ? 1 : -1) * deviations * figure.deviation;
    return (upward(search_.surrogates_[objective].inverse(better), objective) - low_[objective]) / range_[objective];
  }

  /// Half the distance between what the score may well be at most and at least.
  double uncertainty(const Estimated& e) const {
    double sum = 0;
    for (std::size_t o = 0; o < e.figures.size(); ++o) sum += std::abs(score(e, o, 1) - score(e, o, -1)) / 2;
    return sum;
  }

  /// Returns the logarithm of a point's acquisition value, by rules 2 and 3 of the class.
  double log_promise(const Choice& point) {
    const Estimated& e = at(point);
    if (!has_feasible_) return e.log_feasible;
    if (search_.objectives_ == 1) {
      const Estimate& figure = e.figures[0];
      return e.log_feasible + log_expected_gain({upward(figure.mean, 0), figure.deviation}, best_);
    }
    double gain = 0;
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      for (std::size_t j = 0; j < kNodes.size(); ++j) {
        gain += kWeights[i] * kWeights[j] * gain_.of({score(e, 0, kNodes[i]), score(e, 1, kNodes[j])});
      }
    }
    return e.log_feasible + std::log(gain + kCuriosity * uncertainty(e));
  }

  /// Adds the point with the figures that are expected of it (Kriging believer).
  void believe(const Choice& point) {
    if (const Estimated& e = at(point); e.log_feasible >= std::log(0.5)) add_feasible(e);
    for (std::size_t g = 0; g < search_.surrogates_.size(); ++g) {
      if (g == search_.goals_.size() && !any_failed_) continue;
      Surrogate& surrogate = search_.surrogates_[g];
      surrogate.believe(point, surrogate.at(point).mean);
    }
    estimated_.clear();
  }

 private:
  bool is_max(std::size_t objective) const { return search_.goals_[objective].kind == Goal::Kind::kMax; }
  /// A figure, or the surrogate's value of it, so that more is better.
  double upward(double value, std::size_t objective) const { return is_max(objective) ? value : -value; }

  /// The figure of a simulated point, as its surrogate has it; where noise moves it, what the estimates make of it.
  double smoothed(const Choice& point, std::size_t objective) const {
    const Surrogate& surrogate = search_.surrogates_[objective];
    if (search_.errors_[objective].contains(point)) return surrogate.at(point).mean;
    return surrogate.forward(search_.figures_[objective].at(point));
  }

  void add_feasible(const Estimated& e) {
    has_feasible_ = true;
    if (search_.objectives_ == 2) return gain_.add({score(e, 0, 0), score(e, 1, 0)});
    best_ = std::max(best_, upward(e.figures[0].mean, 0));
  }

  void set_range() {
    for (std::size_t o = 0; o < search_.objectives_; ++o) {
      std::vector<double> values;
      for (const auto& [point, figure] : search_.figures_[o]) values.push_back(upward(figure, o));
      const auto [least, most] = std::ranges::minmax(values);
      low_.push_back(least);
      range_.push_back(most > least ? most - least : 1);
    }
  }

  Search& search_;
  bool any_failed_ = false;
  std::vector<double> low_, range_;  ///< of the scores of all points that have figures
  bool has_feasible_ = false;
  double best_ = -std::numeric_limits<double>::infinity();  ///< of feasible points; upward() in a single objective
  Gain gain_;
  std::map<Choice, Estimated> estimated_;
};

}  // namespace tools::optimise
