#include "traces/accel/node_format.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <glm/common.hpp>

#include "traces/accel/memory_image.h"

namespace traces {

BoxGrid::BoxGrid(const glm::vec3& lower, const glm::vec3& upper) : lower_(lower), step_(0) {
  const glm::dvec3 extent = glm::dvec3(upper) - glm::dvec3(lower);
  constexpr double kLeast = 1e-12;  // smallest step, which keeps it and its reciprocal within the range of floats
  const double widest = std::max({extent.x, extent.y, extent.z});
  // One plane is left over, because the step is rounded to a float.
  for (int a = 0; a < 3; ++a) {
    step_[a] = static_cast<float>(std::max({extent[a], widest / 1024, kLeast}) / (kLastPlane - 1));
  }
}

float BoxGrid::plane_below(float x, int axis) const {
  const double p = std::floor((double{x} - lower_[axis]) / step_[axis]);
  const double plane = plane_position(p, axis) > x ? p - 1 : p;  // corrects the rounding of the quotient
  assert(plane >= 0);
  return static_cast<float>(plane);
}

float BoxGrid::plane_above(float x, int axis) const {
  const double p = std::ceil((double{x} - lower_[axis]) / step_[axis]);
  const double plane = plane_position(p, axis) < x ? p + 1 : p;
  assert(plane <= kLastPlane);
  return static_cast<float>(plane);
}

void round_boxes_to_grid(MemoryImage& image) {
  const BoxGrid grid(image.lower, image.upper);
  for (NodeRecord& node : image.nodes) {
    for (int c = 0; c < 2; ++c) {
      if (node.child[c] == kNoChild) continue;  // keeps its inverted box
      for (auto [planes, axis] : {std::pair{node.x, 0}, {node.y, 1}, {node.z, 2}}) {
        planes[c] = grid.plane_below(planes[c], axis);
        planes[2 + c] = grid.plane_above(planes[2 + c], axis);
      }
    }
  }
  for (WideNode& node : image.wide_nodes) {
    for (std::uint32_t slot = 0; slot < kMaxWidth; ++slot) {
      if (node.child[slot] == kNoChild) continue;
      for (int axis = 0; axis < 3; ++axis) {
        auto& [lower, upper] = node.planes[axis];
        lower[slot] = grid.plane_below(lower[slot], axis);
        upper[slot] = grid.plane_above(upper[slot], axis);
      }
    }
  }
  image.grid = grid;
}

}  // namespace traces
