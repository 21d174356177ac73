#include "traces/scenes/workload.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "traces/scene/bounds.h"
#include "traces/scene/cameras.h"
#include "traces/scene/did_you_mean.h"
#include "traces/scene/lights.h"
#include "traces/scenes/library.h"

namespace traces {
namespace {

glm::dvec3 to_dvec3(const sim::Triple& t) { return {t.x, t.y, t.z}; }
glm::vec3 to_vec3(const sim::Triple& t) { return glm::vec3(to_dvec3(t)); }

std::size_t find_camera(const Scene& scene, const std::string& wanted) {
  if (wanted.empty()) return 0;
  std::vector<std::string> names;
  for (const Camera& camera : scene.cameras) {
    if (camera.name == wanted) return names.size();
    names.push_back(camera.name);
  }
  std::size_t index = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [rest, error] = std::from_chars(wanted.data(), end, index);
  if (error == std::errc{} && rest == end && index < scene.cameras.size()) return index;
  std::string known;
  for (std::size_t i = 0; i < names.size(); ++i) known += fmt::format("{}{} '{}'", i == 0 ? "" : ", ", i, names[i]);
  throw sim::InputError(fmt::format("scene {} has no camera '{}'{}; it has: {}", scene.name, sim::printable(wanted),
                                    did_you_mean(wanted, names), known));
}

Camera configured_camera(const ViewConfig& view) {
  const glm::dvec3 eye = to_dvec3(view.position);
  Camera camera;
  camera.name = "own";
  camera.to_world = camera_to_world(glm::dmat4(glm::dvec4(0), glm::dvec4(to_dvec3(view.up), 0),
                                               glm::dvec4(eye - to_dvec3(view.target), 0), glm::dvec4(eye, 1)))
                        .value();
  camera.vertical_fov = static_cast<float>(glm::radians(view.fov));
  return camera;
}

void choose_lights(Scene& scene, const LightsConfig& config) {
  if (config.rig == LightRig::kScene) return;
  if (config.rig == LightRig::kStrongest) {
    const glm::vec3 ambient = scene.ambient;
    keep_strongest_light(scene);
    scale_lights_to_exposure(scene);
    scene.ambient = ambient;
    return;
  }
  Light own;
  own.kind = config.rig == LightRig::kPoint ? Light::Kind::kPoint : Light::Kind::kDirectional;
  own.position = to_vec3(config.position);
  own.direction = glm::vec3(glm::normalize(to_dvec3(config.direction)));
  own.intensity = to_vec3(config.intensity);
  scene.lights = {own};
}

/// Attaches a fixed camera to a node, so that posing the scene restores its place.
void attach_camera_to_node(Scene& scene) {
  Camera& camera = scene.cameras.front();
  if (camera.node != kNone) return;
  camera.node = static_cast<std::uint32_t>(scene.nodes.size());
  Node node;
  node.name = camera.name;
  node.matrix = camera.to_world;
  scene.nodes.push_back(std::move(node));
}

/// Rotates the camera around the vertical axis through the middle of the scene in its current pose.
void orbit_camera(Scene& scene, double degrees) {
  const glm::dvec3 centre(world_bounds(scene).centre());
  const glm::dmat4 turn = glm::translate(glm::dmat4(1), centre) *
                          glm::rotate(glm::dmat4(1), degrees * std::numbers::pi / 180, glm::dvec3(0, 1, 0)) *
                          glm::translate(glm::dmat4(1), -centre);
  Camera& camera = scene.cameras.front();
  camera.to_world = glm::mat4(turn * glm::dmat4(camera.to_world));
}

/// Makes single-sided materials double-sided, with a warning if a mesh uses one.
void show_back_faces(Scene& scene) {
  std::vector<bool> is_used(scene.materials.size());
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.material < is_used.size()) is_used[mesh.material] = true;
  }
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    Material& material = scene.materials[i];
    hidden += is_used[i] && !material.double_sided && material.transmission == 0 ? 1 : 0;
    material.double_sided = true;
  }
  if (hidden == 0) return;
  scene.warnings.push_back(fmt::format(
      "{} of {} materials have doubleSided: false, but their back faces are shown; scene.back_faces: culled hides them",
      hidden, scene.materials.size()));
}

}  // namespace

Scene open_workload(const WorkloadConfig& workload, const SceneLimits& limits) {
  Scene scene = open_scene(workload.name, {.triangles = workload.triangles}, limits);
  const bool own_view = workload.view.source == ViewSource::kOwn;
  const Camera camera =
      own_view ? configured_camera(workload.view) : scene.cameras[find_camera(scene, workload.camera)];
  if (workload.back_faces == BackFaces::kShown) show_back_faces(scene);
  choose_lights(scene, workload.lights);
  scene.cameras = {camera};
  if (workload.camera_path == CameraPath::kOrbit) attach_camera_to_node(scene);
  if (workload.sky.source == Sky::kOwn) {
    scene.background = to_vec3(workload.sky.background);
    scene.ambient = to_vec3(workload.sky.ambient);
  }
  pose_workload(scene, workload, workload.first_frame);
  return scene;
}

Moved pose_workload(Scene& scene, const WorkloadConfig& workload, std::uint32_t frame) {
  const double seconds = workload.seconds_of(frame);
  Moved moved = pose_scene(scene, seconds);
  if (workload.camera_path == CameraPath::kOrbit) {
    orbit_camera(scene, workload.orbit * seconds);
    moved.view = true;
  }
  return moved;
}

}  // namespace traces
