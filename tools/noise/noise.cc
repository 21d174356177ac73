#include "tools/noise/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tools {
namespace {

/// Noise of frames with at least `pixels` pixels: of time and rates, of energy, of memory traffic.
struct Level {
  double pixels, time, energy, traffic;
};
// source: docs/noise.md, 95 % of pairs of runs of the scene whose figures vary most
constexpr std::array kNoiseLevels = {
    Level{1024 * 512, 0.02, 0.02, 0.10},
    Level{512 * 256, 0.09, 0.05, 0.25},
    Level{0, 0.25, 0.05, 0.25},
};
constexpr std::array kEnergy = {"energy_mj",
                                "energy_by_block_mj",
                                "energy_by_kind_mj",
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

/// True if the figure is one of `names` or below one of them.
bool is_among(std::string_view figure, const auto& names) {
  return std::ranges::any_of(names, [&](std::string_view name) {
    return figure.starts_with(name) && (figure.size() == name.size() || figure[name.size()] == '.');
  });
}

constexpr double kEndless = std::numeric_limits<double>::infinity();

/// Returns the half-width of a 95 % interval in standard deviations of one run, for a difference of two runs.
double deviations_of_pair() { return student_t(kEndless) * std::sqrt(2.0); }

}  // namespace

double default_noise(double pixels, std::string_view figure) {
  const Level& level = *std::ranges::find_if(kNoiseLevels, [&](const Level& l) { return pixels >= l.pixels; });
  return is_among(figure, kTraffic) ? level.traffic : is_among(figure, kEnergy) ? level.energy : level.time;
}

bool is_noisy(std::string_view figure) { return is_among(figure, kNoisyFigures); }

double noise_of_pair(const Draws& draws) { return deviations_of_pair() * draws.deviation / std::abs(draws.mean); }

double SeenFigure::standard_error() const {
  return draws ? difference_of(*draws, Draws{1, 0, 0}).error : assumed * std::abs(value) / deviations_of_pair();
}

double SeenFigure::half_width() const { return draws ? draws->half_width() : student_t(kEndless) * standard_error(); }

MeanDifference difference_of(const SeenFigure& a, const SeenFigure& b) {
  if (a.draws && b.draws) return difference_of(*a.draws, *b.draws);
  return {b.value - a.value, std::hypot(a.standard_error(), b.standard_error()), kEndless};
}

}  // namespace tools
