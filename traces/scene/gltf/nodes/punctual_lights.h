#pragma once
#include <cstdint>

#include <glm/mat4x4.hpp>

#include "traces/scene/gltf/context.h"

namespace traces::gltf {

/// Adds the node's light by KHR_lights_punctual, if it has one. `index`: of the node in Scene::nodes.
void add_punctual_light(Context& context, const tinygltf::Node& node, const glm::dmat4& to_world, std::uint32_t index);

}  // namespace traces::gltf
