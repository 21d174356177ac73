#pragma once
#include <cstddef>
#include <string>

#include "traces/scene/scene.h"

namespace traces {

/// How much there is of everything.
struct SceneInfo {
  std::string name;
  std::size_t triangles = 0;         ///< as rays see them: each instance counts its mesh
  std::size_t stored_triangles = 0;  ///< each mesh once
  std::size_t instances = 0, meshes = 0, materials = 0, textures = 0, lights = 0, cameras = 0;
};

SceneInfo scene_info(const Scene& scene);

}  // namespace traces
