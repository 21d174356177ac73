#include "traces/scene/gltf_export/nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "traces/scene/bounds.h"

namespace traces::gltf_export {
namespace {

/// Makes columns p and q of `m` orthogonal by a rotation, which is accumulated in `v`. One step of the one-sided Jacobi
/// method; m x transpose(v) is unchanged.
void rotate_columns(glm::dmat3& m, glm::dmat3& v, int p, int q) {
  const double alpha = glm::dot(m[p], m[p]), beta = glm::dot(m[q], m[q]), gamma = glm::dot(m[p], m[q]);
  if (!(std::abs(gamma) > 1e-16 * std::sqrt(alpha * beta))) return;
  const double zeta = (beta - alpha) / (2 * gamma);
  const double t = (zeta < 0 ? -1 : 1) / (std::abs(zeta) + std::sqrt(1 + zeta * zeta));
  const double c = 1 / std::sqrt(1 + t * t), s = c * t;
  for (glm::dmat3* each : {&m, &v}) {
    const glm::dvec3 a = (*each)[p], b = (*each)[q];
    (*each)[p] = c * a - s * b;
    (*each)[q] = s * a + c * b;
  }
}

/// Returns the columns of `m` scaled to length 1, and their lengths. Columns without direction, as in a flat matrix,
/// are replaced so that all three are orthogonal; their lengths become 0.
glm::dmat3 unit_columns(const glm::dmat3& m, glm::dvec3& lengths) {
  const double least = 1e-12 * std::max({lengths.x, lengths.y, lengths.z});
  glm::dmat3 out(1);
  int known = 0, last = 0;
  for (int i = 0; i < 3; ++i) {
    if (!(lengths[i] > least)) {
      lengths[i] = 0;
      continue;
    }
    out[i] = m[i] / lengths[i];
    last = i;
    ++known;
  }
  if (known == 0) return out;
  const auto next = [](int i, int by) { return (i + by) % 3; };
  if (known == 1) {
    const glm::dvec3 other = std::abs(out[last].x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    out[next(last, 1)] = glm::normalize(glm::cross(other, out[last]));
    out[next(last, 2)] = glm::cross(out[last], out[next(last, 1)]);
  }
  for (int i = 0; known == 2 && i < 3; ++i) {
    if (lengths[i] == 0) out[i] = glm::cross(out[next(i, 1)], out[next(i, 2)]);
  }
  return out;
}

void set_unless_default(std::vector<double>& list, const glm::dvec3& v, const glm::dvec3& normal) {
  if (v != normal) list = {v.x, v.y, v.z};
}

}  // namespace

bool is_placement(const glm::mat4& matrix) {
  constexpr double kMost = 1e-5;  // an absolute difference, as in glTF validators
  const glm::dmat3 m(matrix);
  if (matrix[0].w != 0 || matrix[1].w != 0 || matrix[2].w != 0 || matrix[3].w != 1) return false;
  const double longest = std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])});
  const double shear =
      std::max({std::abs(glm::dot(m[0], m[1])), std::abs(glm::dot(m[1], m[2])), std::abs(glm::dot(m[2], m[0]))});
  return shear <= kMost * std::max(longest, 1e-300) && glm::determinant(m) != 0;
}

TwoPlacements split_matrix(const glm::mat4& matrix) {
  glm::dmat3 m(matrix), turns(1);
  for (int sweep = 0; sweep < 30; ++sweep) {
    rotate_columns(m, turns, 0, 1);
    rotate_columns(m, turns, 0, 2);
    rotate_columns(m, turns, 1, 2);
  }
  // matrix = m x transpose(turns). The columns of m are orthogonal, and their lengths are the scale.
  TwoPlacements out;
  out.outer.translation = glm::dvec3(matrix[3]);
  for (int i = 0; i < 3; ++i) out.outer.scale[i] = glm::length(m[i]);
  glm::dmat3 outer = unit_columns(m, out.outer.scale);
  if (glm::determinant(outer) < 0) {
    outer[2] = -outer[2];
    out.outer.scale[2] = -out.outer.scale[2];
  }
  out.outer.rotation = glm::normalize(glm::quat_cast(outer));
  out.inner.rotation = glm::normalize(glm::quat_cast(glm::transpose(turns)));
  return out;
}

void set_transform(tinygltf::Node& node, const Placement& placement) {
  const glm::dquat& q = placement.rotation;
  set_unless_default(node.translation, placement.translation, glm::dvec3(0));
  if (q != glm::dquat(1, 0, 0, 0)) node.rotation = {q.x, q.y, q.z, q.w};
  set_unless_default(node.scale, placement.scale, glm::dvec3(1));
}

void set_transform(tinygltf::Node& node, const Transform& transform) {
  const glm::quat& q = transform.rotation;
  set_transform(
      node, Placement{glm::dvec3(transform.translation), glm::dquat(double{q.w}, double{q.x}, double{q.y}, double{q.z}),
                      glm::dvec3(transform.scale)});
}

void set_transform(tinygltf::Node& node, const glm::mat4& matrix) {
  if (matrix == glm::mat4(1)) return;
  for (int i = 0; i < 16; ++i) node.matrix.push_back(double{matrix[i / 4][i % 4]});
}

namespace {

/// Merges repeated joints of a vertex and replaces unused ones by joint 0, as glTF demands.
void tidy_joints(std::array<std::uint16_t, 4>& joints, glm::vec4& weights) {
  for (int i = 0; i < 4; ++i) {
    for (int earlier = 0; earlier < i; ++earlier) {
      const bool same = joints[static_cast<std::size_t>(i)] == joints[static_cast<std::size_t>(earlier)];
      if (!same || !(weights[earlier] > 0)) continue;
      weights[earlier] += weights[i];
      weights[i] = 0;
    }
    if (!(weights[i] > 0)) joints[static_cast<std::size_t>(i)] = 0;
  }
}

/// Returns how many sets of texture coordinates the material's textures use.
int count_uv_sets(const Material& m) {
  int sets = 0;
  for (const TextureUse& use :
       {m.base_texture, m.emission_texture, m.metal_rough_texture, m.normal_texture, m.occlusion_texture}) {
    if (use.is_used()) sets = std::max(sets, use.second_uv ? 2 : 1);
  }
  return sets;
}

void write_deformation(const Deformation& d, tinygltf::Primitive& to, Document& out) {
  if (!d.joints.empty()) {
    std::vector<std::array<std::uint16_t, 4>> joints = d.joints;
    std::vector<glm::vec4> weights = d.weights;
    for (std::size_t i = 0; i < joints.size(); ++i) tidy_joints(joints[i], weights[i]);
    to.attributes["JOINTS_0"] = out.add_array(joints);
    to.attributes["WEIGHTS_0"] = out.add_array(weights);
  }
  for (std::size_t i = 0; i < d.target_positions.size(); ++i) {
    std::map<std::string, int>& target = to.targets.emplace_back();
    target["POSITION"] = out.add_array(d.target_positions[i], true);
    if (!d.normals.empty() && i < d.target_normals.size() && !d.target_normals[i].empty())
      target["NORMAL"] = out.add_array(d.target_normals[i]);
  }
}

}  // namespace

tinygltf::Primitive Meshes::write_primitive(const Mesh& mesh) {
  const Deformation* d = mesh.deformation.get();
  tinygltf::Primitive to;
  to.mode = TINYGLTF_MODE_TRIANGLES;
  if (mesh.material < scene_.materials.size()) to.material = static_cast<int>(mesh.material);
  const std::vector<glm::vec3>& normals = d != nullptr ? d->normals : mesh.normals;
  const std::vector<glm::vec4>& tangents = d != nullptr ? d->tangents : mesh.tangents;
  to.attributes["POSITION"] = out_.add_array(d != nullptr ? d->positions : mesh.positions, true);
  if (!normals.empty()) to.attributes["NORMAL"] = out_.add_array(normals);
  if (!normals.empty() && !tangents.empty()) to.attributes["TANGENT"] = out_.add_array(tangents);
  const int sets = to.material < 0 ? 0 : count_uv_sets(scene_.materials[mesh.material]);
  const std::vector<glm::vec2> none(mesh.positions.size());  // textures without coordinates are looked up at (0, 0)
  if (!mesh.uvs.empty() || sets > 0) to.attributes["TEXCOORD_0"] = out_.add_array(mesh.uvs.empty() ? none : mesh.uvs);
  if (sets > 1) to.attributes["TEXCOORD_1"] = out_.add_array(mesh.second_uvs.empty() ? none : mesh.second_uvs);
  if (!mesh.colours.empty()) {
    std::vector<glm::vec4> colours = mesh.colours;
    for (glm::vec4& colour : colours) colour = glm::clamp(colour, 0.0F, 1.0F);
    to.attributes["COLOR_0"] = out_.add_array(colours);
  }
  if (d != nullptr) write_deformation(*d, to, out_);
  to.indices =
      out_.add_array(mesh.triangles, mesh.positions.size() > 0xffff);  // 0xffff itself is not a valid 16-bit index
  return to;
}

const tinygltf::Primitive& Meshes::primitive_of(std::uint32_t mesh) {
  const auto found = primitives_.find(mesh);
  if (found != primitives_.end()) return found->second;
  return primitives_.emplace(mesh, write_primitive(scene_.meshes[mesh])).first->second;
}

int Meshes::gltf_mesh_of(const std::vector<std::uint32_t>& parts) {
  const auto [entry, is_new] = meshes_.try_emplace(parts, static_cast<int>(out_.model.meshes.size()));
  if (!is_new) return entry->second;
  tinygltf::Mesh to;
  to.name = scene_.meshes[parts.front()].name;
  for (const std::uint32_t part : parts) to.primitives.push_back(primitive_of(part));
  out_.model.meshes.push_back(to);
  return entry->second;
}

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

/// Returns for each of Scene::nodes the root of its tree.
std::vector<std::uint32_t> roots_of(const Scene& scene) {
  std::vector<std::uint32_t> roots;
  for (std::uint32_t i = 0; i < scene.nodes.size(); ++i) {
    const std::uint32_t parent = scene.nodes[i].parent;
    roots.push_back(parent == kNone ? i : roots[parent]);
  }
  return roots;
}

/// Moves all root nodes below one new node, except skinned meshes, which ignore the transform of their parent.
void put_roots_under_one_node(Document& out) {
  std::vector<int>& roots = out.model.scenes[0].nodes;
  const auto joined = std::stable_partition(
      roots.begin(), roots.end(), [&](int root) { return out.model.nodes[static_cast<std::size_t>(root)].skin >= 0; });
  if (roots.end() - joined < 2) return;
  tinygltf::Node root;
  root.children.assign(joined, roots.end());
  roots.erase(joined, roots.end());
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
  const TwoPlacements two = split_matrix(matrix);
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
    if (!skin.inverse_bind.empty()) to.inverseBindMatrices = out.add_array(skin.inverse_bind);
    out.model.skins.push_back(to);
    if (joint_roots.size() > 1) put_roots_under_one_node(out);
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

namespace {

/// Instances on one node that become the primitives of one glTF mesh.
struct Group {
  const Instance* first = nullptr;
  std::uint32_t skin = kNone;
  std::size_t targets = 0;
  std::vector<std::uint32_t> parts;  ///< meshes of the group, as indices in Scene::meshes
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
    const int mesh = meshes.gltf_mesh_of(group.parts);
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

namespace {

/// Stores a node's light index in the member that tinygltf 2.9 and later need; they drop the extension without it.
template <class Node>
void set_node_light(Node& node, int light) {
  if constexpr (requires { node.light; }) node.light = light;
}

/// Returns a matrix with the light's position as origin and the light's direction as -z.
glm::mat4 light_matrix(const Light& light) {
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

tinygltf::Light gltf_light(const Light& light, float strongest) {
  tinygltf::Light to;
  to.intensity = double{strongest} * std::numbers::pi;
  to.color = to_numbers(light.intensity / strongest);
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
      gltf_node = add_placed(out, -1, light_matrix(light));
    } else {
      gltf_node = map.gltf_nodes[light.node];
      const bool taken =
          out.model.nodes[static_cast<std::size_t>(gltf_node)].extensions.contains("KHR_lights_punctual");
      if (taken || light.in_node != glm::mat4(1)) gltf_node = add_placed(out, gltf_node, light.in_node);
    }
    tinygltf::Node& node = out.model.nodes[static_cast<std::size_t>(gltf_node)];
    const int index = static_cast<int>(out.model.lights.size());
    out.add_extension(node.extensions, "KHR_lights_punctual", {{"light", tinygltf::Value(index)}});
    set_node_light(node, index);
    if (node.name.empty()) node.name = "light";
    out.model.lights.push_back(gltf_light(light, strongest));
  }
  const tinygltf::Value::Object ours{{"background", to_value(scene.background)}, {"ambient", to_value(scene.ambient)}};
  out.model.scenes[0].extras = tinygltf::Value(tinygltf::Value::Object{{"raywatt", tinygltf::Value(ours)}});
}

}  // namespace traces::gltf_export
