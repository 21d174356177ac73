#include "traces/scene/info.h"

#include "traces/scene/bounds.h"

namespace traces {

SceneInfo scene_info(const Scene& scene) {
  SceneInfo info;
  info.name = scene.name;
  for (const Mesh& mesh : scene.meshes) info.stored_triangles += mesh.triangles.size();
  for (const Instance& instance : scene.instances) info.triangles += scene.meshes[instance.mesh].triangles.size();
  info.instances = scene.instances.size();
  info.meshes = scene.meshes.size();
  info.materials = scene.materials.size();
  info.textures = scene.textures.size();
  info.lights = scene.lights.size();
  info.cameras = scene.cameras.size();
  return info;
}

Bounds world_bounds(const Scene& scene) {
  Bounds bounds;
  for (const Instance& instance : scene.instances) {
    for (const glm::vec3& p : scene.meshes[instance.mesh].positions) {
      bounds.add(glm::vec3(instance.to_world * glm::vec4(p, 1)));
    }
  }
  return bounds;
}

}  // namespace traces
