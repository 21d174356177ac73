#include "tools/studies/optimise/multi_objective.h"

#include <algorithm>
#include <functional>

#include "sim/io/module.h"

namespace tools::optimise {
namespace {

/// Returns a score with all signs changed, because pagmo minimises.
std::vector<double> negated_scores(const Score& score) {
  std::vector<double> out;
  std::ranges::transform(score, std::back_inserter(out), std::negate<>());
  return out;
}

}  // namespace

const PagmoModule& pagmo_module() {
  static const PagmoModule* const loaded =
      reinterpret_cast<PagmoFactory>(sim::load_module(RAYWATT_SEARCH_MODULE, kPagmoSymbol, "for searches"))();
  return *loaded;
}

std::vector<std::size_t> pareto_front_of(std::span<const Score> scores) {
  std::vector<std::vector<double>> points;
  std::ranges::transform(scores, std::back_inserter(points), negated_scores);
  std::vector<std::size_t> front = pagmo_module().non_dominated(points);
  std::ranges::sort(
      front, [&](std::size_t a, std::size_t b) { return scores[a] != scores[b] ? scores[a] > scores[b] : a < b; });
  const auto equal = std::ranges::unique(front, {}, [&](std::size_t i) { return scores[i]; });
  front.erase(equal.begin(), equal.end());
  return front;
}

double hypervolume(std::span<const Score> scores, const Score& corner) {
  std::vector<std::vector<double>> points;
  for (const Score& score : scores) {
    if (score[0] > corner[0] && score[1] > corner[1]) points.push_back(negated_scores(score));
  }
  return points.empty() ? 0 : pagmo_module().hypervolume(std::move(points), negated_scores(corner));
}

double HypervolumeGain::gain_of(const Score& score) const {
  std::vector<Score> with = front_;
  with.push_back(score);
  return std::max(0.0, hypervolume(with, corner_) - hypervolume_);
}

void HypervolumeGain::add(const Score& score) {
  front_.push_back(score);
  std::vector<Score> front;
  for (const std::size_t i : pareto_front_of(front_)) front.push_back(front_[i]);
  front_ = std::move(front);
  hypervolume_ = hypervolume(front_, corner_);
}

}  // namespace tools::optimise
