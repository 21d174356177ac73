#pragma once
#include <cstdint>

#include "traces/accel/bvh_config.h"
#include "traces/scene/scene.h"

namespace traces {

/// Geometry that a frame moves before its trees are built.
struct PoseWork {
  std::uint64_t skinned_vertices = 0;
  std::uint64_t joints = 0;          ///< joints of all skins of these vertices
  std::uint64_t rigid_vertices = 0;  ///< vertices that matrices of nodes move to the world
  std::uint64_t rigid_instances = 0;
  friend bool operator==(const PoseWork&, const PoseWork&) = default;
};

/// Returns how much of a scene's geometry kernels pose in a frame in which any geometry moves.
///
/// 1. A mesh with a skin counts in each of these frames, even if its pose does not change.
/// 2. An instance moves if an animation track moves its node or a parent of the node. With one level its vertices are
///    transformed to the world; with two levels the build of the tree over instances reads its matrix.
/// 3. Morph targets and normals are not counted.
PoseWork pose_work(const Scene& scene, InstanceLevels levels);

}  // namespace traces
