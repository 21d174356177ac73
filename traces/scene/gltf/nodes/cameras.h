#pragma once
#include <cstdint>

#include <glm/mat4x4.hpp>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Adds the node's camera, if it has one. Orthographic cameras are left out with a warning; a second camera of the same
/// name gets a number as suffix. `index`: of the node in Scene::nodes.
void add_camera(Context& context, const tinygltf::Node& node, const glm::dmat4& to_world, std::uint32_t index);

}  // namespace traces::gltf
