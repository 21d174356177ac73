#include "traces/scene/cameras.h"

#include <cmath>
#include <utility>

#include "traces/scene/bounds.h"

namespace traces {

Camera look_at(std::string name, const glm::vec3& eye, const glm::vec3& target, float vertical_fov) {
  const glm::vec3 back = glm::normalize(eye - target);
  const glm::vec3 up = std::abs(back.y) < 0.999F ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, -1);
  const glm::vec3 right = glm::normalize(glm::cross(up, back));
  Camera camera;
  camera.name = std::move(name);
  camera.to_world =
      glm::mat4(glm::vec4(right, 0), glm::vec4(glm::cross(back, right), 0), glm::vec4(back, 0), glm::vec4(eye, 1));
  camera.vertical_fov = vertical_fov;
  return camera;
}

std::optional<glm::mat4> camera_to_world(const glm::dmat4& node_to_world) {
  glm::dvec3 back(node_to_world[2]);
  glm::dvec3 right = glm::cross(glm::dvec3(node_to_world[1]), back);
  if (!(glm::length(right) > 0)) return std::nullopt;
  back = glm::normalize(back);
  right = glm::normalize(right);
  return glm::mat4(
      glm::dmat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0), glm::dvec4(back, 0), node_to_world[3]));
}

Camera framing_camera(const Scene& scene) {
  constexpr float kFov = 0.7F;
  constexpr float kInverseSine = 2.92F;  // 1 / sin(kFov / 2): the bounding sphere just fits the picture
  const Bounds bounds = world_bounds(scene);
  const float distance = std::max(0.5F * bounds.diagonal(), 1e-6F) * kInverseSine;
  const glm::vec3 from = glm::normalize(glm::vec3(0.55F, 0.4F, 1.0F));
  return look_at("default", bounds.centre() + distance * from, bounds.centre(), kFov);
}

}  // namespace traces
