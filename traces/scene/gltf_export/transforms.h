#pragma once
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <tiny_gltf.h>

#include "traces/scene/animation.h"

namespace traces::gltf_export {

/// Scale, then rotation, then translation, in double.
struct Placement {
  glm::dvec3 translation{0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 scale{1};
};

/// True if a node may have this matrix: glTF demands that it is made of a translation, a rotation and a scale alone.
bool is_placement(const glm::mat4& matrix);

/// Any affine matrix as the outer placement times the inner one, which only rotates: a matrix that shears, made by
/// nodes of uneven scale, is a rotation, a scale and another rotation (singular value decomposition).
struct TwoPlacements {
  Placement outer, inner;
};
TwoPlacements split(const glm::mat4& matrix);

/// Writes what is not the default.
void set_transform(tinygltf::Node& node, const Placement& placement);
void set_transform(tinygltf::Node& node, const Transform& transform);
void set_transform(tinygltf::Node& node, const glm::mat4& matrix);

}  // namespace traces::gltf_export
