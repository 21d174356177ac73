#include "traces/scene/gltf_export/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace traces::gltf_export {
namespace {

/// tinygltf 2.9 and later have a member for a node's light, and drop the extension without it.
template <class Node>
void refer_to_light(Node& node, int light) {
  if constexpr (requires { node.light; }) node.light = light;
}

/// Returns a matrix at the light's position whose -z is the light's direction.
glm::mat4 frame_of(const Light& light) {
  if (light.kind == Light::Kind::kPoint) {
    glm::mat4 frame(1);
    frame[3] = glm::vec4(light.position, 1);
    return frame;
  }
  const glm::dvec3 back = -glm::normalize(glm::dvec3(light.direction));
  const glm::dvec3 other = std::abs(back.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 right = glm::normalize(glm::cross(other, back));
  return {glm::vec4(glm::vec3(right), 0), glm::vec4(glm::vec3(glm::cross(back, right)), 0),
          glm::vec4(glm::vec3(back), 0), glm::vec4(light.position, 1)};
}

tinygltf::Light light_of(const Light& light, float strongest) {
  tinygltf::Light to;
  to.intensity = double{strongest} * std::numbers::pi;
  to.color = numbers(light.intensity / strongest);
  to.range = std::max(double{light.range}, 0.0);
  to.type = "point";
  if (light.kind == Light::Kind::kDirectional) to.type = "directional";
  if (light.kind == Light::Kind::kSpot) {
    to.type = "spot";
    // glTF demands an outer angle above 0 and an inner angle below the outer.
    to.spot.outerConeAngle = std::max(std::acos(std::clamp(double{light.cos_outer}, 0.0, 1.0)), 1e-6);
    to.spot.innerConeAngle =
        std::min(std::acos(std::clamp(double{light.cos_inner}, 0.0, 1.0)), to.spot.outerConeAngle * (1 - 1e-9));
  }
  return to;
}

}  // namespace

void write_lights(const Scene& scene, const NodeMap& map, Document& out) {
  for (const Light& light : scene.lights) {
    const float strongest = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
    if (!(strongest > 0)) continue;
    int gltf_node = -1;
    if (light.node == kNone) {
      gltf_node = add_placed(out, -1, frame_of(light));
    } else {
      gltf_node = map.gltf_nodes[light.node];
      const bool taken =
          out.model.nodes[static_cast<std::size_t>(gltf_node)].extensions.contains("KHR_lights_punctual");
      if (taken || light.in_node != glm::mat4(1)) gltf_node = add_placed(out, gltf_node, light.in_node);
    }
    tinygltf::Node& node = out.model.nodes[static_cast<std::size_t>(gltf_node)];
    const int index = static_cast<int>(out.model.lights.size());
    out.extend(node.extensions, "KHR_lights_punctual", {{"light", tinygltf::Value(index)}});
    refer_to_light(node, index);
    if (node.name.empty()) node.name = "light";
    out.model.lights.push_back(light_of(light, strongest));
  }
  const tinygltf::Value::Object ours{{"background", value(scene.background)}, {"ambient", value(scene.ambient)}};
  out.model.scenes[0].extras = tinygltf::Value(tinygltf::Value::Object{{"raywatt", tinygltf::Value(ours)}});
}

}  // namespace traces::gltf_export
