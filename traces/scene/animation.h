#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace traces {

struct Scene;

/// Index that means "none" in all of the scene's arrays.
inline constexpr std::uint32_t kNone = 0xffffffffU;

/// A transform that applies scale, then rotation, then translation.
struct Transform {
  glm::vec3 translation{0};
  glm::quat rotation{1, 0, 0, 0};  ///< unit quaternion in the order w, x, y, z
  glm::vec3 scale{1};
};

/// A coordinate system to which instances, cameras and lights are attached. The matrix relative to the parent is
/// `matrix` x `rest`; a glTF file sets only one of the two.
struct Node {
  std::string name;
  std::uint32_t parent = kNone;
  glm::mat4 matrix{1};
  Transform rest;
  std::vector<float> morph_weights;  ///< rest weights of the morph targets of the mesh that this node shows
};

/// Key frames of one property of a node, as in glTF. Before the first and after the last key the value is constant.
struct Track {
  enum class Path : std::uint8_t { kTranslation, kRotation, kScale, kMorphWeights };
  enum class Interpolation : std::uint8_t { kStep, kLinear, kCubicSpline };
  std::uint32_t node = 0;
  Path path = Path::kTranslation;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;   ///< time of each key in seconds, ascending
  std::vector<float> values;  ///< per key: a vector, a quaternion (x, y, z, w) or one weight per morph target.
                              ///< kCubicSpline: in-tangent, value and out-tangent
};

struct Skin {
  std::vector<std::uint32_t> joints;  ///< the skin's joints, as indices in Scene::nodes
  std::vector<glm::mat4> inverse_bind;
};

/// What a call of pose_scene() has changed.
struct Moved {
  bool geometry = false;  ///< an instance, or vertices of a mesh, moved
  bool view = false;      ///< a camera moved
  bool lights = false;
};

/// Moves instances, deforming meshes, cameras and lights to their poses at time `seconds`.
///
/// 1. The result depends only on the time, not on the previous pose, and has the same bits on every host.
/// 2. All tracks start at time 0. A file is loaded in its pose at time 0.
/// 3. An animation does not repeat; for a loop, pass the time modulo animation_seconds().
///
/// Throws InputError if something moves farther than kFarthest from the origin.
Moved pose_scene(Scene& scene, double seconds);

/// Returns the time of the last key of any track, in seconds; 0 for a still scene.
double animation_seconds(const Scene& scene);

}  // namespace traces
