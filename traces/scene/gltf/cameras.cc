#include "traces/scene/gltf/cameras.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "sim/io/printable.h"

namespace traces::gltf {
namespace {

std::string unique_name(const std::vector<Camera>& cameras, const std::string& wish) {
  std::string name = wish;
  for (int i = 2; std::ranges::find(cameras, name, &Camera::name) != cameras.end(); ++i) {
    name = fmt::format("{} {}", wish, i);
  }
  return name;
}

}  // namespace

void add_camera(Context& context, const tinygltf::Node& node, const glm::dmat4& to_world, std::uint32_t place) {
  constexpr std::size_t kMost = 1000;  // names are made unique by comparing each with all
  if (node.camera < 0) return;
  const tinygltf::Camera& found = context.at(context.model.cameras, node.camera, "cameras");
  const std::string name = sim::printable(!found.name.empty() ? found.name : node.name);
  if (found.type != "perspective") {
    context.warn(fmt::format("camera '{}': only perspective cameras are supported", name));
    return;
  }
  if (context.scene.cameras.size() == kMost) {
    context.warn(fmt::format("cameras after the first {} are left out", kMost));
    return;
  }
  const double fov = found.perspective.yfov;
  if (!(fov > 0 && fov < std::numbers::pi)) {
    context.refuse(fmt::format("cameras[{}]: yfov is {}; allowed is more than 0 and less than pi", node.camera, fov));
  }
  // A camera's node may be scaled, its rays must not be.
  glm::dvec3 back(to_world[2]), up(to_world[1]);
  glm::dvec3 right = glm::cross(up, back);
  if (!(glm::length(right) > 0)) {
    context.warn(fmt::format("camera '{}': its transform has no direction", name));
    return;
  }
  back = glm::normalize(back);
  right = glm::normalize(right);
  up = glm::cross(back, right);
  std::vector<Camera>& cameras = context.scene.cameras;
  Camera camera;
  camera.name = unique_name(cameras, name.empty() ? fmt::format("camera {}", cameras.size()) : name);
  camera.to_world = glm::mat4(glm::dmat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0), to_world[3]));
  camera.vertical_fov = static_cast<float>(fov);
  camera.node = place;
  cameras.push_back(camera);
}

}  // namespace traces::gltf
