#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace traces {

/// Control points of a bicubic Bezier patch, [v][u].
using BezierPatch = std::array<std::array<glm::vec3, 4>, 4>;

/// The 32 patches of Martin Newell's teapot (University of Utah, 1975): +y up, standing on y = 0, the spout towards +x.
/// du x dv points outwards. The first 28 make the pot and its lid, the last 4 its bottom.
std::vector<BezierPatch> teapot_patches();

struct SurfacePoint {
  glm::vec3 position, normal;
};

/// The patch at (u, v), 0 to 1. At a pole, where a side of the patch has no length, the normal is that of its vicinity.
SurfacePoint evaluate(const BezierPatch& patch, float u, float v);

}  // namespace traces
