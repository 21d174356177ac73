#include "tools/noise/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tools {
namespace {

/// Noise of frames of so many pixels or more.
struct Level {
  double pixels, noise;
};
constexpr std::array kLevels = {
    Level{1024 * 512, 0.02},  // source: docs/first-run.md, "read a difference of less than 2 % as none"
    Level{512 * 256, 0.05},   // source: chosen, between the two others; docs/noise.md has what was measured
    Level{0, 0.10},           // source: docs/first-run.md and DEVIATIONS M1, up to 10 % at 256x128
};

}  // namespace

double default_noise(double pixels) {
  return std::ranges::find_if(kLevels, [&](const Level& level) { return pixels >= level.pixels; })->noise;
}

bool is_noisy(std::string_view figure) {
  return std::ranges::any_of(kNoisyFigures, [&](std::string_view name) {
    return figure.starts_with(name) && (figure.size() == name.size() || figure[name.size()] == '.');
  });
}

MeanDifference difference_of(const AssumedDraw& a, const AssumedDraw& b) {
  const double endless = std::numeric_limits<double>::infinity();
  const double draws = student_t(endless) * std::sqrt(2.0);  // deviations of one run in the noise of a difference
  return {b.value - a.value, std::hypot(a.noise * a.value, b.noise * b.value) / draws, endless};
}

double SeenFigure::error() const {
  return draws ? difference_of(*draws, Draws{1, 0, 0}).error : difference_of(AssumedDraw{value, assumed}, {}).error;
}

double SeenFigure::half_width() const {
  return draws ? draws->half_width() : student_t(std::numeric_limits<double>::infinity()) * error();
}

MeanDifference difference_of(const SeenFigure& a, const SeenFigure& b) {
  if (a.draws && b.draws) return difference_of(*a.draws, *b.draws);
  return {b.value - a.value, std::hypot(a.error(), b.error()), std::numeric_limits<double>::infinity()};
}

}  // namespace tools
