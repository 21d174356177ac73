#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace traces {

inline constexpr std::uint32_t kNoTexture = 0xffffffffU;

/// Vertices and triangles of one glTF primitive, in its own space. `normals` and `uvs` are empty or one per vertex.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> uvs;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint32_t material = 0;
};

/// A mesh placed in the world. Its index in Scene::instances is the object id of (node instance, primitive).
struct Instance {
  std::uint32_t mesh = 0;
  glm::mat4 to_world{1};
};

/// RGBA, 8 bits a channel, top row first; colour is sRGB-encoded when `srgb`.
struct Texture {
  enum class Wrap : std::uint8_t { kRepeat, kMirror, kClamp };
  std::string name;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> texels;  ///< R in the lowest byte
  bool srgb = true;
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
};

/// Whitted-style: diffuse + mirror + refraction. All colours linear.
///   radiance = emission + (1 - mirror) (1 - transmission) diffuse + mirror * mirror_tint * reflected + glass
/// where glass splits `transmission` between reflection and refraction by Fresnel (Schlick) with `ior`, and
///   diffuse = base colour * (ambient + sum over lights of irradiance * cosine)
/// with the 1/pi of Lambert's law inside the light units: irradiance 1 makes a white surface shine with radiance 1.
struct Material {
  std::string name;
  glm::vec3 base_colour{0.8F};
  std::uint32_t base_texture = kNoTexture;
  float mirror = 0;          ///< share of light mirrored, 0..1
  glm::vec3 mirror_tint{1};  ///< metals tint what they mirror
  float transmission = 0;    ///< share of light that enters, 0..1
  float ior = 1.5F;
  glm::vec3 emission{0};
};

struct Light {
  enum class Kind : std::uint8_t { kPoint, kDirectional, kSpot };
  Kind kind = Kind::kPoint;
  glm::vec3 position{0};
  glm::vec3 direction{0, -1, 0};  ///< unit, the way the light travels
  glm::vec3 intensity{1};  ///< point and spot: per steradian (falls with distance squared); directional: irradiance
  float cos_inner = 1, cos_outer = 0;  ///< spot cone
};

struct Camera {
  std::string name;
  glm::mat4 to_world{1};      ///< looks along -z, +y up
  float vertical_fov = 0.8F;  ///< radians
};

struct Scene {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  glm::vec3 background{0.6F, 0.7F, 0.85F};  ///< radiance of rays that leave the scene
  glm::vec3 ambient{0.1F};                  ///< constant irradiance on every surface
  std::string sha256;                       ///< of the file (and the files it names), or of what the generator made
  std::vector<std::string> warnings;        ///< what of the file is not shown as it says, one sentence each
};

}  // namespace traces
