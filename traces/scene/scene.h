#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "traces/scene/animation.h"

namespace traces {

inline constexpr std::uint32_t kNoTexture = 0xffffffffU;

/// How a mesh deforms: by a skin, morph targets or both. The mesh's own arrays have the current pose; the arrays here
/// have its rest pose, in the same order.
struct Deformation {
  std::vector<glm::vec3> positions, normals;             ///< rest positions and normals; `normals` may be empty
  std::vector<glm::vec4> tangents;                       ///< rest tangents, or empty
  std::vector<std::array<std::uint16_t, 4>> joints;      ///< for each vertex, indices in Skin::joints; empty: no skin
  std::vector<glm::vec4> weights;                        ///< weights of those joints; their sum is 1
  std::vector<std::vector<glm::vec3>> target_positions;  ///< for each morph target, the displacements of all vertices
  std::vector<std::vector<glm::vec3>> target_normals;  ///< for each morph target, the changes of all normals, or empty
  std::uint32_t skin = kNone;                          ///< skin that deforms the mesh, as an index in Scene::skins
};

/// Vertices and triangles of one glTF primitive, in its own space. `normals` and the other attributes are empty or have
/// one value per vertex. KHR_texture_transform has been applied to texture coordinates. `uvs` serve the first texture
/// placement that the material uses, `second_uvs` the second.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> uvs, second_uvs;
  std::vector<glm::vec4> tangents;  ///< xyz along increasing u, w the sign of the bitangent; only with a normal map
  std::vector<glm::vec4> colours;   ///< vertex colours, linear RGBA; they multiply the base colour
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint32_t material = 0;
  std::shared_ptr<const Deformation> deformation;  ///< null if the mesh is rigid; a deforming mesh has one instance
};

/// A mesh placed in the world. Each primitive that a node shows has an instance of its own. The index in
/// Scene::instances is the object id.
struct Instance {
  std::uint32_t mesh = 0;
  glm::mat4 to_world{1};
  std::uint32_t node = kNone;  ///< node to which the instance is attached; kNone: it never moves
  bool focus = false;          ///< marks an object of interest (glTF: extras.focus), for object-selective sampling
};

/// A texture of RGBA texels with 8 bits per channel, top row first. Colour is sRGB-encoded if `srgb`.
struct Texture {
  enum class Wrap : std::uint8_t { kRepeat, kMirror, kClamp };
  enum class Filter : std::uint8_t { kLinear, kNearest };
  std::string name{};
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> texels{};  ///< RGBA words with R in the lowest byte
  bool srgb = true;
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  Filter filter = Filter::kLinear;
};

/// A material's reference to a texture.
struct TextureUse {
  std::uint32_t texture = kNoTexture;
  bool second_uv = false;  ///< the texture is looked up with Mesh::second_uvs
  bool is_used() const { return texture != kNoTexture; }
};

/// A Whitted surface: diffuse, mirror, refraction. All colours are linear.
///   radiance = emission + (1 - mirror) (1 - transmission) diffuse + mirror * mirror_tint * reflected + glass
///   diffuse = base colour * (ambient * occlusion + sum over lights of irradiance * cosine)
/// Glass splits `transmission` between reflection and refraction by Fresnel (Schlick) with `ior`; refraction is tinted
/// by the base colour. The 1/pi of Lambert's law is in the light units: at an irradiance of 1 a white surface has
/// radiance 1.
struct Material {
  enum class Alpha : std::uint8_t { kOpaque, kMask, kBlend };
  std::string name{};
  glm::vec3 base_colour{0.8F};
  TextureUse base_texture{};  ///< base colour, sRGB; its alpha is used unless `alpha` is kOpaque
  float mirror = 0;           ///< fraction of light that is mirrored, 0 to 1
  glm::vec3 mirror_tint{1};   ///< colour by which mirrored light is multiplied, as metals do
  float transmission = 0;     ///< fraction of light that is transmitted, 0 to 1
  float ior = 1.5F;
  glm::vec3 emission{0};
  TextureUse emission_texture{};  ///< sRGB texture, multiplied by `emission`

  /// Metal-roughness texture, linear: green multiplies `roughness`, blue multiplies `metallic`. If set, `mirror` and
  /// `mirror_tint` are ignored: shading computes both per texel from this texture, `dielectric` and `coat` by the rule
  /// of traces/scene/gltf/materials.h.
  TextureUse metal_rough_texture{};
  float metallic = 0, roughness = 1;
  float dielectric = 0.08F;  ///< fraction of light that the non-metallic part mirrors if it is smooth
  float coat = 0;            ///< fraction of light that a white clear coat mirrors
  /// Reflectance of microfacets at normal incidence. Set if the roughness is known, and used only in images with
  /// Roughness::kOn.
  std::optional<glm::vec3> facet_mirror{};

  TextureUse normal_texture{};  ///< normal map, linear, in tangent space
  float normal_scale = 1;
  TextureUse occlusion_texture{};  ///< red channel, linear; multiplies the ambient light only
  float occlusion_strength = 1;

  /// kMask: the surface exists only where alpha is at least `alpha_cutoff`. kBlend: the fraction 1 - alpha of the light
  /// passes straight through.
  Alpha alpha = Alpha::kOpaque;
  float opacity = 1;  ///< alpha, multiplied by that of the base texture and of the vertex colours
  float alpha_cutoff = 0.5F;
  glm::vec3 absorption{0};   ///< absorption per length in the body: light falls with exp(-absorption x length)
  bool double_sided = true;  ///< if false, rays pass through back faces unless the material transmits
  bool casts_light = true;   ///< an emission of 1 or more becomes a light (false for glTF's unlit surfaces)
};

struct Light {
  enum class Kind : std::uint8_t { kPoint, kDirectional, kSpot };
  Kind kind = Kind::kPoint;
  glm::vec3 position{0};
  glm::vec3 direction{0, -1, 0};       ///< unit vector in which light travels
  glm::vec3 intensity{1};              ///< intensity per steradian; for directional lights, the irradiance
  float cos_inner = 1, cos_outer = 0;  ///< cosines of the angles of the spot cone
  float range = 0;                     ///< distance at which the light is zero (KHR_lights_punctual); 0: unlimited
  std::uint32_t node = kNone;          ///< node to which the light is attached; kNone: it never moves
  glm::mat4 in_node{1};  ///< transform of the light in the node's space: origin at `position`, -z along `direction`
};

struct Camera {
  std::string name;
  glm::mat4 to_world{1};       ///< transform of the camera, which looks along -z with +y up; no scale
  float vertical_fov = 0.8F;   ///< vertical field of view in radians
  std::uint32_t node = kNone;  ///< node to which the camera is attached; kNone: it never moves
};

struct Scene {
  std::string name;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::vector<Node> nodes;  ///< all nodes; a parent precedes its children
  std::vector<Skin> skins;
  std::vector<Track> tracks;                ///< all animations' tracks; the first for a property of a node is used
  glm::vec3 background{0.6F, 0.7F, 0.85F};  ///< radiance of rays that leave the scene
  glm::vec3 ambient{0.1F};                  ///< constant irradiance that every surface receives
  std::string sha256;                       ///< hash of the file and the files it names, or of the generated scene
  std::vector<std::string> warnings;        ///< deviations from what the file specifies, one sentence each
};

}  // namespace traces
