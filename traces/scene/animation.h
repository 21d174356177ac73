#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace traces {

struct Scene;

/// An index that points at nothing.
inline constexpr std::uint32_t kNone = 0xffffffffU;

/// Scale, then rotation, then translation.
struct Transform {
  glm::vec3 translation{0};
  glm::quat rotation{1, 0, 0, 0};  ///< w, x, y, z; unit
  glm::vec3 scale{1};
};

/// A coordinate system that things hang on. Its place in its parent's is `matrix` x transform (one of the two is the
/// identity in files).
struct Node {
  std::string name;
  std::uint32_t parent = kNone;
  glm::mat4 matrix{1};
  Transform rest;
  std::vector<float> morph_weights;  ///< weights of the mesh shown by this node, at rest
};

/// How one property of a node changes with time: key frames as in glTF. Before the first and after the last key the
/// value stands still.
struct Track {
  enum class Path : std::uint8_t { kTranslation, kRotation, kScale, kMorphWeights };
  enum class Interpolation : std::uint8_t { kStep, kLinear, kCubicSpline };
  std::uint32_t node = 0;
  Path path = Path::kTranslation;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;   ///< seconds, growing
  std::vector<float> values;  ///< per key: 3, 4 (x, y, z, w) or as many as morph targets; kCubicSpline: in-tangent,
                              ///< value, out-tangent
};

struct Skin {
  std::vector<std::uint32_t> joints;  ///< nodes
  std::vector<glm::mat4> inverse_bind;
};

/// Parts of the scene that pose() changed.
struct Moved {
  bool geometry = false;  ///< an instance or the vertices of a mesh
  bool view = false;      ///< a camera
  bool lights = false;
};

/// Puts the scene's instances, deforming meshes, cameras and lights where they are at that time. Depends on the time
/// alone, not on the pose before it, and has the same bits on every host. InputError where something goes further than
/// kFarthest from the origin.
///
/// Time is in seconds as the tracks have it. All tracks start together; a file is loaded as it is at time 0. Nothing
/// repeats: who wants a loop takes the time modulo duration().
Moved pose(Scene& scene, double seconds);

/// The last key of any track, in seconds; 0 for a still scene.
double duration(const Scene& scene);

}  // namespace traces
