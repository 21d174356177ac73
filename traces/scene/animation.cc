#include "traces/scene/animation.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat4x3.hpp>

#include "sim/error.h"
#include "traces/scene/cameras.h"
#include "traces/scene/limits.h"
#include "traces/scene/pose.h"
#include "traces/scene/scene.h"

namespace traces {
namespace {

template <class T>
bool assign_if_different(T& old, const T& by) {
  const bool changed = old != by;
  old = by;
  return changed;
}

std::vector<glm::dmat4x3> joint_matrices(const Skin& skin, const NodePoses& nodes) {
  std::vector<glm::dmat4x3> out;
  out.reserve(skin.joints.size());
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    out.emplace_back(nodes.to_world[skin.joints[i]] * glm::dmat4(skin.inverse_bind[i]));
  }
  return out;
}

bool pose_vertices(Scene& scene, const Instance& instance, const NodePoses& nodes) {
  Mesh& mesh = scene.meshes[instance.mesh];
  if (mesh.deformation == nullptr) return false;
  std::vector<glm::dmat4x3> joints;
  if (mesh.deformation->skin != kNone) joints = joint_matrices(scene.skins[mesh.deformation->skin], nodes);
  std::span<const double> weights;
  if (instance.node != kNone) weights = nodes.morph_weights[instance.node];
  return deform_mesh(mesh, joints, weights);
}

bool pose_instance(Scene& scene, Instance& instance, const NodePoses& nodes) {
  const std::shared_ptr<const Deformation>& deformation = scene.meshes[instance.mesh].deformation;
  if (deformation != nullptr && deformation->skin != kNone) return assign_if_different(instance.to_world, glm::mat4(1));
  return instance.node != kNone && assign_if_different(instance.to_world, glm::mat4(nodes.to_world[instance.node]));
}

/// Throws InputError if a moved instance is so far away that ray arithmetic would overflow.
void check_distance_from_origin(const Scene& scene, const Instance& instance, double seconds) {
  const Mesh& mesh = scene.meshes[instance.mesh];
  float reach = 0;
  bool finite = true;
  for (const glm::vec3& p : mesh.positions) {
    reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    finite = finite && std::isfinite(p.x + p.y + p.z);
  }
  if (finite && largest_entry(instance.to_world) * (3 * static_cast<double>(reach) + 1) <= kFarthest) return;
  throw sim::InputError(fmt::format("{}: at {} s mesh '{}' reaches further than {} from the origin", scene.name,
                                    seconds, mesh.name, kFarthest));
}

bool pose_camera(Camera& camera, const NodePoses& nodes) {
  if (camera.node == kNone) return false;
  const glm::dmat4& to_world = nodes.to_world[camera.node];
  return assign_if_different(camera.to_world, camera_to_world(to_world).value_or(
                                                  glm::mat4(glm::translate(glm::dmat4(1), glm::dvec3(to_world[3])))));
}

bool pose_light(Light& light, const NodePoses& nodes) {
  if (light.node == kNone) return false;
  const glm::dmat4 to_world = nodes.to_world[light.node] * glm::dmat4(light.in_node);
  const bool moved = assign_if_different(light.position, glm::vec3(to_world[3]));
  const glm::dvec3 ahead = -glm::dvec3(to_world[2]);
  const double length = glm::length(ahead);
  return assign_if_different(light.direction, length > 0 ? glm::vec3(ahead / length) : glm::vec3(0, -1, 0)) || moved;
}

}  // namespace

Moved pose_scene(Scene& scene, double seconds) {
  const NodePoses nodes = pose_nodes(scene, seconds);
  Moved moved;
  for (Instance& instance : scene.instances) {
    const bool bent = pose_vertices(scene, instance, nodes);
    if (!pose_instance(scene, instance, nodes) && !bent) continue;
    check_distance_from_origin(scene, instance, seconds);
    moved.geometry = true;
  }
  for (Camera& camera : scene.cameras) moved.view = pose_camera(camera, nodes) || moved.view;
  for (Light& light : scene.lights) moved.lights = pose_light(light, nodes) || moved.lights;
  return moved;
}

double animation_seconds(const Scene& scene) {
  float last = 0;
  for (const Track& track : scene.tracks) last = std::max(last, track.times.empty() ? 0.0F : track.times.back());
  return static_cast<double>(last);
}

}  // namespace traces
