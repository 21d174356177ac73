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

/// A coordinate system that things can hang on; its index.
std::uint32_t add_node(Scene& scene, std::string name, const Transform& rest = {}, std::uint32_t parent = kNone);

/// The instance is shown at the node's place, its mesh in the node's space; its own to_world is forgotten.
void hang(Scene& scene, std::uint32_t instance, std::uint32_t node);

void move_node(Scene& scene, std::uint32_t node, std::span<const Key> keys,
               Track::Interpolation interpolation = Track::Interpolation::kLinear);
void turn_node(Scene& scene, std::uint32_t node, std::span<const TurnKey> keys);

/// Where a camera is and what it looks at.
struct ViewKey {
  float seconds;
  glm::vec3 eye, target;
};
/// A camera that flies smoothly (Catmull-Rom) through the keys, as a node with translation and rotation tracks sampled
/// `samples` times between two keys; at rest it is at the first key.
void add_camera_path(Scene& scene, std::string name, std::span<const ViewKey> keys, float vertical_fov,
                     std::uint32_t samples = 8);

/// The last step of every generator: things are put where they are at time 0, lights and exposure set, the digest
/// taken.
void finish_scene(Scene& scene, const glm::vec3& ambient = glm::vec3(kAmbient));

}  // namespace traces
