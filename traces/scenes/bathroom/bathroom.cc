#include "traces/scene/cameras.h"
#include "traces/scenes/bathroom/parts.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/motion.h"

namespace traces {
namespace {

using namespace bathroom;

Scene furnish(const Detail& detail) {
  Scene scene;
  scene.name = "bathroom";
  scene.background = glm::vec3(0.3F);
  const Materials is = add_materials(scene);
  add_walls(scene, is, detail);
  add_tub(scene, is, detail);
  add_vanity(scene, is, detail);
  add_basin(scene, is, detail);
  add_mirror(scene, is, detail);
  add_toilet(scene, is, detail);
  add_shower(scene, is, detail);
  add_towels(scene, is, detail);
  add_mat(scene, is, detail);
  add_baskets(scene, is, detail);
  add_toiletries(scene, is, detail);
  return scene;
}

void add_cameras(Scene& scene) {
  scene.cameras.push_back(look_at("door", {-0.05F, 1.52F, 1.38F}, {0, 0.9F, -1.2F}, 0.93F));
  scene.cameras.push_back(look_at("basin", {0.45F, 1.38F, -0.3F}, {1.05F, 1.1F, -1.4F}, 0.8F));
  scene.cameras.push_back(look_at("shower", {-0.5F, 1.4F, -0.85F}, {-1.7F, 1.1F, -1.12F}, 0.9F));
  const ViewKey keys[] = {{0, {-0.05F, 1.52F, 1.3F}, {0, 0.9F, -1.2F}},
                          {4, {-0.6F, 1.4F, 0.7F}, {0.7F, 1.0F, -1.3F}},
                          {8, {0.1F, 1.4F, 0.0F}, {1.0F, 1.15F, -1.4F}},
                          {12, {0.5F, 1.35F, 0.1F}, {-0.4F, 0.9F, -1.2F}},
                          {16, {0.2F, 1.3F, 0.3F}, {-1.4F, 0.9F, -1.0F}}};
  add_camera_path(scene, "path", keys, 0.9F);
}

void add_light(Scene& scene, const glm::vec3& position, const glm::vec3& intensity) {
  Light light;
  light.position = position;
  light.intensity = intensity;
  scene.lights.push_back(light);
}

}  // namespace

/// A bathroom: mirrors and chrome, a glass screen, and many parts thinner than a pixel (hose, rails, wires, bristles,
/// tufts).
Scene build_bathroom(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 270'000;
  Scene scene = build_to_size(options.triangles_or(kClass), furnish);
  paint_pictures(scene);
  add_cameras(scene);
  add_light(scene, {-0.3F, kHeight - 0.3F, 0.25F}, {1, 0.96F, 0.9F});
  add_light(scene, {1.0F, 2.12F, -1.12F}, {0.4F, 0.37F, 0.32F});
  add_light(scene, {-1.0F, kHeight - 0.15F, -1.0F}, {0.4F, 0.39F, 0.37F});  // between shower screen and wall
  finish_scene(scene, {0.28F, 0.285F, 0.29F});
  return scene;
}

}  // namespace traces
