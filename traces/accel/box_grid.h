#pragma once
#include <glm/vec3.hpp>

#include "traces/accel/node_format.h"

namespace traces {

/// The grid of box planes in hybrid numbers (US patent 9,830,733). Each axis has 2^19 planes spread over the scene;
/// plane p is at lower + p * step.
class BoxGrid {
 public:
  static constexpr std::uint32_t kLastPlane = (1U << kPlaneBits) - 1;

  /// Spreads the grid over the scene's bounds. On an axis where the scene is nearly flat, the step is limited to 1/1024
  /// of the widest axis's; the box test resolves no finer distances (box_test.h).
  BoxGrid(const glm::vec3& lower, const glm::vec3& upper);

  /// Returns the last plane not above `x` and the first plane not below it, as whole numbers. `x` is within the bounds.
  float below(float x, int axis) const;
  float above(float x, int axis) const;
  /// Returns the coordinate of plane `p`.
  double at(double p, int axis) const { return lower_[axis] + p * step_[axis]; }

  const glm::vec3& lower() const { return lower_; }
  const glm::vec3& step() const { return step_; }
  friend bool operator==(const BoxGrid&, const BoxGrid&) = default;

 private:
  glm::vec3 lower_, step_;
};

struct MemoryImage;

/// Converts the image's boxes to hybrid numbers: spreads a grid over its bounds and rounds all planes outward to it.
void put_on_grid(MemoryImage& image);

}  // namespace traces
