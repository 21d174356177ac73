#pragma once
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace tools::optimise {

/// The worth of a point: one number an objective, one or two of them, more is better in each.
using Score = std::vector<double>;

/// Those that no other is at least as good as in all and better in one, the best in the first objective first. Of equal
/// ones the first.
std::vector<std::size_t> pareto_front_of(std::span<const Score> scores);

/// The space between `corner` and the Pareto front of `scores`: an area, or a length for one objective. A score that is
/// not better than the corner adds nothing.
double hypervolume(std::span<const Score> scores, const Score& corner);

/// How much a score would add to the hypervolume of a front, which grows.
class Gain {
 public:
  explicit Gain(Score corner) : corner_(std::move(corner)) {}
  double of(const Score& score) const;
  void add(const Score& score);

 private:
  std::vector<Score> pareto_front_;  ///< the best in the first objective first
  Score corner_;
};

}  // namespace tools::optimise
