#include "traces/scene/gltf_export/nodes.h"

#include <algorithm>
#include <limits>

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
  for (const Skin& skin : scene.skins) {
    tinygltf::Skin to;
    for (const std::uint32_t joint : skin.joints) to.joints.push_back(map.gltf_nodes[joint]);
    if (!skin.inverse_bind.empty()) to.inverseBindMatrices = out.add(skin.inverse_bind);
    out.model.skins.push_back(to);
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
  // The node with the first camera comes first.
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
