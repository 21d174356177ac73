#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace traces {

/// Control points of a bicubic Bezier patch, [v][u].
using BezierPatch = std::array<std::array<glm::vec3, 4>, 4>;

/// Returns the 32 patches of Martin Newell's teapot (University of Utah, 1975): +y up, bottom at y = 0, spout towards
/// +x, du x dv outwards. The first 28 are pot and lid, the last 4 the bottom.
std::vector<BezierPatch> teapot_patches();

struct SurfacePoint {
  glm::vec3 position, normal;
};

/// Returns the point of a patch at (u, v), 0 to 1, with its normal. At a pole, where one side of the patch has no
/// length, it returns a nearby normal.
SurfacePoint evaluate_patch(const BezierPatch& patch, float u, float v);

}  // namespace traces
