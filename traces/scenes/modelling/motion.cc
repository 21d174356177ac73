#include "traces/scenes/modelling/motion.h"

#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "sim/sha256.h"
#include "traces/scene/cameras.h"
#include "traces/scene/lights.h"
#include "traces/scenes/modelling/shapes.h"

namespace traces {
namespace {

/// Returns the SHA-256 of everything in a scene that can change a picture.
std::string scene_digest(const Scene& scene) {
  std::string bytes = scene.name;
  const auto add = [&bytes](const auto& values) {
    if (!values.empty()) bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  for (const Mesh& mesh : scene.meshes) {
    add(mesh.positions);
    add(mesh.normals);
    add(mesh.uvs);
    add(mesh.triangles);
    add(std::vector<std::uint32_t>{mesh.material});
    if (mesh.deformation != nullptr) {
      add(mesh.deformation->joints);
      add(mesh.deformation->weights);
    }
  }
  for (const Instance& instance : scene.instances) {
    add(std::vector<std::uint32_t>{instance.mesh, instance.node});
    add(std::vector<glm::mat4>{instance.to_world});
  }
  for (const Node& node : scene.nodes) {
    add(std::vector<std::uint32_t>{node.parent});
    add(std::vector<glm::mat4>{node.matrix});
    add(std::vector<glm::vec3>{node.rest.translation, node.rest.scale});
    add(std::vector<glm::quat>{node.rest.rotation});
  }
  for (const Track& track : scene.tracks) {
    add(std::vector<std::uint32_t>{track.node, static_cast<std::uint32_t>(track.path)});
    add(track.times);
    add(track.values);
  }
  for (const Texture& texture : scene.textures) add(texture.texels);
  for (const Material& m : scene.materials) {
    add(std::vector<glm::vec3>{m.base_colour, m.mirror_tint, m.emission, m.absorption});
    add(std::vector<float>{m.mirror, m.transmission, m.ior, m.metallic, m.roughness, m.dielectric, m.coat,
                           m.normal_scale, m.occlusion_strength, m.opacity, m.alpha_cutoff});
    add(std::vector<std::uint32_t>{m.base_texture.texture, m.emission_texture.texture, m.metal_rough_texture.texture,
                                   m.normal_texture.texture, m.occlusion_texture.texture,
                                   static_cast<std::uint32_t>(m.alpha)});
  }
  for (const Light& l : scene.lights) add(std::vector<glm::vec3>{l.position, l.direction, l.intensity});
  for (const Camera& c : scene.cameras) {
    add(std::vector<glm::mat4>{c.to_world});
    add(std::vector<float>{c.vertical_fov});
  }
  add(std::vector<glm::vec3>{scene.background, scene.ambient});
  return sim::sha256_hex(bytes);
}

/// Returns the quaternion of a rotation matrix, computed with square roots only.
glm::quat rotation_quaternion(const glm::mat3& m) {
  glm::quat q;
  const float trace = m[0][0] + m[1][1] + m[2][2];
  if (trace > 0) {
    const float s = std::sqrt(trace + 1) * 2;
    q = {s / 4, (m[1][2] - m[2][1]) / s, (m[2][0] - m[0][2]) / s, (m[0][1] - m[1][0]) / s};
  } else {
    const int i = m[0][0] > m[1][1] ? (m[0][0] > m[2][2] ? 0 : 2) : (m[1][1] > m[2][2] ? 1 : 2);
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const float s = std::sqrt(1 + m[i][i] - m[j][j] - m[k][k]) * 2;
    glm::vec3 v;
    v[i] = s / 4;
    v[j] = (m[i][j] + m[j][i]) / s;
    v[k] = (m[i][k] + m[k][i]) / s;
    q = {(m[j][k] - m[k][j]) / s, v.x, v.y, v.z};
  }
  return glm::normalize(q);
}

}  // namespace

std::uint32_t add_node(Scene& scene, std::string name, const Transform& rest, std::uint32_t parent) {
  Node node;
  node.name = std::move(name);
  node.parent = parent;
  node.rest = rest;
  scene.nodes.push_back(std::move(node));
  return static_cast<std::uint32_t>(scene.nodes.size() - 1);
}

void attach_to_node(Scene& scene, std::uint32_t instance, std::uint32_t node) { scene.instances[instance].node = node; }

void add_translation_track(Scene& scene, std::uint32_t node, std::span<const Key> keys,
                           Track::Interpolation interpolation) {
  Track track{
      .node = node, .path = Track::Path::kTranslation, .interpolation = interpolation, .times = {}, .values = {}};
  for (const Key& key : keys) {
    track.times.push_back(key.seconds);
    track.values.insert(track.values.end(), {key.value.x, key.value.y, key.value.z});
  }
  scene.tracks.push_back(std::move(track));
}

void add_rotation_track(Scene& scene, std::uint32_t node, std::span<const TurnKey> keys) {
  Track track{.node = node, .path = Track::Path::kRotation, .times = {}, .values = {}};
  for (const TurnKey& key : keys) {
    track.times.push_back(key.seconds);
    track.values.insert(track.values.end(), {key.value.x, key.value.y, key.value.z, key.value.w});
  }
  scene.tracks.push_back(std::move(track));
}

void add_camera_path(Scene& scene, std::string name, std::span<const ViewKey> keys, float vertical_fov,
                     std::uint32_t samples) {
  std::vector<glm::vec3> eyes, targets;
  for (const ViewKey& key : keys) {
    eyes.push_back(key.eye);
    targets.push_back(key.target);
  }
  eyes = catmull_rom(std::span<const glm::vec3>(eyes), samples);
  targets = catmull_rom(std::span<const glm::vec3>(targets), samples);
  std::vector<Key> keys_of_eye;
  std::vector<TurnKey> turns;
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    const std::size_t k = i / samples;
    const float share = static_cast<float>(i % samples) / static_cast<float>(samples);
    const float after = keys[std::min(k + 1, keys.size() - 1)].seconds;
    const float seconds = keys[k].seconds + share * (after - keys[k].seconds);
    keys_of_eye.push_back({seconds, eyes[i]});
    glm::quat turn = rotation_quaternion(glm::mat3(look_at("", eyes[i], targets[i], vertical_fov).to_world));
    if (!turns.empty() && glm::dot(turns.back().value, turn) < 0) turn = -turn;
    turns.push_back({seconds, turn});
  }
  Camera camera = look_at(name, eyes.front(), targets.front(), vertical_fov);
  camera.node = add_node(scene, std::move(name), {.translation = eyes.front(), .rotation = turns.front().value});
  scene.cameras.push_back(std::move(camera));
  add_translation_track(scene, scene.cameras.back().node, keys_of_eye);
  add_rotation_track(scene, scene.cameras.back().node, turns);
}

void finish_scene(Scene& scene, const glm::vec3& ambient) {
  pose_scene(scene, 0);
  finish_lights(scene);
  scene.ambient = ambient;
  scene.sha256 = scene_digest(scene);
}

}  // namespace traces
