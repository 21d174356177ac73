#include "traces/scene/gltf/nodes/skins.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/values.h"

namespace traces::gltf {
namespace {

int find(const std::map<std::string, int>& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? -1 : found->second;
}

/// Returns the values of the vertices that make up the mesh.
template <class T>
std::vector<T> pick(const std::vector<T>& all, const std::vector<std::uint32_t>& from) {
  std::vector<T> picked;
  picked.reserve(from.size());
  for (const std::uint32_t i : from) picked.push_back(all[i]);
  return picked;
}

void check_count(const Context& context, const Mesh& mesh, std::size_t found, std::size_t vertices, const char* what) {
  if (found != vertices) {
    context.refuse(fmt::format("mesh '{}': {} {} for {} vertices", mesh.name, found, what, vertices));
  }
}

/// The up to four joints of a vertex with the largest weights so far.
struct Influences {
  std::array<std::uint16_t, 4> joints{};
  glm::vec4 weights{0};

  void add(std::uint16_t joint, float weight) {
    int least = 0;
    for (int i = 1; i < 4; ++i) least = weights[i] < weights[least] ? i : least;
    if (!(weight > weights[least])) return;
    weights[least] = weight;
    joints[static_cast<std::size_t>(least)] = joint;
  }
  void make_whole() {
    const float sum = weights.x + weights.y + weights.z + weights.w;
    weights = sum > 0 ? weights / sum : glm::vec4(1, 0, 0, 0);
  }
};

void read_set(Context& context, const tinygltf::Primitive& primitive, int set, std::size_t joint_count,
              const Mesh& mesh, std::vector<Influences>& influences) {
  const int joints_at = find(primitive.attributes, fmt::format("JOINTS_{}", set));
  const int type = context.at(context.model.accessors, joints_at, "accessors").componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
    context.refuse(fmt::format("mesh '{}': joints of component type {}; allowed are 5121, 5123", mesh.name, type));
  }
  const auto joints = read_vec4(context, joints_at, "joints");
  const auto weights = read_vec4(context, find(primitive.attributes, fmt::format("WEIGHTS_{}", set)), "joint weights");
  check_count(context, mesh, joints.size(), influences.size(), "joints");
  check_count(context, mesh, weights.size(), influences.size(), "joint weights");
  for (std::size_t i = 0; i < influences.size(); ++i) {
    for (int k = 0; k < 4; ++k) {
      if (!(weights[i][k] > 0)) continue;
      const auto joint = static_cast<std::uint16_t>(joints[i][k]);
      if (joint >= joint_count) {
        context.refuse(fmt::format("mesh '{}': joint {} of a skin that has {}", mesh.name, joint, joint_count));
      }
      influences[i].add(joint, std::min(weights[i][k], 1e30F));
    }
  }
}

void read_joints(Context& context, const tinygltf::Primitive& primitive, int skin, const Mesh& mesh,
                 const std::vector<std::uint32_t>& from, std::size_t vertices, Deformation& out) {
  const auto has = [&](const char* name, int set) {
    return find(primitive.attributes, fmt::format("{}_{}", name, set)) >= 0;
  };
  if (!has("JOINTS", 0) || !has("WEIGHTS", 0)) return;
  const std::size_t joint_count = context.at(context.model.skins, skin, "skins").joints.size();
  if (joint_count == 0) context.refuse(fmt::format("skins[{}] has no joints", skin));
  context.budget.take(vertices, 2 * sizeof(Influences), "the joints of mesh '" + mesh.name + "'");
  std::vector<Influences> influences(vertices);
  int set = 0;
  for (; has("JOINTS", set) && has("WEIGHTS", set); ++set) {
    read_set(context, primitive, set, joint_count, mesh, influences);
  }
  if (set > 1) context.warn(fmt::format("mesh '{}': only the four largest weights of a vertex count", mesh.name));
  out.skin = static_cast<std::uint32_t>(skin);
  for (const std::uint32_t i : from) {
    influences[i].make_whole();
    out.joints.push_back(influences[i].joints);
    out.weights.push_back(influences[i].weights);
  }
}

std::vector<std::vector<glm::vec3>> read_targets(Context& context, const tinygltf::Primitive& primitive,
                                                 const char* attribute, const Mesh& mesh,
                                                 const std::vector<std::uint32_t>& from, std::size_t vertices) {
  std::vector<std::vector<glm::vec3>> targets;
  for (const auto& target : primitive.targets) {
    std::vector<glm::vec3>& picked = targets.emplace_back();
    const int accessor = find(target, attribute);
    if (accessor < 0) continue;
    const auto all = read_vec3(context, accessor, "morph target");
    check_count(context, mesh, all.size(), vertices, "displacements");
    context.budget.take(from.size(), sizeof(glm::vec3), "a morph target of mesh '" + mesh.name + "'");
    picked = pick(all, from);
  }
  return targets;
}

/// Returns the inverse bind matrices; identities if the skin has none.
std::vector<glm::mat4> read_inverse_bind(Context& context, const tinygltf::Skin& skin, std::size_t index) {
  if (skin.inverseBindMatrices < 0) return std::vector<glm::mat4>(skin.joints.size(), glm::mat4(1));
  std::vector<glm::mat4> matrices = read_mat4(context, skin.inverseBindMatrices, "inverse bind matrices");
  if (matrices.size() < skin.joints.size()) {
    context.refuse(
        fmt::format("skins[{}]: {} inverse bind matrices for {} joints", index, matrices.size(), skin.joints.size()));
  }
  matrices.resize(skin.joints.size());
  std::ranges::transform(matrices, matrices.begin(), to_affine);
  return matrices;
}

}  // namespace

bool deforms(const tinygltf::Primitive& primitive, int skin) {
  return !primitive.targets.empty() || (skin >= 0 && find(primitive.attributes, "JOINTS_0") >= 0);
}

std::shared_ptr<const Deformation> read_deformation(Context& context, const tinygltf::Primitive& primitive, int skin,
                                                    const Mesh& mesh, bool flat_normals,
                                                    const std::vector<std::uint32_t>& from) {
  const std::size_t vertices =
      context.at(context.model.accessors, find(primitive.attributes, "POSITION"), "accessors").count;
  context.budget.take(mesh.positions.size(), 2 * sizeof(glm::vec3) + sizeof(glm::vec4), "the rest of a moving mesh");
  auto out = std::make_shared<Deformation>();
  out->positions = mesh.positions;
  if (!flat_normals) out->normals = mesh.normals;
  out->tangents = mesh.tangents;
  if (skin >= 0) read_joints(context, primitive, skin, mesh, from, vertices, *out);
  out->target_positions = read_targets(context, primitive, "POSITION", mesh, from, vertices);
  if (!flat_normals) out->target_normals = read_targets(context, primitive, "NORMAL", mesh, from, vertices);
  return out;
}

void finish_deformations(Context& context) {
  Scene& scene = context.scene;
  scene.skins.resize(context.model.skins.size());
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.deformation == nullptr || mesh.deformation->skin == kNone) continue;
    const std::size_t index = mesh.deformation->skin;
    const tinygltf::Skin& found = context.model.skins[index];
    Skin& skin = scene.skins[index];
    if (!skin.joints.empty()) continue;
    skin.inverse_bind = read_inverse_bind(context, found, index);
    for (const int joint : found.joints) {
      const std::uint32_t node = context.at(context.scene_nodes, joint, "nodes");
      if (node == kNone) context.refuse(fmt::format("skins[{}]: joint nodes[{}] is not in the scene", index, joint));
      skin.joints.push_back(node);
    }
  }
  for (std::size_t i = 0; i < context.scene_nodes.size(); ++i) {
    const int mesh = context.model.nodes[i].mesh;
    if (context.scene_nodes[i] == kNone || mesh < 0) continue;
    const auto& primitives = context.model.meshes[static_cast<std::size_t>(mesh)].primitives;
    const std::size_t targets = primitives.empty() ? 0 : primitives.front().targets.size();
    scene.nodes[context.scene_nodes[i]].morph_weights.resize(targets, 0);
  }
}

}  // namespace traces::gltf
