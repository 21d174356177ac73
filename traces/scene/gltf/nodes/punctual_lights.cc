#include "traces/scene/gltf/nodes/punctual_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "sim/io/printable.h"
#include "traces/scene/gltf/values.h"

namespace traces::gltf {

/// Each light costs a shadow ray per visible surface.
constexpr std::size_t kMostLights = 1024;

void add_punctual_light(Context& context, const tinygltf::Node& node, const glm::dmat4& to_world, std::uint32_t index) {
  const auto* extension = find_extension(node.extensions, "KHR_lights_punctual");
  if (extension == nullptr) return;
  const tinygltf::Light& found = context.at(context.model.lights, index_or_none(*extension, "light"), "lights");
  const std::string what = fmt::format("light '{}'", sim::printable(found.name));
  Light light;
  if (found.type == "point") {
    light.kind = Light::Kind::kPoint;
  } else if (found.type == "directional") {
    light.kind = Light::Kind::kDirectional;
  } else if (found.type == "spot") {
    light.kind = Light::Kind::kSpot;
    const double outer = std::clamp(found.spot.outerConeAngle, 0.0, std::numbers::pi / 2);
    const double inner = std::clamp(found.spot.innerConeAngle, 0.0, outer);
    light.cos_outer = static_cast<float>(std::cos(outer));
    light.cos_inner = static_cast<float>(std::cos(inner));
  } else {
    context.warn(fmt::format("{}: the type '{}' is not point, spot or directional", what, sim::printable(found.type)));
    return;
  }
  const float strength = to_float(context, found.intensity, what + " intensity");
  light.intensity = glm::max(to_vec3(context, found.color, glm::vec3(1), what + " colour") * strength, 0.0F);
  if (light.intensity == glm::vec3(0)) return;
  if (context.scene.lights.size() == kMostLights) context.refuse(fmt::format("more than {} lights", kMostLights));
  light.range = std::max(to_float(context, found.range, what + " range"), 0.0F);
  light.node = index;
  light.position = glm::vec3(to_world[3]);
  const glm::dvec3 ahead = -glm::dvec3(to_world[2]);
  if (glm::length(ahead) > 0) light.direction = glm::vec3(glm::normalize(ahead));
  context.scene.lights.push_back(light);
}

}  // namespace traces::gltf
