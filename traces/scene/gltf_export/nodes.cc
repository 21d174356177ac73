#include "traces/scene/gltf_export/nodes.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "traces/scene/bounds.h"
#include "traces/scene/gltf_export/transforms.h"

namespace traces::gltf_export {
namespace {

bool is_identity(const Transform& t) {
  return t.translation == glm::vec3(0) && t.rotation == glm::quat(1, 0, 0, 0) && t.scale == glm::vec3(1);
}

std::vector<bool> animated_nodes(const Scene& scene) {
  std::vector<bool> animated(scene.nodes.size(), false);
  for (const Track& track : scene.tracks) {
    if (track.path != Track::Path::kMorphWeights) animated[track.node] = true;
  }
  return animated;
}

/// Returns the root of each of Scene::nodes.
std::vector<std::uint32_t> roots_of(const Scene& scene) {
  std::vector<std::uint32_t> roots;
  for (std::uint32_t i = 0; i < scene.nodes.size(); ++i) {
    const std::uint32_t parent = scene.nodes[i].parent;
    roots.push_back(parent == kNone ? i : roots[parent]);
  }
  return roots;
}

/// Moves all roots below one new node, except skinned meshes, which ignore their parent's transform.
void join_roots(Document& out) {
  std::vector<int>& roots = out.model.scenes[0].nodes;
  const auto joined = std::ranges::stable_partition(
      roots, [&](int root) { return out.model.nodes[static_cast<std::size_t>(root)].skin >= 0; });
  if (joined.size() < 2) return;
  tinygltf::Node root;
  root.children.assign(joined.begin(), joined.end());
  roots.erase(joined.begin(), joined.end());
  add_node(out, -1, std::move(root));
}

}  // namespace

int add_node(Document& out, int parent, tinygltf::Node node) {
  const int index = static_cast<int>(out.model.nodes.size());
  out.model.nodes.push_back(std::move(node));
  (parent < 0 ? out.model.scenes[0].nodes : out.model.nodes[static_cast<std::size_t>(parent)].children)
      .push_back(index);
  return index;
}

int add_placed(Document& out, int parent, const glm::mat4& matrix) {
  tinygltf::Node outer, inner;
  if (is_placement(matrix)) {
    set_transform(outer, matrix);
    return add_node(out, parent, outer);
  }
  const TwoPlacements two = split(matrix);
  set_transform(outer, two.outer);
  set_transform(inner, two.inner);
  return add_node(out, add_node(out, parent, outer), inner);
}

NodeMap write_nodes(const Scene& scene, Document& out) {
  const std::vector<bool> animated = animated_nodes(scene);
  NodeMap map;
  map.morphing.resize(scene.nodes.size());
  for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
    const Node& node = scene.nodes[i];
    int gltf_node = node.parent == kNone ? -1 : map.gltf_nodes[node.parent];
    const bool has_matrix = node.matrix != glm::mat4(1);
    if (has_matrix) gltf_node = add_placed(out, gltf_node, node.matrix);
    if (!has_matrix || animated[i] || !is_identity(node.rest)) {
      tinygltf::Node inner;
      set_transform(inner, node.rest);
      gltf_node = add_node(out, gltf_node, inner);
    }
    out.model.nodes[static_cast<std::size_t>(gltf_node)].name = node.name;
    map.gltf_nodes.push_back(gltf_node);
  }
  return map;
}

void write_skins(const Scene& scene, const NodeMap& map, Document& out) {
  const std::vector<std::uint32_t> roots = roots_of(scene);
  for (const std::uint32_t index : map.skins) {
    const Skin& skin = scene.skins[index];
    tinygltf::Skin to;
    std::set<std::uint32_t> joints, joint_roots;
    for (const std::uint32_t joint : skin.joints) {
      const int gltf_node = map.gltf_nodes[joint];
      to.joints.push_back(joints.insert(joint).second ? gltf_node : add_node(out, gltf_node, {}));
      joint_roots.insert(roots[joint]);
    }
    if (!skin.inverse_bind.empty()) to.inverseBindMatrices = out.add(skin.inverse_bind);
    out.model.skins.push_back(to);
    if (joint_roots.size() > 1) join_roots(out);
  }
}

void write_cameras(const Scene& scene, const NodeMap& map, Document& out) {
  const double size = std::max(static_cast<double>(world_bounds(scene).diagonal()), 1e-3);
  for (const Camera& camera : scene.cameras) {
    tinygltf::Camera to;
    to.type = "perspective";
    to.name = camera.name;
    to.perspective.yfov = double{camera.vertical_fov};
    to.perspective.znear = 1e-4 * size;
    to.perspective.zfar = 100 * size;
    int gltf_node = camera.node == kNone ? add_placed(out, -1, camera.to_world) : map.gltf_nodes[camera.node];
    if (out.model.nodes[static_cast<std::size_t>(gltf_node)].camera >= 0) gltf_node = add_node(out, gltf_node, {});
    tinygltf::Node& node = out.model.nodes[static_cast<std::size_t>(gltf_node)];
    node.camera = static_cast<int>(out.model.cameras.size());
    if (node.name.empty()) node.name = camera.name;
    out.model.cameras.push_back(to);
  }
  // The node with the first camera becomes the first root.
  const auto rank = [&](int root) {
    int least = std::numeric_limits<int>::max();
    std::vector<int> open{root};
    while (!open.empty()) {
      const tinygltf::Node& node = out.model.nodes[static_cast<std::size_t>(open.back())];
      open.pop_back();
      if (node.camera >= 0) least = std::min(least, node.camera);
      open.insert(open.end(), node.children.begin(), node.children.end());
    }
    return least;
  };
  std::ranges::stable_sort(out.model.scenes[0].nodes, {}, rank);
}

}  // namespace traces::gltf_export
