#pragma once
#include <cstddef>
#include <string>

#include "traces/scene/scene.h"

namespace traces {

/// Sizes of a scene.
struct SceneInfo {
  std::string name;
  std::size_t triangles = 0;         ///< as seen by rays: each instance counts its mesh
  std::size_t stored_triangles = 0;  ///< each mesh once
  std::size_t instances = 0, meshes = 0, materials = 0, textures = 0, lights = 0, cameras = 0;
  std::size_t texture_bytes = 0;  ///< decoded, 4 per texel
  double duration = 0;            ///< of its animation in seconds; 0: still
  std::size_t tracks = 0, skins = 0;
  std::size_t morph_targets = 0;     ///< sum over all meshes
  std::size_t moving_instances = 0;  ///< attached to a moving node, or deforming
};

SceneInfo scene_info(const Scene& scene);

}  // namespace traces
