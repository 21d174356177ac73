#include "tests/traces/scene/feature_scene.h"

#include <memory>
#include <utility>

#include "traces/scene/cameras.h"

namespace test {
namespace {

using traces::Material;
using traces::Track;

traces::Texture texture(const char* name, std::uint32_t width, bool srgb, std::uint32_t seed) {
  traces::Texture t;
  t.name = name;
  t.width = t.height = width;
  t.srgb = srgb;
  for (std::uint32_t i = 0; i < width * width; ++i) t.texels.push_back((i * 0x01030507U + seed) | 0x80000000U);
  return t;
}

void add_textures(traces::Scene& scene) {
  scene.textures = {texture("colour", 8, true, 0x10203040),
                    texture("colour", 8, true, 0x10203040),
                    texture("metal and roughness", 4, false, 0xff000000),
                    texture("normals", 4, false, 0xffff8080),
                    texture("shade", 2, false, 0xff0000ff),
                    texture("glow", 2, true, 0xff101010)};
  scene.textures[1].wrap_u = traces::Texture::Wrap::kMirror;
  scene.textures[1].wrap_v = traces::Texture::Wrap::kClamp;
  scene.textures[1].filter = traces::Texture::Filter::kNearest;
}

void add_materials(traces::Scene& scene) {
  Material all, glass, metal, veil, sign;
  all.name = "all textures";
  all.base_texture.texture = 0;
  all.metal_rough_texture.texture = 2;
  all.metallic = 0.75F;
  all.roughness = 0.5F;
  all.dielectric = 0.1F;
  all.coat = 0.04F;
  all.normal_texture.texture = 3;
  all.normal_scale = 0.5F;
  all.occlusion_texture = {4, true};
  all.occlusion_strength = 0.75F;
  all.emission = {0.5F, 0.25F, 0.125F};
  all.emission_texture.texture = 5;
  all.alpha = Material::Alpha::kMask;
  all.alpha_cutoff = 0.25F;
  glass.name = "green glass";
  glass.base_colour = glm::vec3(1);
  glass.transmission = 0.9F;
  glass.ior = 1.33F;
  glass.absorption = {0.5F, 0.1F, 0.7F};
  metal.name = "gold";
  metal.base_colour = {1, 0.8F, 0.4F};
  metal.mirror = 0.9F;
  metal.double_sided = false;
  metal.mirror_tint = {1, 0.8F, 0.4F};
  veil.name = "veil";
  veil.base_texture.texture = 1;
  veil.alpha = Material::Alpha::kBlend;
  veil.opacity = 0.5F;
  sign.name = "sign";
  sign.base_colour = glm::vec3(0);
  sign.emission = {1, 0.5F, 0};
  sign.casts_light = false;
  scene.materials = {all, glass, metal, veil, sign};
}

/// Returns a mesh with four joints per vertex. As in real files, some are unused and one is named twice.
traces::Mesh skinned_quad() {
  traces::Mesh mesh = feature_quad("cloth", 2);
  traces::Deformation d;
  d.positions = mesh.positions;
  d.normals = mesh.normals;
  d.joints = {{0, 1, 0, 0}, {0, 1, 7, 7}, {0, 0, 1, 0}, {1, 0, 0, 0}};
  d.weights = {{0.5F, 0.5F, 0, 0}, {1, 0, 0, 0}, {0.25F, 0.25F, 0.5F, 0}, {1, 0, 0, 0}};
  d.skin = 0;
  mesh.deformation = std::make_shared<traces::Deformation>(std::move(d));
  return mesh;
}

traces::Mesh morphing_quad() {
  traces::Mesh mesh = feature_quad("flag", 3);
  traces::Deformation d;
  d.positions = mesh.positions;
  d.normals = mesh.normals;
  d.target_positions = {std::vector<glm::vec3>(4, {0, 0, 0.5F}), std::vector<glm::vec3>(4, {0, 0.25F, 0})};
  d.target_normals = {std::vector<glm::vec3>(4, {0.1F, 0, 0}), {}};
  mesh.deformation = std::make_shared<traces::Deformation>(std::move(d));
  return mesh;
}

traces::Node node(const char* name, std::uint32_t parent, const glm::vec3& translation) {
  traces::Node n;
  n.name = name;
  n.parent = parent;
  n.rest.translation = translation;
  return n;
}

void add_nodes(traces::Scene& scene) {
  traces::Node arm = node("arm", traces::kNone, {0, 0, -1}), flag = node("flag", 0, {1, 0, 0});
  traces::Node tilted = node("tilted", 0, glm::vec3(0));
  tilted.matrix[1][0] = 0.5F;  // not a rotation and scale
  flag.morph_weights = {0.25F, 0};
  scene.nodes = {arm, flag, tilted, node("hip", 0, {0, 1, 0}), node("knee", 3, {0, -0.5F, 0})};
  scene.skins.push_back({{3, 4}, {glm::mat4(1), glm::mat4(1)}});
}

void add_tracks(traces::Scene& scene) {
  const std::vector<float> times{0, 0.5F, 2};
  scene.tracks = {
      {0, Track::Path::kTranslation, Track::Interpolation::kLinear, times, {0, 0, -1, 1, 0, -1, 0, 0, -1}},
      {0, Track::Path::kRotation, Track::Interpolation::kStep, times, {0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0}},
      {2, Track::Path::kScale, Track::Interpolation::kCubicSpline, {0, 1}, std::vector<float>(18, 1)},
      {1, Track::Path::kMorphWeights, Track::Interpolation::kLinear, times, {0, 0, 1, 0.5F, 0, 1}},
      {4, Track::Path::kRotation, Track::Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, 1, 0, 0, 0}},
      {0, Track::Path::kTranslation, Track::Interpolation::kStep, {0, 9}, {7, 7, 7, 8, 8, 8}},  // has no effect
  };
}

void add_lights(traces::Scene& scene) {
  traces::Light sun, lamp, spot;
  sun.kind = traces::Light::Kind::kDirectional;
  sun.direction = glm::normalize(glm::vec3(0.2F, -1, -0.3F));
  sun.intensity = {0.7F, 0.6F, 0.5F};
  lamp.position = {0, 2, -1};
  lamp.intensity = {2, 3, 1};
  lamp.range = 20;
  lamp.node = 0;
  lamp.in_node[3] = glm::vec4(0, 2, 0, 1);
  spot.kind = traces::Light::Kind::kSpot;
  spot.position = {0, 3, 1};
  spot.direction = {0, -1, 0};
  spot.intensity = glm::vec3(4);
  spot.cos_inner = 0.95F;
  spot.cos_outer = 0.8F;
  scene.lights = {sun, lamp, spot};
}

}  // namespace

traces::Mesh feature_quad(const char* name, std::uint32_t material) {
  traces::Mesh mesh;
  mesh.name = name;
  mesh.material = material;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs = {{0, 2}, {2, 2}, {2, 0}, {0, 0}};
  mesh.second_uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.tangents.assign(4, {1, 0, 0, -1});
  mesh.colours = {{1, 1, 1, 1}, {1, 0.5F, 1, 1}, {1, 1, 0.5F, 0.75F}, {0.5F, 1, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

traces::Scene feature_scene() {
  traces::Scene scene;
  scene.name = "features";
  scene.background = {0.25F, 0.5F, 0.75F};
  scene.ambient = {0.1F, 0.2F, 0.3F};
  add_textures(scene);
  add_materials(scene);
  add_nodes(scene);
  add_tracks(scene);
  scene.meshes = {feature_quad("board", 0), feature_quad("pane", 1), feature_quad("sign", 4), skinned_quad(),
                  morphing_quad()};
  scene.meshes[2].colours.clear();  // loaders may fold an emitter's colours into its material
  glm::mat4 behind(1), sheared(1);
  behind[3] = glm::vec4(0.5F, 0, -2, 1);
  sheared[1][0] = 0.75F;
  sheared[3] = glm::vec4(-2, 0, -1, 1);
  scene.instances = {{0, behind, traces::kNone, true}, {0, sheared, traces::kNone, false}, {1, glm::mat4(1), 0, false},
                     {2, glm::mat4(1), 2, false},      {2, glm::mat4(1), 0, true},         {3, glm::mat4(1), 3, false},
                     {4, glm::mat4(1), 1, false}};
  add_lights(scene);
  traces::Camera still = traces::look_at("still", {0, 0.5F, 4}, {0, 0, 0}, 0.8F), moving = still;
  moving.name = "moving";
  moving.node = 0;
  scene.cameras = {still, moving};
  return scene;
}

}  // namespace test
