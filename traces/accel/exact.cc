#include "traces/accel/exact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

namespace traces {
namespace {

constexpr double kBarycentricMargin = 1e-5;
constexpr double kDiagonalMargin = 1e-6;
constexpr double kIntervalMargin = 1e-5;

Standing weaker(Standing a, Standing b) { return std::min(a, b); }

/// A quantity that is wanted to be positive, known but for a margin.
Standing standing_of(double value, double margin) {
  if (value < -margin) return Standing::kMiss;
  return value > margin ? Standing::kHit : Standing::kUncertain;
}

}  // namespace

ExactHit exact_hit(const Ray& ray, const TriangleRecord& triangle, double diagonal) {
  const glm::dvec3 origin(ray.origin), direction(ray.direction);
  const std::array<glm::dvec3, 3> v{glm::dvec3(triangle.v0), glm::dvec3(triangle.v1), glm::dvec3(triangle.v2)};
  const glm::dvec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
  const double slope = glm::dot(normal, direction);
  if (slope == 0) return {};
  const double t = glm::dot(normal, v[0] - origin) / slope;
  const double length_margin = kDiagonalMargin * diagonal;
  const double t_margin = length_margin / glm::length(direction);

  Standing standing = standing_of(t - ray.t_min, kIntervalMargin * ray.t_min + t_margin);
  if (!std::isinf(ray.t_max)) {
    standing = weaker(standing, standing_of(ray.t_max - t, kIntervalMargin * ray.t_max + t_margin));
  }
  const glm::dvec3 at = origin + t * direction;
  const double twice_area = glm::length(normal);
  for (std::size_t i = 0; i < 3 && standing != Standing::kMiss; ++i) {
    const glm::dvec3 edge = v[(i + 1) % 3] - v[i];
    const double inwards = glm::dot(normal, glm::cross(edge, at - v[i])) / twice_area;  // distance times edge length
    const double margin = std::max(kBarycentricMargin * twice_area, length_margin * glm::length(edge));
    standing = weaker(standing, standing_of(inwards, margin));
  }
  return {standing, t};
}

ExactTrace exact_trace(const Ray& ray, const MemoryImage& image) {
  ExactTrace trace;
  const double diagonal = image.diagonal();
  for (const TriangleRecord& triangle : image.triangles) {
    const ExactHit hit = exact_hit(ray, triangle, diagonal);
    if (hit.standing == Standing::kMiss) continue;
    trace.any_possible = true;
    if (hit.standing == Standing::kHit) trace.nearest = std::min(trace.nearest, hit.t);
  }
  return trace;
}

}  // namespace traces
