#include <algorithm>
#include <map>
#include <tuple>

#include "traces/scene/gltf_export/nodes.h"
#include "traces/scene/gltf_export/transforms.h"

namespace traces::gltf_export {
namespace {

/// Instances that form the primitives of one glTF mesh on one node.
struct Group {
  const Instance* first = nullptr;
  std::uint32_t skin = kNone;
  std::size_t targets = 0;
  std::vector<std::uint32_t> parts;  ///< indices in Scene::meshes
};

std::vector<Group> group_instances(const Scene& scene) {
  std::vector<Group> groups;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::size_t, bool>, std::size_t> indices;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (mesh.triangles.empty()) continue;
    Group group;
    group.first = &instance;
    if (mesh.deformation != nullptr) {
      group.skin = mesh.deformation->skin;
      group.targets = mesh.deformation->target_positions.size();
    }
    const auto [found, is_new] =
        indices.try_emplace({instance.node, group.skin, group.targets, instance.focus}, groups.size());
    if (is_new || instance.node == kNone) {
      found->second = groups.size();
      groups.push_back(group);
    }
    groups[found->second].parts.push_back(instance.mesh);
  }
  return groups;
}

int gltf_node_of(const Group& group, const NodeMap& map, Document& out) {
  const Instance& instance = *group.first;
  if (group.skin != kNone) return add_node(out, -1, {});
  if (instance.node == kNone) return add_placed(out, -1, instance.to_world);
  const int gltf_node = map.gltf_nodes[instance.node];
  return out.model.nodes[static_cast<std::size_t>(gltf_node)].mesh < 0 ? gltf_node : add_node(out, gltf_node, {});
}

int gltf_skin_of(std::uint32_t skin, NodeMap& map) {
  auto found = std::ranges::find(map.skins, skin);
  if (found == map.skins.end()) found = map.skins.insert(found, skin);
  return static_cast<int>(found - map.skins.begin());
}

}  // namespace

void write_instances(const Scene& scene, Meshes& meshes, NodeMap& map, Document& out) {
  for (const Group& group : group_instances(scene)) {
    const int mesh = meshes.mesh_of(group.parts);
    const int gltf_node = gltf_node_of(group, map, out);
    tinygltf::Node& node = out.model.nodes[static_cast<std::size_t>(gltf_node)];
    node.mesh = mesh;
    if (node.name.empty()) node.name = scene.meshes[group.parts.front()].name;
    if (group.first->focus) node.extras = tinygltf::Value(tinygltf::Value::Object{{"focus", tinygltf::Value(true)}});
    if (group.skin != kNone) node.skin = gltf_skin_of(group.skin, map);
    if (group.targets == 0 || group.first->node == kNone) continue;
    const std::vector<float>& weights = scene.nodes[group.first->node].morph_weights;
    if (weights.size() == group.targets) map.morphing[group.first->node].push_back(gltf_node);
    for (const float weight : weights) node.weights.push_back(double{weight});
    node.weights.resize(group.targets, 0);
  }
}

}  // namespace traces::gltf_export
