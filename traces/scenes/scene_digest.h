#pragma once
#include <string>

#include "traces/scene/scene.h"

namespace traces {

/// Returns the SHA-256 of everything in the scene that can change a picture.
std::string scene_digest(const Scene& scene);

}  // namespace traces
