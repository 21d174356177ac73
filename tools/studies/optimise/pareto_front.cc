#include "tools/studies/optimise/pareto_front.h"

#include <algorithm>
#include <numeric>

namespace tools::optimise {

std::vector<std::size_t> pareto_front_of(std::span<const Score> scores) {
  std::vector<std::size_t> order(scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    if (front.empty() || scores[i].back() > scores[front.back()].back()) front.push_back(i);
  }
  return front;
}

double hypervolume(std::span<const Score> scores, const Score& corner) {
  Gain gain(corner);
  double sum = 0;
  for (const Score& score : scores) {
    sum += gain.of(score);
    gain.add(score);
  }
  return sum;
}

double Gain::of(const Score& score) const {
  for (std::size_t o = 0; o < score.size(); ++o) {
    if (!(score[o] > corner_[o])) return 0;
  }
  if (score.size() == 1)
    return pareto_front_.empty() ? score[0] - corner_[0] : std::max(0.0, score[0] - pareto_front_.front()[0]);
  // From the right: behind where a step of the front ends, the front is as high as that step.
  double area = 0, floor = corner_[1], right = score[0];
  for (const Score& step : pareto_front_) {
    const double end = std::max(step[0], corner_[0]);
    if (end < right) {
      area += (right - end) * (score[1] - floor);
      right = end;
    }
    if (step[1] >= score[1]) return area;
    floor = std::max(floor, step[1]);
  }
  return area + (right - corner_[0]) * (score[1] - floor);
}

void Gain::add(const Score& score) {
  if (of(score) == 0) return;
  pareto_front_.push_back(score);
  std::vector<Score> kept;
  for (const std::size_t i : pareto_front_of(pareto_front_)) kept.push_back(pareto_front_[i]);
  pareto_front_ = std::move(kept);
}

}  // namespace tools::optimise
