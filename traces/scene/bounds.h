#pragma once
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace traces {

struct Scene;

/// An axis-parallel box, which is empty at first.
struct Bounds {
  glm::vec3 lower{std::numeric_limits<float>::infinity()};
  glm::vec3 upper{-std::numeric_limits<float>::infinity()};

  void add(const glm::vec3& p) {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
  bool empty() const { return lower.x > upper.x; }
  glm::vec3 centre() const { return 0.5F * (lower + upper); }
  float diagonal() const { return glm::length(upper - lower); }
};

/// Returns the bounds of all instances in world space.
Bounds world_bounds(const Scene& scene);

}  // namespace traces
