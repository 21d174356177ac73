#pragma once
#include <optional>
#include <string>

#include <glm/mat4x4.hpp>

#include "traces/scene/scene.h"

namespace traces {

/// A camera at `eye` that looks at `target`, +y up.
Camera look_at(std::string name, const glm::vec3& eye, const glm::vec3& target, float vertical_fov);

/// The position and direction of a camera on that node, without the scale; nothing if that leaves no direction.
std::optional<glm::mat4> camera_to_world(const glm::dmat4& node_to_world);

/// Sees the whole scene from a little above, off to one side: for files without a camera.
Camera framing_camera(const Scene& scene);

}  // namespace traces
