#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "tools/studies/optimise/search.h"

namespace tools::optimise {

constexpr double kCorner = -0.1;     // reference point of the hypervolume: a little worse than the worst, which is at 0
constexpr double kCuriosity = 1e-6;  // for what is uncertain, if nothing promises a gain

/// Nodes and weights of a Gauss-Hermite quadrature over a normal distribution.
constexpr std::array<double, 5> kNodes = {-2.8569700138728056, -1.3556261799742657, 0, 1.3556261799742657,
                                          2.8569700138728056};
constexpr std::array<double, 5> kWeights = {0.0112574113277207, 0.2220759220056126, 0.5333333333333333,
                                            0.2220759220056126, 0.0112574113277207};

inline double probability_below(const Estimate& estimate, double limit) {
  if (!(estimate.deviation > 0)) return estimate.mean < limit ? 1 : 0;
  return 0.5 * std::erfc((estimate.mean - limit) / estimate.deviation / std::sqrt(2.0));
}

/// Estimates from all that the search has been told.
class Search::Models {
 public:
  explicit Models(Search& search) : search_(search), gain_(Score(search.objectives_, kCorner)) {
    for (std::size_t g = 0; g < search.goals_.size(); ++g) {
      search.surrogates_[g].fit(search.figures_[g], search.looks_[g], search.errors_[g]);
    }
    any_failed_ = std::ranges::any_of(search.told_, [](const auto& told) { return !told.second; });
    if (any_failed_) {
      Surrogate::Values computable;
      for (const auto& [point, had_figures] : search.told_) computable.emplace(point, had_figures ? 1 : 0);
      search.surrogates_.back().fit(computable, {});
    }
    set_range();
    for (const auto& [point, score] : search.scores_) gain_.add(normalised(smoothed(point)));
  }

  /// The worth of a point that was told: where noise moves its figures, what the estimates make of them.
  Score smoothed(const Choice& point) const {
    std::vector<double> figures(search_.objectives_);
    for (std::size_t o = 0; o < figures.size(); ++o) {
      const Surrogate& surrogate = search_.surrogates_[o];
      const bool noisy = search_.errors_[o].contains(point);
      figures[o] = noisy ? surrogate.inverse(surrogate.at(point).mean) : search_.figures_[o].at(point);
    }
    return search_.score_of(figures);
  }

  /// 0 to 1 within the range of what is known.
  Score normalised(const Score& score) const {
    Score out;
    for (std::size_t o = 0; o < score.size(); ++o) {
      const double range = best_[o] - worst_[o];
      out.push_back(range > 0 ? (score[o] - worst_[o]) / range : 0);
    }
    return out;
  }

  struct Estimated {
    std::vector<Estimate> figures;  ///< objectives, as the surrogates have them
    double feasible = 1;            ///< how probable it is that the point can be computed and meets all constraints
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
        // The logarithm of a limit below 0 is none; such a figure is above it.
        const double limit = surrogate.forward(goal.limit);
        const double below = std::isnan(limit) ? 0 : probability_below(estimate, limit);
        e.feasible *= goal.is_upper() ? below : 1 - below;
      }
    }
    if (any_failed_) e.feasible *= 1 - probability_below(search_.surrogates_.back().at(point), 0.5);
    return e;
  }

  /// The normalised score if each figure is so many deviations better than its mean.
  double score(const Estimated& e, std::size_t objective, double deviations) const {
    const bool is_max = search_.goals_[objective].kind == Goal::Kind::kMax;
    const Estimate& estimate = e.figures[objective];
    const double figure =
        search_.surrogates_[objective].inverse(estimate.mean + (is_max ? 1 : -1) * deviations * estimate.deviation);
    const double range = best_[objective] - worst_[objective];
    return range > 0 ? ((is_max ? figure : -figure) - worst_[objective]) / range : 0;
  }

  /// Half the distance between what the score may well be at most and at least.
  double uncertainty(const Estimated& e) const {
    double sum = 0;
    for (std::size_t o = 0; o < e.figures.size(); ++o) sum += std::abs(score(e, o, 1) - score(e, o, -1)) / 2;
    return sum;
  }

  /// Hypervolume that the point is expected to add; what is most likely to be feasible, as long as nothing is.
  double promise(const Choice& point) {
    const Estimated& e = at(point);
    if (search_.scores_.empty()) return e.feasible + kCuriosity * uncertainty(e);
    double gain = 0;
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      if (search_.objectives_ == 1) {
        gain += kWeights[i] * gain_.of({score(e, 0, kNodes[i])});
        continue;
      }
      for (std::size_t j = 0; j < kNodes.size(); ++j) {
        gain += kWeights[i] * kWeights[j] * gain_.of({score(e, 0, kNodes[i]), score(e, 1, kNodes[j])});
      }
    }
    return e.feasible * (gain + kCuriosity * uncertainty(e));
  }

  /// Adds the point with the figures that are expected of it (Kriging believer).
  void believe(const Choice& point) {
    const Estimated e = at(point);
    if (e.feasible >= 0.5) {
      Score mean;
      for (std::size_t o = 0; o < e.figures.size(); ++o) mean.push_back(score(e, o, 0));
      gain_.add(mean);
    }
    for (std::size_t g = 0; g < search_.surrogates_.size(); ++g) {
      if (g == search_.goals_.size() && !any_failed_) continue;
      Surrogate& surrogate = search_.surrogates_[g];
      surrogate.believe(point, surrogate.at(point).mean);
    }
    estimated_.clear();
  }

 private:
  void set_range() {
    const auto add = [&](const Score& score) {
      if (best_.empty()) best_ = worst_ = score;
      for (std::size_t o = 0; o < score.size(); ++o) {
        best_[o] = std::max(best_[o], score[o]);
        worst_[o] = std::min(worst_[o], score[o]);
      }
    };
    for (const auto& [point, score] : search_.scores_) add(smoothed(point));
    if (!search_.scores_.empty()) return;
    for (const auto& [point, first] : search_.figures_.front()) {
      std::vector<double> figures;
      for (const Surrogate::Values& values : search_.figures_) figures.push_back(values.at(point));
      add(search_.score_of(figures));
    }
  }

  Search& search_;
  bool any_failed_ = false;
  Score best_, worst_;
  Gain gain_;
  std::map<Choice, Estimated> estimated_;
};

}  // namespace tools::optimise
