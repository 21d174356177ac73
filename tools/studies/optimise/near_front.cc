#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/studies/optimise/answer.h"

namespace tools::optimise {
namespace {

constexpr double kError = 0.05;  // family-wise error: probability that a point as good as the front is left out

/// Compares simulated points under noise.
class Comparator {
 public:
  explicit Comparator(const SearchRun& search) {
    for (std::size_t g = 0; g < search.goals().size() && search.goals()[g].is_objective(); ++g) {
      most_.push_back(search.goals()[g].kind == Goal::Kind::kMax);
    }
  }
  std::size_t objective_count() const { return most_.size(); }
  /// True if the value of an objective is better for `a` than for `b`, ignoring noise.
  bool is_better(const Trial& a, const Trial& b, std::size_t objective) const {
    return most_[objective] ? a.value(objective) > b.value(objective) : a.value(objective) < b.value(objective);
  }
  /// Returns the p-value of "`a` is better than `b`" under the null hypothesis that it is not.
  double p_value(const Trial& a, const Trial& b, std::size_t objective) const {
    MeanDifference d = difference_of(*b.seen[objective], *a.seen[objective]);
    if (!most_[objective]) d.value = -d.value;
    return d.one_sided_p_value();
  }
  /// True if `a` is significantly better than `b` (p <= `level`) in each objective, or equal in an exact one.
  bool dominates_beyond_noise(const Trial& a, const Trial& b, double level) const {
    bool differs = false;
    for (std::size_t o = 0; o < objective_count(); ++o) {
      const bool is_better = p_value(a, b, o) <= level;
      const bool is_equal =
          a.seen[o]->standard_error() == 0 && b.seen[o]->standard_error() == 0 && a.value(o) == b.value(o);
      if (!is_better && !is_equal) return false;
      differs = differs || is_better;
    }
    return differs;
  }

 private:
  std::vector<bool> most_;
};

std::vector<const Trial*> ties_with(const Trial& first, const std::vector<const Trial*>& others,
                                    const Comparator& comparator) {
  std::vector<double> chances;
  for (const Trial* other : others) chances.push_back(comparator.p_value(first, *other, 0));
  const std::vector<bool> worse = reject_hypotheses(chances, kError);
  std::vector<const Trial*> ties;
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!worse[i]) ties.push_back(others[i]);
  }
  return ties;
}

}  // namespace

/// Returns feasible points within noise of the Pareto front, but not on it; the best in the first objective first. One
/// objective: points not significantly worse than the best (one-sided tests, Holm, 5 % family-wise error). Two: points
/// that no other dominates significantly (Bonferroni).
std::vector<const Trial*> near_front(const SearchRun& search) {
  const Comparator comparator(search);
  const std::vector<const Trial*> all = search.feasible_trials(), front = search.pareto_front();
  if (front.empty()) return {};
  std::vector<const Trial*> others, near;
  std::ranges::copy_if(all, std::back_inserter(others),
                       [&](const Trial* t) { return std::ranges::find(front, t) == front.end(); });
  if (comparator.objective_count() == 1) {
    near = ties_with(*front.front(), others, comparator);
  } else {
    const double level = kError / static_cast<double>(all.size());
    std::ranges::copy_if(others, std::back_inserter(near), [&](const Trial* other) {
      return std::ranges::none_of(all,
                                  [&](const Trial* t) { return comparator.dominates_beyond_noise(*t, *other, level); });
    });
  }
  std::ranges::stable_sort(near, [&](const Trial* a, const Trial* b) { return comparator.is_better(*a, *b, 0); });
  return near;
}

/// Names the source of the noise of the objectives: "noise measured by 5 replicates per run"; empty without noise.
std::string noise_text(const SearchRun& search) {
  std::vector<std::string> parts, shares, assumed;
  const auto add = [](std::vector<std::string>& all, std::string text) {
    if (std::ranges::find(all, text) == all.end()) all.push_back(std::move(text));
  };
  for (const Trial* trial : search.feasible_trials()) {
    for (std::size_t g = 0; g < search.goals().size() && search.goals()[g].is_objective(); ++g) {
      const MeasuredMetric& seen = *trial->seen[g];
      if (seen.draws) add(parts, fmt::format("noise measured by {} replicates per run", seen.draws->count));
      if (seen.assumed <= 0) continue;
      const std::string share = fmt::format("{:.2g} %", 100 * seen.assumed);
      add(shares, share);
      add(assumed, fmt::format("{} of {}", share, search.goals()[g].metric_text()));
    }
  }
  if (!assumed.empty()) {
    parts.push_back(fmt::format("noise of {} is assumed; set `replicates:` in the search file to measure it",
                                shares.size() == 1 ? shares.front() : fmt::format("{}", fmt::join(assumed, " and "))));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace tools::optimise
