#include "tools/noise/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <boost/math/distributions/students_t.hpp>

namespace tools {
namespace {

// long double would be initialised when the program starts, and fails under profilers with 64-bit floating point.
using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using Student = boost::math::students_t_distribution<double, Policy>;

}  // namespace

double student_t(double degrees, double share) { return boost::math::quantile(Student(degrees), share); }

double student_t_above(double t, double degrees) {
  return boost::math::cdf(boost::math::complement(Student(degrees), t));
}

double Draws::half_width() const {
  if (count < 2) return 0;
  const auto n = static_cast<double>(count);
  return student_t(n - 1) * deviation / std::sqrt(n);
}

Draws draws_of(std::span<const double> values) {
  Draws draws{values.size(), 0, 0};
  if (values.empty()) return draws;
  const auto n = static_cast<double>(values.size());
  draws.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  if (values.size() == 1) return draws;
  double squares = 0;
  for (const double value : values) squares += (value - draws.mean) * (value - draws.mean);
  draws.deviation = std::sqrt(squares / (n - 1));
  return draws;
}

double MeanDifference::chance_above() const {
  if (error == 0) return value > 0 ? 0 : 1;
  return student_t_above(value / error, degrees);
}

MeanDifference difference_of(const Draws& a, const Draws& b) {
  const auto of_mean = [](const Draws& d) { return d.deviation * d.deviation / static_cast<double>(d.count); };
  const auto free = [](const Draws& d) { return std::max(1.0, static_cast<double>(d.count) - 1); };
  const double va = of_mean(a), vb = of_mean(b);
  MeanDifference out{b.mean - a.mean, std::sqrt(va + vb), 1};
  if (va + vb > 0) out.degrees = (va + vb) * (va + vb) / (va * va / free(a) + vb * vb / free(b));
  return out;
}

std::vector<bool> reject_hypotheses(std::span<const double> chances, double error) {
  std::vector<std::size_t> order(chances.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return chances[i]; });
  std::vector<bool> out(chances.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (chances[order[k]] * static_cast<double>(order.size() - k) > error) break;
    out[order[k]] = true;
  }
  return out;
}

}  // namespace tools
