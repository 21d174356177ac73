#include "tools/studies/optimise/near_front.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tools::optimise {
namespace {

constexpr double kError = 0.05;  // chance of leaving out a point that is as good, for all comparisons together

/// Judge of two points.
class Judge {
 public:
  explicit Judge(const SearchRun& search) {
    for (std::size_t g = 0; g < search.goals().size() && search.goals()[g].is_objective(); ++g) {
      most_.push_back(search.goals()[g].kind == Goal::Kind::kMax);
    }
  }
  std::size_t objectives() const { return most_.size(); }
  /// Is a's own figure better?
  bool is_better(const Trial& a, const Trial& b, std::size_t objective) const {
    return most_[objective] ? a.figures[objective] > b.figures[objective] : a.figures[objective] < b.figures[objective];
  }
  /// Chance that `a` is seen so much better if it is not.
  double chance(const Trial& a, const Trial& b, std::size_t objective) const {
    MeanDifference d = difference_of(b.seen[objective], a.seen[objective]);
    if (!most_[objective]) d.value = -d.value;
    return d.chance_above();
  }
  /// Is `a` better for sure: in each objective that has noise by so much that its chance is no larger than `level`, and
  /// as good in one that has none?
  bool dominates(const Trial& a, const Trial& b, double level) const {
    bool differs = false;
    for (std::size_t o = 0; o < objectives(); ++o) {
      const bool is_better = chance(a, b, o) <= level;
      const bool is_equal = a.seen[o].error() == 0 && b.seen[o].error() == 0 && a.figures[o] == b.figures[o];
      if (!is_better && !is_equal) return false;
      differs = differs || is_better;
    }
    return differs;
  }

 private:
  std::vector<bool> most_;
};

std::vector<const Trial*> ties_with(const Trial& first, const std::vector<const Trial*>& others, const Judge& judge) {
  std::vector<double> chances;
  for (const Trial* other : others) chances.push_back(judge.chance(first, *other, 0));
  const std::vector<bool> worse = rejected(chances, kError);
  std::vector<const Trial*> ties;
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!worse[i]) ties.push_back(others[i]);
  }
  return ties;
}

}  // namespace

std::vector<const Trial*> near_front(const SearchRun& search) {
  const Judge judge(search);
  const std::vector<const Trial*> all = search.feasible(), front = search.pareto_front();
  if (front.empty()) return {};
  std::vector<const Trial*> others, near;
  std::ranges::copy_if(all, std::back_inserter(others),
                       [&](const Trial* t) { return std::ranges::find(front, t) == front.end(); });
  if (judge.objectives() == 1) {
    near = ties_with(*front.front(), others, judge);
  } else {
    const double level = kError / static_cast<double>(all.size());
    std::ranges::copy_if(others, std::back_inserter(near), [&](const Trial* other) {
      return std::ranges::none_of(all, [&](const Trial* t) { return judge.dominates(*t, *other, level); });
    });
  }
  std::ranges::stable_sort(near, [&](const Trial* a, const Trial* b) { return judge.is_better(*a, *b, 0); });
  return near;
}

std::string noise_text(const SearchRun& search) {
  std::vector<std::string> parts, shares, assumed;
  const auto add = [](std::vector<std::string>& all, std::string text) {
    if (std::ranges::find(all, text) == all.end()) all.push_back(std::move(text));
  };
  for (const Trial* trial : search.feasible()) {
    for (std::size_t g = 0; g < search.goals().size() && search.goals()[g].is_objective(); ++g) {
      const SeenFigure& seen = trial->seen[g];
      if (seen.draws) add(parts, fmt::format("noise measured by {} replicates a point", seen.draws->count));
      if (seen.assumed <= 0) continue;
      const std::string share = fmt::format("{:.2g} %", 100 * seen.assumed);
      add(shares, share);
      add(assumed, fmt::format("{} of {}", share, search.goals()[g].figure));
    }
  }
  if (!assumed.empty()) {
    parts.push_back(fmt::format("a noise of {}, assumed for this size of picture; 'replicates' in the file measure it",
                                shares.size() == 1 ? shares.front() : fmt::format("{}", fmt::join(assumed, " and "))));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace tools::optimise
