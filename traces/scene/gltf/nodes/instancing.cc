#include "traces/scene/gltf/nodes/instancing.h"

#include <algorithm>

#include <fmt/format.h>

#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/values.h"

namespace traces::gltf {

std::vector<Transform> read_instancing(Context& context, const tinygltf::Node& node, const std::string& what) {
  std::vector<Transform> copies;
  const auto* extension = find_extension(node.extensions, "EXT_mesh_gpu_instancing");
  if (extension == nullptr || !extension->Has("attributes")) return copies;
  const tinygltf::Value& attributes = extension->Get("attributes");
  const auto fill = [&](const char* name, auto read, auto set) {
    const int accessor = index_or_none(attributes, name);
    if (accessor < 0) return;
    const auto values = read(context, accessor, name);
    if (copies.empty()) {
      context.budget.take(values.size(), sizeof(Node) + sizeof(Transform), what + " instances");
      copies.resize(values.size());
    }
    if (values.size() != copies.size()) {
      context.refuse(fmt::format("{}: {} values of {} for {} instances", what, values.size(), name, copies.size()));
    }
    for (std::size_t i = 0; i < copies.size(); ++i) set(copies[i], values[i]);
  };
  fill("TRANSLATION", read_vec3, [](Transform& t, const glm::vec3& v) { t.translation = v; });
  fill("SCALE", read_vec3, [](Transform& t, const glm::vec3& v) { t.scale = v; });
  fill("ROTATION", read_vec4, [&](Transform& t, const glm::vec4& v) {
    t.rotation = to_rotation(context, {v.x, v.y, v.z, v.w}, what + " rotation of an instance");
  });
  return copies;
}

}  // namespace traces::gltf
