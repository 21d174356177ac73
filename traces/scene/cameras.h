#pragma once
#include <string>

#include "traces/scene/scene.h"

namespace traces {

/// A camera at `eye` that looks at `target`, +y up.
Camera look_at(std::string name, const glm::vec3& eye, const glm::vec3& target, float vertical_fov);

/// Sees the whole scene from a little above, off to one side: for files without a camera.
Camera framing_camera(const Scene& scene);

}  // namespace traces
