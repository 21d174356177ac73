#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/conference/parts.h"
#include "traces/scenes/modelling/motion.h"

namespace traces {
namespace {

using namespace conference;

Scene furnish(const Detail& detail) {
  Scene scene;
  scene.name = "conference";
  scene.background = {0.72F, 0.82F, 0.95F};
  const Materials is = add_materials(scene);
  add_room(scene, is, detail);
  add_ceiling(scene, is, detail);
  add_windows(scene, is, detail);
  add_table(scene, is, detail);
  add_chairs(scene, is, detail);
  add_wall_things(scene, is, detail);
  add_table_things(scene, is, detail);
  add_plant(scene, is, detail);
  return scene;
}

void add_cameras(Scene& scene) {
  scene.cameras.push_back(look_at("corner", {-4.2F, 1.78F, 2.75F}, {0.75F, 0.72F, -0.45F}, 0.72F));
  scene.cameras.push_back(look_at("along", {-3.95F, 1.5F, -0.35F}, {2.5F, 0.8F, 0.15F}, 0.75F));
  scene.cameras.push_back(look_at("windows", {2.9F, 1.6F, -2.85F}, {-0.9F, 0.75F, 1.2F}, 0.78F));
  scene.cameras.push_back(look_at("seated", {-1.75F, 1.22F, -1.0F}, {1.6F, 0.72F, 0.75F}, 0.7F));
  scene.cameras.push_back(look_at("door", {4.15F, 2.35F, 2.3F}, {-1.6F, 0.7F, -0.9F}, 0.75F));
  const ViewKey keys[] = {
      {0, {-4.2F, 1.78F, 2.75F}, {0.75F, 0.72F, -0.45F}}, {4, {-2.0F, 1.7F, 2.6F}, {0.6F, 0.75F, 0}},
      {8, {1.2F, 1.6F, 2.5F}, {0.2F, 0.8F, -0.6F}},       {12, {3.6F, 1.6F, 1.6F}, {-0.4F, 0.8F, -0.5F}},
      {16, {4.0F, 1.7F, -0.6F}, {-1.2F, 0.8F, -0.2F}},    {20, {3.0F, 1.8F, -2.6F}, {-1.0F, 0.8F, 0.8F}}};
  add_camera_path(scene, "path", keys, 0.72F);
}

}  // namespace

/// A room like Anat Grynberg's and Greg Ward's conference room: much diffuse furniture under a lit ceiling.
Scene build_conference(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 190'000;
  Scene scene = build_to_size(options.triangles_or(kClass), furnish);
  paint_pictures(scene);
  add_cameras(scene);
  for (const float x : {-2.4F, 0.0F, 2.4F}) {
    Light light;
    light.position = {x, kHeight - 0.35F, 0};
    light.intensity = glm::vec3(1, 0.95F, 0.87F);
    scene.lights.push_back(light);
  }
  finish_scene(scene, {0.27F, 0.265F, 0.26F});
  return scene;
}

}  // namespace traces
