#include "traces/scenes/modelling/turned.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces {

Outline& Outline::line(float radius, float height) {
  points_.emplace_back(radius, height);
  return *this;
}

Outline& Outline::arc(float radius, float height, float bulge) {
  constexpr int kSteps = 12;
  const glm::vec2 a = points_.back(), b(radius, height);
  const glm::vec2 along = glm::normalize(b - a);
  const glm::vec2 middle = 0.5F * (a + b) + 2 * bulge * glm::vec2(along.y, -along.x);
  for (int k = 1; k <= kSteps; ++k) {
    const float t = static_cast<float>(k) / kSteps, s = 1 - t;
    points_.push_back(s * s * a + 2 * s * t * middle + t * t * b);
  }
  points_.back() = b;
  return *this;
}

Outline& Outline::round(const glm::vec2& centre, float radius, double from, double to) {
  constexpr int kSteps = 16;
  for (int k = 0; k <= kSteps; ++k) {
    const glm::vec2 p = centre + radius * on_circle(from + (to - from) * k / kSteps);
    if (glm::length(p - points_.back()) > 1e-6F) points_.emplace_back(std::max(p.x, 0.0F), p.y);
  }
  return *this;
}

std::vector<glm::vec2> simplified(std::vector<glm::vec2> points, std::size_t count) {
  while (points.size() > std::max<std::size_t>(count, 2)) {
    // Removes the point whose triangle with its neighbours is smallest (Visvalingam).
    std::size_t smallest = 1;
    float least = -1;
    for (std::size_t k = 1; k + 1 < points.size(); ++k) {
      const glm::vec2 a = points[k] - points[k - 1], b = points[k + 1] - points[k - 1];
      const float area = std::abs(a.x * b.y - a.y * b.x);
      if (least < 0 || area < least) least = area, smallest = k;
    }
    points.erase(points.begin() + static_cast<std::ptrdiff_t>(smallest));
  }
  return points;
}

Mesh make_turned(std::string name, const std::vector<glm::vec2>& profile, std::uint32_t segments,
                 const std::function<glm::vec3(float around, std::size_t k, const glm::vec3& point)>& shape) {
  const auto rows = static_cast<std::uint32_t>(profile.size() - 1);
  return make_surface(
      std::move(name), segments, rows,
      [&](float s, float t) {
        const auto k = static_cast<std::size_t>(t * static_cast<float>(rows) + 0.5F);
        const glm::vec2 way = on_circle(static_cast<double>(s));
        return shape(s, k, {profile[k].x * way.x, profile[k].y, -profile[k].x * way.y});
      },
      true);
}

}  // namespace traces
