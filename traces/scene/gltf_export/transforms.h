#pragma once
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <tiny_gltf.h>

#include "traces/scene/animation.h"

namespace traces::gltf_export {

/// Applied in this order: scale, rotation, translation.
struct Placement {
  glm::dvec3 translation{0};
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 scale{1};
};

/// True if the matrix is a translation, a rotation and a scale alone, as glTF demands of a node.
bool is_placement(const glm::mat4& matrix);

/// Any affine matrix as the product of an outer placement and an inner one, which only rotates. A matrix that shears,
/// as nodes of uneven scale make, is a rotation, a scale and another rotation (singular value decomposition).
struct TwoPlacements {
  Placement outer, inner;
};
TwoPlacements split(const glm::mat4& matrix);

/// These write only values that differ from glTF's defaults.
void set_transform(tinygltf::Node& node, const Placement& placement);
void set_transform(tinygltf::Node& node, const Transform& transform);
void set_transform(tinygltf::Node& node, const glm::mat4& matrix);

}  // namespace traces::gltf_export
