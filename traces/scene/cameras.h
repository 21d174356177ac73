#pragma once
#include <optional>
#include <string>

#include <glm/mat4x4.hpp>

#include "traces/scene/scene.h"

namespace traces {

/// Returns a camera at `eye` that looks at `target`, with +y up.
Camera look_at(std::string name, const glm::vec3& eye, const glm::vec3& target, float vertical_fov);

/// Returns the transform of a camera that is attached to a node, without the node's scale, or no value if the matrix
/// maps y and z to the same line.
std::optional<glm::mat4> camera_to_world(const glm::dmat4& node_to_world);

/// Returns a camera that sees the whole scene from above and one side; used for files without a camera.
Camera framing_camera(const Scene& scene);

}  // namespace traces
