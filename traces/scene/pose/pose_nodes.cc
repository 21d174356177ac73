#include "traces/scene/pose/pose_nodes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "sim/error.h"
#include "traces/scene/limits.h"
#include "traces/scene/pose/pose_track.h"
#include "traces/scene/scene.h"

namespace traces {
namespace {

struct LocalPose {
  double translation[3], rotation[4], scale[3];
};

LocalPose at_rest(const Transform& t) {
  const glm::dvec3 move(t.translation), scale(t.scale);
  const glm::dquat q = glm::normalize(glm::dquat(t.rotation));
  return {{move.x, move.y, move.z}, {q.x, q.y, q.z, q.w}, {scale.x, scale.y, scale.z}};
}

glm::dmat4 local_matrix(const LocalPose& p) {
  return matrix_of({p.translation[0], p.translation[1], p.translation[2]},
                   glm::dquat(p.rotation[3], p.rotation[0], p.rotation[1], p.rotation[2]),
                   {p.scale[0], p.scale[1], p.scale[2]});
}

void apply(const Track& track, double seconds, LocalPose& pose, std::vector<double>& weights) {
  switch (track.path) {
    case Track::Path::kTranslation:
      return sample(track, seconds, pose.translation);
    case Track::Path::kRotation:
      return sample(track, seconds, pose.rotation);
    case Track::Path::kScale:
      return sample(track, seconds, pose.scale);
    case Track::Path::kMorphWeights:
      return sample(track, seconds, weights);
  }
}

}  // namespace

glm::dmat4 matrix_of(const glm::dvec3& translation, const glm::dquat& q, const glm::dvec3& scale) {
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  glm::dmat4 m(1);
  m[0] = glm::dvec4(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0) * scale.x;
  m[1] = glm::dvec4(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0) * scale.y;
  m[2] = glm::dvec4(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0) * scale.z;
  m[3] = glm::dvec4(translation, 1);
  return m;
}

double largest_entry(const glm::dmat4& m) {
  double largest = 0;
  for (int i = 0; i < 16; ++i) largest = std::max(largest, std::abs(m[i / 4][i % 4]));
  return largest;
}

NodePoses pose_nodes(const Scene& scene, double seconds) {
  NodePoses poses;
  std::vector<LocalPose> local;
  local.reserve(scene.nodes.size());
  for (const Node& node : scene.nodes) {
    local.push_back(at_rest(node.rest));
    poses.morph_weights.emplace_back(node.morph_weights.begin(), node.morph_weights.end());
  }
  // In reverse, so that the first track of a node and path takes effect.
  for (auto track = scene.tracks.rbegin(); track != scene.tracks.rend(); ++track) {
    apply(*track, seconds, local[track->node], poses.morph_weights[track->node]);
  }
  poses.to_world.reserve(scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    const glm::dmat4 in_parent = glm::dmat4(node.matrix) * local_matrix(local[i]);
    assert((node.parent == kNone || node.parent < i) && "a parent comes before its children");
    poses.to_world.push_back(node.parent == kNone ? in_parent : poses.to_world[node.parent] * in_parent);
    if (!(largest_entry(poses.to_world.back()) <= kFarthest)) {
      throw sim::InputError(fmt::format("{}: at {} s node '{}' is further than {} from the origin, or larger",
                                        scene.name, seconds, node.name, kFarthest));
    }
  }
  return poses;
}

}  // namespace traces
