#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/detail.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/shapes.h"

namespace traces {

/// Builds the Cornell box, twice as wide as high. The camera is where the open front just fills a 2:1 picture.
Scene build_cornell(const BuiltinOptions& options) {
  constexpr std::uint32_t kTriangles = 10'338;  // number of triangles with 16 and 18 cells
  const Detail detail = detail_for(options.triangles_or_default(kTriangles), kTriangles);
  const std::uint32_t wall_cells = detail.cell_count(16, 2), sphere_cells = detail.cell_count(18, 4);
  Scene scene;
  scene.name = "cornell";
  scene.background = glm::vec3(0.02F);

  Material white, red, green, glass, mirror, lamp;
  white.name = "white";
  white.base_colour = {0.76F, 0.75F, 0.70F};
  red.name = "red";
  red.base_colour = {0.63F, 0.07F, 0.05F};
  green.name = "green";
  green.base_colour = {0.15F, 0.48F, 0.09F};
  glass.name = "glass";
  glass.base_colour = glm::vec3(1);
  glass.transmission = 1;
  mirror.name = "mirror";
  mirror.base_colour = glm::vec3(0.9F);
  mirror.mirror = 0.9F;
  lamp.name = "lamp";
  lamp.base_colour = glm::vec3(0);
  lamp.emission = {17, 14, 9.5F};
  const std::uint32_t white_id = add_material(scene, white);
  const std::uint32_t red_id = add_material(scene, red);
  const std::uint32_t green_id = add_material(scene, green);
  const std::uint32_t glass_id = add_material(scene, glass);
  const std::uint32_t mirror_id = add_material(scene, mirror);
  const std::uint32_t lamp_id = add_material(scene, lamp);

  const glm::vec3 x(4, 0, 0), y(0, 2, 0), z(0, 0, 2);
  add_object(scene, make_quad("floor", {-2, -1, -1}, z, x, wall_cells), white_id);
  add_object(scene, make_quad("ceiling", {-2, 1, -1}, x, z, wall_cells), white_id);
  add_object(scene, make_quad("back wall", {-2, -1, -1}, x, y, wall_cells), white_id);
  add_object(scene, make_quad("left wall", {-2, -1, -1}, y, z, wall_cells), red_id);
  add_object(scene, make_quad("right wall", {2, -1, -1}, z, y, wall_cells), green_id);
  add_object(scene, make_sphere("mirror sphere", {-0.85F, -0.45F, -0.3F}, 0.55F, sphere_cells), mirror_id);
  add_object(scene, make_sphere("glass sphere", {0.8F, -0.5F, 0.25F}, 0.5F, sphere_cells), glass_id);
  add_object(scene, make_quad("lamp", {-0.5F, 0.9998F, -0.05F}, {1, 0, 0}, {0, 0, 0.5F}, 1), lamp_id);

  scene.cameras.push_back(look_at("front", {0, 0, 3.4F}, {0, 0, 0}, 0.7896F));
  const ViewKey path[] = {{0, {0, 0, 3.4F}, {0, 0, 0}},
                          {2.5F, {-1.1F, 0.25F, 2.3F}, {-0.2F, -0.2F, 0}},
                          {5, {-0.2F, 0.3F, 1.3F}, {0, -0.4F, 0}},
                          {7.5F, {1.3F, 0.2F, 2.1F}, {0.1F, -0.3F, 0}},
                          {10, {0, 0, 3.4F}, {0, 0, 0}}};
  add_camera_path(scene, "path", path, 0.7896F);
  finish_scene(scene);
  return scene;
}

}  // namespace traces
