#include "traces/accel/box_grid.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <glm/common.hpp>

#include "traces/accel/memory_image.h"

namespace traces {

BoxGrid::BoxGrid(const glm::vec3& lower, const glm::vec3& upper) : lower_(lower), step_(0) {
  const glm::dvec3 extent = glm::dvec3(upper) - glm::dvec3(lower);
  constexpr double kLeast = 1e-12;  // keeps reciprocals of and times a step within a float's range
  const double widest = std::max({extent.x, extent.y, extent.z});
  // One plane is left over for what the step loses in becoming a float.
  for (int a = 0; a < 3; ++a) {
    step_[a] = static_cast<float>(std::max({extent[a], widest / 1024, kLeast}) / (kLastPlane - 1));
  }
}

float BoxGrid::below(float x, int axis) const {
  const double p = std::floor((double{x} - lower_[axis]) / step_[axis]);
  const double plane = at(p, axis) > x ? p - 1 : p;  // the quotient has been rounded
  assert(plane >= 0);
  return static_cast<float>(plane);
}

float BoxGrid::above(float x, int axis) const {
  const double p = std::ceil((double{x} - lower_[axis]) / step_[axis]);
  const double plane = at(p, axis) < x ? p + 1 : p;
  assert(plane <= kLastPlane);
  return static_cast<float>(plane);
}

void put_on_grid(MemoryImage& image) {
  const BoxGrid grid(image.lower, image.upper);
  for (NodeRecord& node : image.nodes) {
    for (int c = 0; c < 2; ++c) {
      if (node.child[c] == kNoChild) continue;  // its box is inverted, and stays so
      for (auto [planes, axis] : {std::pair{node.x, 0}, {node.y, 1}, {node.z, 2}}) {
        planes[c] = grid.below(planes[c], axis);
        planes[2 + c] = grid.above(planes[2 + c], axis);
      }
    }
  }
  image.grid = grid;
}

}  // namespace traces
