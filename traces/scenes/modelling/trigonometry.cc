#include "traces/scenes/modelling/trigonometry.h"

#include <cmath>

namespace traces {
namespace {

/// Returns sin(x) for |x| <= pi / 4 by Taylor's series; the first omitted term is below 1e-10. small_cos() is similar.
double small_sin(double x) {
  const double s = x * x;
  return x * (1 - s / 6 * (1 - s / 20 * (1 - s / 42 * (1 - s / 72))));
}
double small_cos(double x) {
  const double s = x * x;
  return 1 - s / 2 * (1 - s / 12 * (1 - s / 30 * (1 - s / 56 * (1 - s / 90))));
}

}  // namespace

float sin_turns(double turns) {
  constexpr double kQuarter = 1.57079632679489661923;
  const double quarters = std::floor(turns * 4 + 0.5);
  const double rest = (turns * 4 - quarters) * kQuarter;
  const auto quadrant = static_cast<int>(quarters - 4 * std::floor(quarters / 4));
  const double value = quadrant % 2 == 0 ? small_sin(rest) : small_cos(rest);
  return static_cast<float>(quadrant < 2 ? value : -value);
}

float cos_turns(double turns) { return sin_turns(turns + 0.25); }

glm::vec2 circle_point(double turns) { return {cos_turns(turns), sin_turns(turns)}; }

glm::quat axis_rotation(const glm::vec3& axis, double turns) {
  const float s = sin_turns(turns / 2);
  return {cos_turns(turns / 2), axis.x * s, axis.y * s, axis.z * s};
}

}  // namespace traces
