#include "tools/noise/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include <boost/math/distributions/students_t.hpp>

namespace tools {
namespace {

/// Relative noise to assume for frames of at least `pixels` pixels, separately for times and rates, for energies, and
/// for memory traffic.
struct Level {
  double pixels, time, energy, traffic;
};
// source: docs/noise.md; covers 95 % of pairs of runs of the scene whose metrics vary most
constexpr std::array kNoiseLevels = {
    Level{1024 * 512, 0.02, 0.02, 0.10},
    Level{512 * 256, 0.09, 0.05, 0.25},
    Level{0, 0.25, 0.05, 0.25},
};
constexpr std::array kEnergy = {"energy_mj",
                                "energy_by_block_mj",
                                "energy_by_kind_mj",
                                "power_at_fps_w",
                                "perf.frames_per_joule_gpu",
                                "perf.frames_per_joule_tni",
                                "perf.frames_per_joule_per_mm2",
                                "perf.nj_per_ray"};
constexpr std::array kTraffic = {"dram_bytes",
                                 "dram_bytes_by_client",
                                 "relative.dram_bytes",
                                 "utilisation.dram",
                                 "energy_by_block_mj.dram",
                                 "energy_by_block_mj.dma",
                                 "energy_by_block_mj.interconnect"};

/// True if the path of a metric is in `names`, or is inside a group in `names`.
bool is_among(std::string_view figure, const auto& names) {
  return std::ranges::any_of(names, [&](std::string_view name) {
    return figure.starts_with(name) && (figure.size() == name.size() || figure[name.size()] == '.');
  });
}

constexpr double kEndless = std::numeric_limits<double>::infinity();

/// Returns the half-width of the 95 % interval of the difference of two runs, in units of one run's standard deviation.
double half_width_of_pair_in_deviations() { return student_t_quantile(kEndless) * std::sqrt(2.0); }

}  // namespace

double default_noise(double pixels, std::string_view figure) {
  const Level& level = *std::ranges::find_if(kNoiseLevels, [&](const Level& l) { return pixels >= l.pixels; });
  return is_among(figure, kTraffic) ? level.traffic : is_among(figure, kEnergy) ? level.energy : level.time;
}

bool is_noisy(std::string_view figure) { return is_among(figure, kNoisyFigures); }

double replicate_noise(const Draws& draws) {
  return half_width_of_pair_in_deviations() * draws.deviation / std::abs(draws.mean);
}

double MeasuredMetric::standard_error() const {
  return draws ? difference_of(*draws, Draws{1, 0, 0}).error
               : assumed * std::abs(value) / half_width_of_pair_in_deviations();
}

double MeasuredMetric::half_width() const {
  return draws ? draws->half_width() : student_t_quantile(kEndless) * standard_error();
}

MeanDifference difference_of(const MeasuredMetric& a, const MeasuredMetric& b) {
  if (a.draws && b.draws) return difference_of(*a.draws, *b.draws);
  return {b.value - a.value, std::hypot(a.standard_error(), b.standard_error()), kEndless};
}

namespace {

// No long double: it is initialised at program start, and fails under profilers with 64-bit floating point.
using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
using Student = boost::math::students_t_distribution<double, Policy>;

}  // namespace

double student_t_quantile(double degrees, double share) { return boost::math::quantile(Student(degrees), share); }

double student_t_tail(double t, double degrees) {
  return boost::math::cdf(boost::math::complement(Student(degrees), t));
}

double Draws::half_width() const {
  if (count < 2) return 0;
  const auto n = static_cast<double>(count);
  return student_t_quantile(n - 1) * deviation / std::sqrt(n);
}

Draws draw_statistics(std::span<const double> values) {
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

double MeanDifference::one_sided_p_value() const {
  if (error == 0) return value > 0 ? 0 : 1;
  return student_t_tail(value / error, degrees);
}

MeanDifference difference_of(const Draws& a, const Draws& b) {
  const auto of_mean = [](const Draws& d) { return d.deviation * d.deviation / static_cast<double>(d.count); };
  const auto free = [](const Draws& d) { return std::max(1.0, static_cast<double>(d.count) - 1); };
  const double va = of_mean(a), vb = of_mean(b);
  MeanDifference out{b.mean - a.mean, std::sqrt(va + vb), 1};
  if (va + vb > 0) out.degrees = (va + vb) * (va + vb) / (va * va / free(a) + vb * vb / free(b));
  return out;
}

std::vector<bool> reject_hypotheses(std::span<const double> p_values, double error) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return p_values[i]; });
  std::vector<bool> out(p_values.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (p_values[order[k]] * static_cast<double>(order.size() - k) > error) break;
    out[order[k]] = true;
  }
  return out;
}

}  // namespace tools
