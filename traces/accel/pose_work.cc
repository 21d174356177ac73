#include "traces/accel/pose_work.h"

#include <cstddef>
#include <vector>

namespace traces {
namespace {

/// Returns for each node whether a track moves it or one of its parents.
std::vector<bool> moving_nodes(const Scene& scene) {
  std::vector<bool> moves(scene.nodes.size());
  for (const Track& track : scene.tracks) {
    if (track.path != Track::Path::kMorphWeights) moves[track.node] = true;
  }
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const std::uint32_t parent = scene.nodes[i].parent;
    if (parent != kNone && moves[parent]) moves[i] = true;
  }
  return moves;
}

}  // namespace

PoseWork pose_work(const Scene& scene, InstanceLevels levels) {
  const std::vector<bool> moves = moving_nodes(scene);
  PoseWork work;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const std::uint32_t skin = mesh.deformation == nullptr ? kNone : mesh.deformation->skin;
    if (skin != kNone) {
      work.skinned_vertices += mesh.positions.size();
      work.joints += scene.skins[skin].joints.size();
    } else if (levels != InstanceLevels::kTwoLevel && instance.node != kNone && moves[instance.node]) {
      work.rigid_vertices += mesh.positions.size();
      work.rigid_instances += 1;
    }
  }
  return work;
}

}  // namespace traces
