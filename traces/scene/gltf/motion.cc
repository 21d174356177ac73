#include "traces/scene/gltf/motion.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "sim/io/printable.h"
#include "traces/scene/gltf/accessors.h"
#include "traces/scene/gltf/context.h"

namespace traces::gltf {
namespace {

int find_accessor(const std::map<std::string, int>& attributes, const std::string& name) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? -1 : found->second;
}

/// Returns one value per mesh vertex, given the values of the file's vertices: result i is all[from[i]].
template <class T>
std::vector<T> gather_vertex_values(const std::vector<T>& all, const std::vector<std::uint32_t>& from) {
  std::vector<T> picked;
  picked.reserve(from.size());
  for (const std::uint32_t i : from) picked.push_back(all[i]);
  return picked;
}

void check_value_count(const Context& context, const Mesh& mesh, std::size_t found, std::size_t vertices,
                       const char* what) {
  if (found != vertices) {
    context.refuse(fmt::format("mesh '{}': {} {} for {} vertices", mesh.name, found, what, vertices));
  }
}

/// The joints of a vertex with the largest weights so far, at most four.
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
  void normalise_weights() {
    const float sum = weights.x + weights.y + weights.z + weights.w;
    weights = sum > 0 ? weights / sum : glm::vec4(1, 0, 0, 0);
  }
};

void read_joint_set(Context& context, const tinygltf::Primitive& primitive, int set, std::size_t joint_count,
                    const Mesh& mesh, std::vector<Influences>& influences) {
  const int joints_at = find_accessor(primitive.attributes, fmt::format("JOINTS_{}", set));
  const int type = context.at(context.model.accessors, joints_at, "accessors").componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
    context.refuse(fmt::format("mesh '{}': joints of component type {}; allowed are 5121, 5123", mesh.name, type));
  }
  const auto joints = read_vec4(context, joints_at, "joints");
  const auto weights =
      read_vec4(context, find_accessor(primitive.attributes, fmt::format("WEIGHTS_{}", set)), "joint weights");
  check_value_count(context, mesh, joints.size(), influences.size(), "joints");
  check_value_count(context, mesh, weights.size(), influences.size(), "joint weights");
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
    return find_accessor(primitive.attributes, fmt::format("{}_{}", name, set)) >= 0;
  };
  if (!has("JOINTS", 0) || !has("WEIGHTS", 0)) return;
  const std::size_t joint_count = context.at(context.model.skins, skin, "skins").joints.size();
  if (joint_count == 0) context.refuse(fmt::format("skins[{}] has no joints", skin));
  context.budget.take_memory(vertices, 2 * sizeof(Influences), "the joints of mesh '" + mesh.name + "'");
  std::vector<Influences> influences(vertices);
  int set = 0;
  for (; has("JOINTS", set) && has("WEIGHTS", set); ++set) {
    read_joint_set(context, primitive, set, joint_count, mesh, influences);
  }
  if (set > 1)
    context.add_warning(fmt::format("mesh '{}': only the four largest weights of a vertex count", mesh.name));
  out.skin = static_cast<std::uint32_t>(skin);
  for (const std::uint32_t i : from) {
    influences[i].normalise_weights();
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
    const int accessor = find_accessor(target, attribute);
    if (accessor < 0) continue;
    const auto all = read_vec3(context, accessor, "morph target");
    check_value_count(context, mesh, all.size(), vertices, "displacements");
    context.budget.take_memory(from.size(), sizeof(glm::vec3), "a morph target of mesh '" + mesh.name + "'");
    picked = gather_vertex_values(all, from);
  }
  return targets;
}

/// Returns the inverse bind matrices of a skin; identities if it has none.
std::vector<glm::mat4> read_inverse_bind_matrices(Context& context, const tinygltf::Skin& skin, std::size_t index) {
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

bool is_deforming(const tinygltf::Primitive& primitive, int skin) {
  return !primitive.targets.empty() || (skin >= 0 && find_accessor(primitive.attributes, "JOINTS_0") >= 0);
}

std::shared_ptr<const Deformation> read_deformation(Context& context, const tinygltf::Primitive& primitive, int skin,
                                                    const Mesh& mesh, bool flat_normals,
                                                    const std::vector<std::uint32_t>& from) {
  const std::size_t vertices =
      context.at(context.model.accessors, find_accessor(primitive.attributes, "POSITION"), "accessors").count;
  context.budget.take_memory(mesh.positions.size(), 2 * sizeof(glm::vec3) + sizeof(glm::vec4),
                             "the rest of a moving mesh");
  auto out = std::make_shared<Deformation>();
  out->positions = mesh.positions;
  if (!flat_normals) out->normals = mesh.normals;
  out->tangents = mesh.tangents;
  if (skin >= 0) read_joints(context, primitive, skin, mesh, from, vertices, *out);
  out->target_positions = read_targets(context, primitive, "POSITION", mesh, from, vertices);
  if (!flat_normals) out->target_normals = read_targets(context, primitive, "NORMAL", mesh, from, vertices);
  return out;
}

void read_skins_and_morph_weights(Context& context) {
  Scene& scene = context.scene;
  scene.skins.resize(context.model.skins.size());
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.deformation == nullptr || mesh.deformation->skin == kNone) continue;
    const std::size_t index = mesh.deformation->skin;
    const tinygltf::Skin& found = context.model.skins[index];
    Skin& skin = scene.skins[index];
    if (!skin.joints.empty()) continue;
    skin.inverse_bind = read_inverse_bind_matrices(context, found, index);
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

namespace {

using Path = Track::Path;
using Interpolation = Track::Interpolation;

/// Returns which property of a node an animation channel moves. Adds a warning and returns no value if glTF does not
/// define that property.
std::optional<Path> read_path(Context& context, const std::string& name, const std::string& what) {
  if (name == "translation") return Path::kTranslation;
  if (name == "rotation") return Path::kRotation;
  if (name == "scale") return Path::kScale;
  if (name == "weights") return Path::kMorphWeights;
  context.add_warning(name == "pointer" ? what + ": KHR_animation_pointer is not supported, its channels stand still"
                                        : fmt::format("{}: the path '{}' is not known", what, sim::printable(name)));
  return std::nullopt;
}

Interpolation read_interpolation(const Context& context, const std::string& name, const std::string& what) {
  if (name.empty() || name == "LINEAR") return Interpolation::kLinear;
  if (name == "STEP") return Interpolation::kStep;
  if (name == "CUBICSPLINE") return Interpolation::kCubicSpline;
  context.refuse(
      fmt::format("{}: interpolation '{}'; allowed are LINEAR, STEP, CUBICSPLINE", what, sim::printable(name)));
}

template <class Vector>
std::vector<float> numbers_of(const std::vector<Vector>& vectors) {
  std::vector<float> numbers;
  numbers.reserve(vectors.size() * static_cast<std::size_t>(Vector::length()));
  for (const Vector& v : vectors) {
    for (int i = 0; i < Vector::length(); ++i) numbers.push_back(v[i]);
  }
  return numbers;
}

std::vector<float> read_values(Context& context, Path path, int accessor) {
  if (path == Path::kRotation) return numbers_of(read_vec4(context, accessor, "rotation keys"));
  if (path == Path::kMorphWeights) return read_floats(context, accessor, "weight keys");
  return numbers_of(read_vec3(context, accessor, "keys"));
}

std::size_t numbers_per_key(const Context& context, const Track& track) {
  const std::size_t parts = track.interpolation == Interpolation::kCubicSpline ? 3 : 1;
  if (track.path == Path::kRotation) return parts * 4;
  if (track.path == Path::kMorphWeights) return parts * context.scene.nodes[track.node].morph_weights.size();
  return parts * 3;
}

void read_keys(Context& context, const tinygltf::AnimationSampler& sampler, const std::string& what, Track& track) {
  track.interpolation = read_interpolation(context, sampler.interpolation, what);
  track.times = read_floats(context, sampler.input, "key times");
  if (!std::ranges::is_sorted(track.times)) context.refuse(what + ": the key times must grow");
  track.values = read_values(context, track.path, sampler.output);
  const std::size_t expected = numbers_per_key(context, track);
  if (track.values.size() != track.times.size() * expected) {
    context.refuse(
        fmt::format("{}: {} numbers for {} keys of {}", what, track.values.size(), track.times.size(), expected));
  }
}

}  // namespace

void read_animations(Context& context) {
  std::set<std::pair<std::uint32_t, Path>> taken;
  for (std::size_t a = 0; a < context.model.animations.size(); ++a) {
    const tinygltf::Animation& animation = context.model.animations[a];
    const std::string name =
        fmt::format("animations[{}]{}{}", a, animation.name.empty() ? "" : " ", sim::printable(animation.name));
    for (std::size_t c = 0; c < animation.channels.size(); ++c) {
      const tinygltf::AnimationChannel& channel = animation.channels[c];
      const std::optional<Path> path = read_path(context, channel.target_path, name);
      if (!path || channel.target_node < 0) continue;
      Track track;
      track.path = *path;
      track.node = context.at(context.scene_nodes, channel.target_node, "nodes");
      if (track.node == kNone) continue;
      const std::vector<float>& weights = context.scene.nodes[track.node].morph_weights;
      if (track.path == Path::kMorphWeights && weights.empty()) continue;
      if (!taken.emplace(track.node, track.path).second) {
        context.add_warning(name + " moves what is moved already: only the first counts");
        continue;
      }
      const auto& sampler = context.at(animation.samplers, channel.sampler, (name + ".samplers").c_str());
      read_keys(context, sampler, fmt::format("{}.channels[{}]", name, c), track);
      context.scene.tracks.push_back(std::move(track));
    }
  }
}

}  // namespace traces::gltf
