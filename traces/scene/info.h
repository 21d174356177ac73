#pragma once
#include <cstddef>
#include <string>

#include "traces/scene/scene.h"

namespace traces {

/// Numbers and sizes of what a scene contains.
struct SceneInfo {
  std::string name;
  std::size_t triangles = 0;         ///< triangles that rays can hit; a mesh counts once per instance
  std::size_t stored_triangles = 0;  ///< triangles of all meshes, each mesh once
  std::size_t instances = 0, meshes = 0, materials = 0, textures = 0, lights = 0, cameras = 0;
  std::size_t texture_bytes = 0;  ///< bytes of all decoded textures, 4 per texel
  double duration = 0;            ///< length of the animation in seconds; 0 if the scene is still
  std::size_t tracks = 0, skins = 0;
  std::size_t morph_targets = 0;     ///< number of morph targets of all meshes together
  std::size_t moving_instances = 0;  ///< instances that deform or are attached to a moving node
};

SceneInfo scene_info(const Scene& scene);

}  // namespace traces
