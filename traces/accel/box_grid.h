#pragma once
#include <glm/vec3.hpp>

#include "traces/accel/node_format.h"

namespace traces {

/// The grid on which boxes lie in hybrid numbers (US patent 9,830,733): along each axis 2^19 planes, plane p at
/// lower + p * step, spread over the scene.
class BoxGrid {
 public:
  static constexpr std::uint32_t kLastPlane = (1U << kPlaneBits) - 1;

  /// Spread over the scene's bounds. An axis along which the scene is flat, or nearly so, gets a step that is not far
  /// below that of the widest: the box test is not finer than that (box_test.h).
  BoxGrid(const glm::vec3& lower, const glm::vec3& upper);

  /// The last plane not above `x`, which lies within the bounds, and the first not below it; whole numbers.
  float below(float x, int axis) const;
  float above(float x, int axis) const;
  /// Where plane `p` is.
  double at(double p, int axis) const { return lower_[axis] + p * step_[axis]; }

  const glm::vec3& lower() const { return lower_; }
  const glm::vec3& step() const { return step_; }
  friend bool operator==(const BoxGrid&, const BoxGrid&) = default;

 private:
  glm::vec3 lower_, step_;
};

struct MemoryImage;

/// Makes the image one of hybrid numbers: spreads a grid over its bounds and replaces the planes of all boxes, so far
/// coordinates, by those of the grid, outward.
void put_on_grid(MemoryImage& image);

}  // namespace traces
