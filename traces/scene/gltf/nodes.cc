#include "traces/scene/gltf/nodes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "sim/io/printable.h"
#include "traces/scene/gltf/punctual_lights.h"
#include "traces/scene/gltf/values.h"

namespace traces::gltf {
namespace {

glm::dmat4 local_transform(const Context& context, const tinygltf::Node& node, const std::string& what) {
  if (!node.matrix.empty()) {
    if (node.matrix.size() != 16) context.refuse(what + ": a matrix has 16 numbers");
    glm::dmat4 m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
    return m;
  }
  const glm::dvec3 move = to_vec3(context, node.translation, glm::vec3(0), what + " translation");
  const glm::dvec3 scale = to_vec3(context, node.scale, glm::vec3(1), what + " scale");
  glm::dvec4 q = to_vec4(context, node.rotation, glm::vec4(0, 0, 0, 1), what + " rotation");
  const double length = glm::length(q);
  if (!(length > 0)) context.refuse(what + ": the rotation is null");
  q /= length;
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  glm::dmat4 m(1);
  m[0] = glm::dvec4(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0) * scale.x;
  m[1] = glm::dvec4(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0) * scale.y;
  m[2] = glm::dvec4(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0) * scale.z;
  m[3] = glm::dvec4(move, 1);
  return m;
}

constexpr double kFarthest = 1e15;  // in single precision, squares and products of two such coordinates are finite

double largest_entry(const glm::dmat4& m) {
  double largest = 0;
  for (int i = 0; i < 16; ++i) largest = std::max(largest, std::abs(m[i / 4][i % 4]));
  return largest;
}

void add_camera(Context& context, const tinygltf::Node& node, const glm::dmat4& to_world) {
  const tinygltf::Camera& found = context.at(context.model.cameras, node.camera, "cameras");
  const std::string name = sim::printable(!found.name.empty() ? found.name : node.name);
  if (found.type != "perspective") {
    context.warn(fmt::format("camera '{}': only perspective cameras are supported", name));
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
  Camera camera;
  camera.name = name.empty() ? fmt::format("camera {}", context.scene.cameras.size()) : name;
  camera.to_world = glm::mat4(glm::dmat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0), to_world[3]));
  camera.vertical_fov = static_cast<float>(fov);
  context.scene.cameras.push_back(camera);
}

void add_instances(Context& context, Meshes& meshes, const tinygltf::Node& node, const glm::dmat4& to_world,
                   const std::string& what) {
  constexpr std::uint64_t kTriangleBytes = 176;  // laid out for the GPU: triangle, attributes and its share of nodes
  if (node.skin >= 0) context.warn(what + ": the skin is not applied, the mesh is shown in its bind pose");
  if (!(std::abs(glm::determinant(glm::dmat3(to_world))) > 0)) {
    context.warn(what + " is scaled to nothing and left out");
    return;
  }
  for (const std::uint32_t mesh : meshes.primitives_of(node.mesh)) {
    const std::size_t triangles = context.scene.meshes[mesh].triangles.size();
    if (!(largest_entry(to_world) * (3.0 * static_cast<double>(meshes.reach_of(mesh)) + 1) <= kFarthest)) {
      context.refuse(fmt::format("{} reaches further than {} from the origin", what, kFarthest));
    }
    context.budget.take(triangles, kTriangleBytes, fmt::format("the triangles of {}", what));
    context.scene.instances.push_back({mesh, glm::mat4(to_world)});
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
    glm::dmat4 parent;
  };
  std::vector<Visit> open;
  const std::vector<int> roots = find_roots(context);
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({*root, glm::dmat4(1)});
  std::vector<bool> seen(context.model.nodes.size(), false);
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const tinygltf::Node& node = context.at(context.model.nodes, visit.node, "nodes");
    const std::string what =
        fmt::format("nodes[{}]{}{}", visit.node, node.name.empty() ? "" : " ", sim::printable(node.name));
    if (seen[static_cast<std::size_t>(visit.node)]) {
      context.refuse(what + " is reached twice; the hierarchy must be a tree");
    }
    seen[static_cast<std::size_t>(visit.node)] = true;
    const glm::dmat4 to_world = visit.parent * local_transform(context, node, what);
    if (!(largest_entry(to_world) <= kFarthest)) context.refuse(what + ": the transform is not finite or too large");
    if (node.mesh >= 0) add_instances(context, meshes, node, to_world, what);
    if (node.camera >= 0) add_camera(context, node, to_world);
    add_punctual_light(context, node, to_world);
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
      open.push_back({*child, to_world});
  }
}

}  // namespace traces::gltf
