#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "traces/scene/animation.h"

namespace traces {

inline constexpr std::uint32_t kNoTexture = 0xffffffffU;

/// How the vertices of a mesh move by themselves: skinning, morph targets or both. The mesh's own arrays hold what is
/// shown; these hold what it is made from, in the same order.
struct Deformation {
  std::vector<glm::vec3> positions, normals;             ///< at rest; `normals` may be empty
  std::vector<glm::vec4> tangents;                       ///< at rest, or empty
  std::vector<std::array<std::uint16_t, 4>> joints;      ///< per vertex, into Skin::joints; empty: no skin
  std::vector<glm::vec4> weights;                        ///< weights of those joints, summing to 1
  std::vector<std::vector<glm::vec3>> target_positions;  ///< per morph target: displacements
  std::vector<std::vector<glm::vec3>> target_normals;    ///< the same, each may be empty
  std::uint32_t skin = kNone;                            ///< index in Scene::skins
};

/// Vertices and triangles of one glTF primitive, in its own space. `normals` is empty or one per vertex, and so are the
/// others. Texture coordinates stand as the material's textures want them (set and KHR_texture_transform applied):
/// `uvs` for the first placement that the material uses, `second_uvs` for the other one if it uses two.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> uvs, second_uvs;
  std::vector<glm::vec4> tangents;  ///< xyz along growing u, w the sign of the bitangent; where a normal map needs them
  std::vector<glm::vec4> colours;   ///< linear RGBA, multiply the base colour
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint32_t material = 0;
  std::shared_ptr<const Deformation> deformation;  ///< null: rigid. A deforming mesh has one instance.
};

/// A mesh placed in the world. Its index in Scene::instances is the object id of (node instance, primitive).
struct Instance {
  std::uint32_t mesh = 0;
  glm::mat4 to_world{1};
  std::uint32_t node = kNone;  ///< kNone: it never moves
  bool focus = false;          ///< an object of interest (glTF: extras.focus), for object-selective sampling
};

/// RGBA, 8 bits a channel, top row first; colour is sRGB-encoded when `srgb`.
struct Texture {
  enum class Wrap : std::uint8_t { kRepeat, kMirror, kClamp };
  enum class Filter : std::uint8_t { kLinear, kNearest };
  std::string name{};
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> texels{};  ///< R in the lowest byte
  bool srgb = true;
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  Filter filter = Filter::kLinear;
};

/// A texture as a material uses it.
struct TextureUse {
  std::uint32_t texture = kNoTexture;
  bool second_uv = false;  ///< looked up with Mesh::second_uvs
  bool used() const { return texture != kNoTexture; }
};

/// Whitted-style: diffuse + mirror + refraction. All colours linear.
///   radiance = emission + (1 - mirror) (1 - transmission) diffuse + mirror * mirror_tint * reflected + glass
/// where glass splits `transmission` between reflection and refraction by Fresnel (Schlick) with `ior`, refraction
/// tinted by the base colour, and
///   diffuse = base colour * (ambient * occlusion + sum over lights of irradiance * cosine)
/// with the 1/pi of Lambert's law inside the light units: irradiance 1 makes a white surface shine with radiance 1.
struct Material {
  enum class Alpha : std::uint8_t { kOpaque, kMask, kBlend };
  std::string name{};
  glm::vec3 base_colour{0.8F};
  TextureUse base_texture{};  ///< sRGB; its alpha counts unless `alpha` is kOpaque
  float mirror = 0;           ///< share of light mirrored, 0..1
  glm::vec3 mirror_tint{1};   ///< metals tint what they mirror
  float transmission = 0;     ///< share of light that enters, 0..1
  float ior = 1.5F;
  glm::vec3 emission{0};
  TextureUse emission_texture{};  ///< sRGB, times `emission`

  /// Linear: green x `roughness`, blue x `metallic`. With it `mirror` and `mirror_tint` are not used but made per texel
  /// by the rule of traces/scene/gltf/materials/materials.h from these and the two below.
  TextureUse metal_rough_texture{};
  float metallic = 0, roughness = 1;
  float dielectric = 0.08F;  ///< mirror share of what is no metal, at gloss 1
  float coat = 0;            ///< mirror share of a clear coat on top, white

  TextureUse normal_texture{};  ///< linear, in tangent space
  float normal_scale = 1;
  TextureUse occlusion_texture{};  ///< linear, red; dims the ambient light alone
  float occlusion_strength = 1;

  /// kMask: there is a surface only where alpha reaches `alpha_cutoff`. kBlend: a share 1 - alpha of the light passes
  /// straight through.
  Alpha alpha = Alpha::kOpaque;
  float opacity = 1;  ///< alpha, times the base texture's and the vertex colours'
  float alpha_cutoff = 0.5F;
  glm::vec3 absorption{0};   ///< per unit of length inside: light falls with exp(-absorption x length)
  bool double_sided = true;  ///< false: rays pass through back faces, unless the material transmits
  bool casts_light = true;   ///< an emission of 1 or more makes a light (not so for glTF's unlit surfaces)
};

struct Light {
  enum class Kind : std::uint8_t { kPoint, kDirectional, kSpot };
  Kind kind = Kind::kPoint;
  glm::vec3 position{0};
  glm::vec3 direction{0, -1, 0};  ///< unit, the way the light travels
  glm::vec3 intensity{1};  ///< point and spot: per steradian (falls with distance squared); directional: irradiance
  float cos_inner = 1, cos_outer = 0;  ///< spot cone
  float range = 0;                     ///< KHR_lights_punctual: where it has faded to nothing; 0: never
  std::uint32_t node = kNone;          ///< kNone: it never moves
  glm::mat4 in_node{1};                ///< its place in the node's space: origin at `position`, -z along `direction`
};

struct Camera {
  std::string name;
  glm::mat4 to_world{1};       ///< looks along -z, +y up; no scale
  float vertical_fov = 0.8F;   ///< radians
  std::uint32_t node = kNone;  ///< kNone: it never moves
};

struct Scene {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::vector<Node> nodes;  ///< a parent before its children
  std::vector<Skin> skins;
  std::vector<Track> tracks;                ///< all animations; the first for a node and path counts
  glm::vec3 background{0.6F, 0.7F, 0.85F};  ///< radiance of rays that leave the scene
  glm::vec3 ambient{0.1F};                  ///< constant irradiance on every surface
  std::string sha256;                 ///< hash of the file (and the files it names), or of what the generator made
  std::vector<std::string> warnings;  ///< what of the file is not shown as it says, one sentence each
};

}  // namespace traces
