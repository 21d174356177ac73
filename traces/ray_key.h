#pragma once
#include <algorithm>
#include <cstdint>

#include <glm/vec3.hpp>

#include "traces/ray.h"

namespace traces {

/// Computes sort keys of rays. Rays with neighbouring keys begin close to each other and have similar directions.
///
///   key   Morton code of the origin's cell(15) | octant of the direction(3)
///
/// The grid has 32 cells per axis over the scene. Origins outside the scene belong to the nearest cell.
class RayKeyGrid {
 public:
  static constexpr std::uint32_t kAxisBits = 5, kKeyBits = 3 * kAxisBits + 3;

  /// `lower`, `upper`: bounds of the scene.
  RayKeyGrid(const glm::vec3& lower, const glm::vec3& upper) : lower_(lower) {
    for (int axis = 0; axis < 3; ++axis) {
      const float side = upper[axis] - lower[axis];
      scale_[axis] = side > 0 ? kCells / side : 0;
    }
  }

  std::uint32_t key_of(const Ray& ray) const {
    std::uint32_t octant = 0, cell = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float place = std::clamp((ray.origin[axis] - lower_[axis]) * scale_[axis], 0.0F, kCells - 1);
      cell |= spread_bits(static_cast<std::uint32_t>(place)) << axis;
      octant |= static_cast<std::uint32_t>(ray.direction[axis] < 0) << axis;
    }
    return cell << 3 | octant;
  }

 private:
  static constexpr float kCells = 1U << kAxisBits;
  /// Returns the bits of a coordinate with two zeros between neighbours.
  static constexpr std::uint32_t spread_bits(std::uint32_t n) {
    std::uint32_t out = 0;
    for (std::uint32_t bit = 0; bit < kAxisBits; ++bit) out |= (n >> bit & 1U) << (3 * bit);
    return out;
  }

  glm::vec3 lower_, scale_{0};
};

}  // namespace traces
