#include "traces/scene/gltf/nodes/cameras.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "traces/scene/cameras.h"

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

void add_camera(Context& context, const tinygltf::Node& node, const glm::dmat4& to_world, std::uint32_t index) {
  constexpr std::size_t kMost = 1000;  // each new name is compared with all others
  if (node.camera < 0) return;
  const tinygltf::Camera& found = context.at(context.model.cameras, node.camera, "cameras");
  std::vector<Camera>& cameras = context.scene.cameras;
  std::string name = sim::printable(!found.name.empty() ? found.name : node.name);
  if (name.empty()) name = fmt::format("camera {}", node.camera);
  if (found.type != "perspective") {
    context.warn(fmt::format("camera '{}': only perspective cameras are supported", name));
    return;
  }
  if (cameras.size() == kMost) {
    context.warn(fmt::format("cameras after the first {} are left out", kMost));
    return;
  }
  const double fov = found.perspective.yfov;
  if (!(fov > 0 && fov < std::numbers::pi)) {
    context.refuse(fmt::format("cameras[{}]: yfov is {}; allowed is more than 0 and less than pi", node.camera, fov));
  }
  const std::optional<glm::mat4> standing = camera_to_world(to_world);
  if (!standing) {
    context.warn(fmt::format("camera '{}': its transform has no direction", name));
    return;
  }
  Camera camera;
  camera.name = unique_name(cameras, name);
  camera.to_world = *standing;
  camera.vertical_fov = static_cast<float>(fov);
  camera.node = index;
  cameras.push_back(camera);
}

}  // namespace traces::gltf
