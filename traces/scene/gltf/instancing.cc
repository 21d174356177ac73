#include "traces/scene/gltf/instancing.h"

#include <algorithm>

#include <fmt/format.h>

#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/values.h"

namespace traces::gltf {

std::vector<Transform> read_instancing(Context& context, const tinygltf::Node& node, const std::string& what) {
  std::vector<Transform> places;
  const auto* extension = find_extension(node.extensions, "EXT_mesh_gpu_instancing");
  if (extension == nullptr || !extension->Has("attributes")) return places;
  const tinygltf::Value& attributes = extension->Get("attributes");
  const auto fill = [&](const char* name, auto read, auto set) {
    const int accessor = index_or_none(attributes, name);
    if (accessor < 0) return;
    const auto values = read(context, accessor, name);
    if (places.empty()) {
      context.budget.take(values.size(), sizeof(Node) + sizeof(Transform), what + " instances");
      places.resize(values.size());
    }
    if (values.size() != places.size()) {
      context.refuse(fmt::format("{}: {} values of {} for {} instances", what, values.size(), name, places.size()));
    }
    for (std::size_t i = 0; i < places.size(); ++i) set(places[i], values[i]);
  };
  fill("TRANSLATION", read_vec3, [](Transform& t, const glm::vec3& v) { t.translation = v; });
  fill("SCALE", read_vec3, [](Transform& t, const glm::vec3& v) { t.scale = v; });
  fill("ROTATION", read_vec4, [&](Transform& t, const glm::vec4& v) {
    t.rotation = to_rotation(context, {v.x, v.y, v.z, v.w}, what + " rotation of an instance");
  });
  return places;
}

}  // namespace traces::gltf
