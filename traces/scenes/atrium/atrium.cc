#include <glm/geometric.hpp>

#include "traces/scene/cameras.h"
#include "traces/scenes/atrium/parts.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/motion.h"

namespace traces {
namespace {

using namespace atrium;

Scene furnish(const Detail& detail) {
  Scene scene;
  scene.name = "atrium";
  scene.background = {0.50F, 0.68F, 0.92F};
  const Materials is = add_materials(scene);
  add_walls(scene, is, detail);
  add_arcades(scene, is, detail);
  add_columns(scene, is, detail);
  add_balustrades(scene, is, detail);
  add_cloth(scene, is, detail);
  add_fountain(scene, is, detail);
  add_plants(scene, is, detail);
  add_lanterns(scene, is, detail);
  return scene;
}

void add_cameras(Scene& scene) {
  scene.cameras.push_back(look_at("court", {-8.3F, 1.8F, 1.9F}, {1.5F, 3.3F, -0.9F}, 0.98F));
  scene.cameras.push_back(look_at("gallery", {-7.6F, 6.75F, 4.9F}, {3.0F, 4.2F, -2.5F}, 0.9F));
  scene.cameras.push_back(look_at("arcade", {-10.6F, 1.75F, -5.3F}, {2.0F, 1.9F, -3.9F}, 0.85F));
  const ViewKey keys[] = {{0, {-8.3F, 1.8F, 1.9F}, {1.5F, 3.3F, -0.9F}}, {5, {-4.5F, 1.8F, 1.9F}, {4, 3.0F, -1.0F}},
                          {10, {-0.5F, 2.6F, 1.8F}, {6, 3.2F, -2.2F}},   {15, {3.2F, 4.4F, 1.0F}, {8, 4.6F, -3.0F}},
                          {20, {5.6F, 6.2F, 0.2F}, {0.5F, 4.5F, -3.6F}}, {25, {4.2F, 6.8F, 0.8F}, {-5, 3.2F, -1.5F}}};
  add_camera_path(scene, "path", keys, 0.98F);
}

}  // namespace

/// A court with arcades on two storeys, like Marko Dabrovic's and Crytek's atrium of Sponza. Needs at least a quarter
/// of its class's triangles, as it has many different parts.
Scene build_atrium(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 66'000;
  Scene scene = build_to_size(options.triangles_or(kClass), furnish);
  paint_pictures(scene);
  add_cameras(scene);
  Light sun;
  sun.kind = Light::Kind::kDirectional;
  sun.direction = glm::normalize(glm::vec3(0.34F, -1, -0.36F));
  sun.intensity = {1.0F, 0.93F, 0.80F};
  scene.lights.push_back(sun);
  // Light that the sunlit wall and floor reflect into the galleries.
  for (const float x : {-4.6F, 5.2F}) {
    Light bounce;
    bounce.position = {x, 3.2F, -0.6F};
    bounce.intensity = {1.5F, 1.35F, 1.1F};
    scene.lights.push_back(bounce);
  }
  finish_scene(scene, {0.27F, 0.29F, 0.33F});
  return scene;
}

}  // namespace traces
