#include "traces/scene/info.h"

#include "traces/scene/animation.h"
#include "traces/scene/bounds.h"

namespace traces {
namespace {

/// Returns for each of Scene::nodes whether an animation moves the node or one of its ancestors.
std::vector<bool> moving_nodes(const Scene& scene) {
  std::vector<bool> moving(scene.nodes.size(), false);
  for (const Track& track : scene.tracks) {
    if (track.path != Track::Path::kMorphWeights) moving[track.node] = true;
  }
  for (std::size_t i = 0; i < moving.size(); ++i) {  // a parent precedes its children
    if (scene.nodes[i].parent != kNone && moving[scene.nodes[i].parent]) moving[i] = true;
  }
  return moving;
}

void count_motion(const Scene& scene, SceneInfo& info) {
  info.duration = animation_seconds(scene);
  info.tracks = scene.tracks.size();
  info.skins = scene.skins.size();
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.deformation != nullptr) info.morph_targets += mesh.deformation->target_positions.size();
  }
  if (scene.tracks.empty()) return;
  const std::vector<bool> moving = moving_nodes(scene);
  for (const Instance& instance : scene.instances) {
    const bool carried = instance.node != kNone && moving[instance.node];
    if (carried || scene.meshes[instance.mesh].deformation != nullptr) ++info.moving_instances;
  }
}

}  // namespace

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
  for (const Texture& texture : scene.textures) info.texture_bytes += texture.texels.size() * sizeof(std::uint32_t);
  count_motion(scene, info);
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
