#pragma once
#include <span>
#include <string>

#include "traces/scene/lights.h"
#include "traces/scene/scene.h"

namespace traces {

struct Key {
  float seconds;
  glm::vec3 value;
};
struct TurnKey {
  float seconds;
  glm::quat value;
};

/// Adds a node to the scene. Returns its index.
std::uint32_t add_node(Scene& scene, std::string name, const Transform& rest = {}, std::uint32_t parent = kNone);

/// Attaches an instance to a node, with its mesh in the node's space. Replaces the to_world matrix of the instance.
void attach_to_node(Scene& scene, std::uint32_t instance, std::uint32_t node);

void add_translation_track(Scene& scene, std::uint32_t node, std::span<const Key> keys,
                           Track::Interpolation interpolation = Track::Interpolation::kLinear);
void add_rotation_track(Scene& scene, std::uint32_t node, std::span<const TurnKey> keys);

/// Position and target of a camera at one time of its path.
struct ViewKey {
  float seconds;
  glm::vec3 eye, target;
};
/// Adds a camera that moves smoothly (Catmull-Rom) through the keys: a node with translation and rotation tracks,
/// sampled `samples` times between two keys. The rest position of the camera is that of the first key.
void add_camera_path(Scene& scene, std::string name, std::span<const ViewKey> keys, float vertical_fov,
                     std::uint32_t samples = 8);

/// Completes a generated scene: poses it at time 0, sets lights and exposure, computes the digest.
void finish_scene(Scene& scene, const glm::vec3& ambient = glm::vec3(kAmbient));

}  // namespace traces
