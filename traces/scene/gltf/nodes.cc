#include "traces/scene/gltf/nodes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include "sim/io/printable.h"
#include "traces/scene/cameras.h"
#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/context.h"
#include "traces/scene/pose.h"

namespace traces::gltf {
namespace {

/// Reads EXT_mesh_gpu_instancing: transforms at which the node shows its mesh, in the node's space. Empty if the node
/// does not use the extension.
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
      context.budget.take_memory(values.size(), sizeof(Node) + sizeof(Transform), what + " instances");
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

std::string unique_name(const std::vector<Camera>& cameras, const std::string& wish) {
  std::string name = wish;
  for (int i = 2; std::ranges::find(cameras, name, &Camera::name) != cameras.end(); ++i) {
    name = fmt::format("{} {}", wish, i);
  }
  return name;
}

/// Adds the camera of a node, if it has one; `index` is the node's index in Scene::nodes. Orthographic cameras are
/// omitted with a warning; a second camera of the same name gets a number as suffix.
void add_camera(Context& context, const tinygltf::Node& node, const glm::dmat4& to_world, std::uint32_t index) {
  constexpr std::size_t kMost = 1000;  // each new name is compared with all others
  if (node.camera < 0) return;
  const tinygltf::Camera& found = context.at(context.model.cameras, node.camera, "cameras");
  std::vector<Camera>& cameras = context.scene.cameras;
  std::string name = sim::printable(!found.name.empty() ? found.name : node.name);
  if (name.empty()) name = fmt::format("camera {}", node.camera);
  if (found.type != "perspective") {
    context.add_warning(fmt::format("camera '{}': only perspective cameras are supported", name));
    return;
  }
  if (cameras.size() == kMost) {
    context.add_warning(fmt::format("cameras after the first {} are left out", kMost));
    return;
  }
  const double fov = found.perspective.yfov;
  if (!(fov > 0 && fov < std::numbers::pi)) {
    context.refuse(fmt::format("cameras[{}]: yfov is {}; allowed is more than 0 and less than pi", node.camera, fov));
  }
  const std::optional<glm::mat4> standing = camera_to_world(to_world);
  if (!standing) {
    context.add_warning(fmt::format("camera '{}': its transform has no direction", name));
    return;
  }
  Camera camera;
  camera.name = unique_name(cameras, name);
  camera.to_world = *standing;
  camera.vertical_fov = static_cast<float>(fov);
  camera.node = index;
  cameras.push_back(camera);
}

/// Largest number of lights: each costs a shadow ray per visible surface.
constexpr std::size_t kMostLights = 1024;

/// Adds the light of a node (KHR_lights_punctual), if it has one; `index` is the node's index in Scene::nodes.
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
    context.add_warning(
        fmt::format("{}: the type '{}' is not point, spot or directional", what, sim::printable(found.type)));
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

/// Reads a glTF node with its transform relative to its parent. The parent itself is not set.
Node read_node(const Context& context, const tinygltf::Node& node, const std::string& what) {
  Node out;
  out.name = sim::printable(node.name);
  if (!node.matrix.empty()) {
    if (node.matrix.size() != 16) context.refuse(what + ": a matrix has 16 numbers");
    for (int i = 0; i < 16; ++i) {
      out.matrix[i / 4][i % 4] = to_float(context, node.matrix[static_cast<std::size_t>(i)], what + " matrix");
    }
    out.matrix = to_affine(out.matrix);
  }
  out.rest.translation = to_vec3(context, node.translation, glm::vec3(0), what + " translation");
  out.rest.scale = to_vec3(context, node.scale, glm::vec3(1), what + " scale");
  out.rest.rotation = to_rotation(context, node.rotation, what + " rotation");
  const std::vector<double>& weights = node.weights.empty() && node.mesh >= 0
                                           ? context.at(context.model.meshes, node.mesh, "meshes").weights
                                           : node.weights;
  for (const double weight : weights) out.morph_weights.push_back(to_float(context, weight, what + " weights"));
  return out;
}

glm::dmat4 local_matrix(const Node& node) {
  return glm::dmat4(node.matrix) * transform_matrix(node.rest.translation, node.rest.rotation, node.rest.scale);
}

bool has_focus(const tinygltf::Value& extras) {
  if (!extras.IsObject() || !extras.Has("focus")) return false;
  const tinygltf::Value& focus = extras.Get("focus");
  return focus.IsBool() && focus.Get<bool>();
}

/// Adds an instance at `to_world` for each primitive of the node's mesh, attached to Scene::nodes[index].
void add_instances(Context& context, Meshes& meshes, const tinygltf::Node& node, const glm::dmat4& to_world,
                   std::uint32_t index, const std::string& what) {
  constexpr std::uint64_t kTriangleBytes = 240;  // memory in the GPU: record, attributes and a part of the tree nodes
  const bool may_move = node.skin >= 0 || !context.model.animations.empty();
  if (!may_move && glm::dmat3(to_world) == glm::dmat3(0)) {
    context.add_warning(what + " is scaled to a point and left out");
    return;
  }
  const bool focus = has_focus(node.extras) || has_focus(context.at(context.model.meshes, node.mesh, "meshes").extras);
  for (const std::uint32_t mesh : meshes.primitives_of(node.mesh, node.skin)) {
    const std::size_t triangles = context.scene.meshes[mesh].triangles.size();
    if (!(largest_entry(to_world) * (3.0 * static_cast<double>(meshes.largest_coordinate(mesh)) + 1) <= kFarthest)) {
      context.refuse(fmt::format("{} reaches further than {} from the origin", what, kFarthest));
    }
    context.budget.take_memory(triangles, kTriangleBytes, fmt::format("the triangles of {}", what));
    context.scene.instances.push_back({mesh, glm::mat4(to_world), index, focus});
  }
}

/// Appends a node to Scene::nodes; returns its index.
std::uint32_t add_node(Context& context, Node node, std::uint32_t parent) {
  std::vector<Node>& nodes = context.scene.nodes;
  if (nodes.size() >= context.limits.nodes) {
    context.refuse(fmt::format("shows more nodes than the {} allowed", context.limits.nodes));
  }
  node.parent = parent;
  nodes.push_back(std::move(node));
  return static_cast<std::uint32_t>(nodes.size() - 1);
}

/// Adds a node's mesh to the scene: once, or once per transform in the node's EXT_mesh_gpu_instancing extension. Each
/// such transform becomes a scene node.
void show_mesh(Context& context, Meshes& meshes, const tinygltf::Node& node, const glm::dmat4& to_world,
               std::uint32_t index, const std::string& what) {
  const std::vector<Transform> copies = read_instancing(context, node, what);
  if (copies.empty()) add_instances(context, meshes, node, to_world, index, what);
  for (std::size_t i = 0; i < copies.size(); ++i) {
    Node copy;
    copy.name = fmt::format("{}[{}]", sim::printable(node.name), i);
    copy.rest = copies[i];
    copy.morph_weights = context.scene.nodes[index].morph_weights;
    const glm::dmat4 there = to_world * local_matrix(copy);
    add_instances(context, meshes, node, there, add_node(context, std::move(copy), index), what);
  }
}

std::vector<int> find_roots(const Context& context) {
  const tinygltf::Model& model = context.model;
  if (!model.scenes.empty()) {
    return context.at(model.scenes, model.defaultScene < 0 ? 0 : model.defaultScene, "scenes").nodes;
  }
  std::vector<bool> has_parent(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) {
      context.at(model.nodes, child, "nodes");
      has_parent[static_cast<std::size_t>(child)] = true;
    }
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < has_parent.size(); ++i) {
    if (!has_parent[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

}  // namespace

void read_nodes(Context& context, Meshes& meshes) {
  struct Visit {
    int node;
    std::uint32_t parent;
    glm::dmat4 parent_to_world;
  };
  std::vector<Visit> open;
  const std::vector<int> roots = find_roots(context);
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({*root, kNone, glm::dmat4(1)});
  context.scene_nodes.assign(context.model.nodes.size(), kNone);
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const tinygltf::Node& node = context.at(context.model.nodes, visit.node, "nodes");
    const std::string what =
        fmt::format("nodes[{}]{}{}", visit.node, node.name.empty() ? "" : " ", sim::printable(node.name));
    std::uint32_t& index = context.scene_nodes[static_cast<std::size_t>(visit.node)];
    if (index != kNone) context.refuse(what + " is reached twice; the hierarchy must be a tree");
    Node read = read_node(context, node, what);
    const glm::dmat4 to_world = visit.parent_to_world * local_matrix(read);
    if (!(largest_entry(to_world) <= kFarthest)) context.refuse(what + ": the transform is not finite or too large");
    index = add_node(context, std::move(read), visit.parent);
    if (node.mesh >= 0) show_mesh(context, meshes, node, to_world, index, what);
    add_camera(context, node, to_world, index);
    add_punctual_light(context, node, to_world, index);
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
      open.push_back({*child, index, to_world});
  }
}

}  // namespace traces::gltf
