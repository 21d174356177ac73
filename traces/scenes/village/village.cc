#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"
#include "traces/scenes/village/houses.h"
#include "traces/scenes/village/landscape.h"
#include "traces/scenes/village/things.h"

namespace traces {
namespace {

using namespace village;

constexpr std::uint32_t kTriangles = 600'000;
constexpr float kFov = 0.62F;

void add_building_instances(Scene& scene, const Building& building, const glm::mat4& at) {
  for (const std::uint32_t mesh : building) add_instance(scene, mesh, at);
}

struct Palette {
  std::uint32_t white_wall, ochre_wall, brick, rubble, red_tiles, slate, dark_wood, pale_wood, green, blue, red, glass,
      stone, white, gold, cloth, water, hay, iron;
};

Texture plaster_texture(const char* name, const glm::vec3& colour, std::uint32_t seed) {
  return paint_texture(name, 512, 512, [&](float u, float v) {
    const float stain = fractal_noise(u, v, 4, 4, seed), grain = value_noise(u, v, 200, seed + 9);
    return glm::vec4(colour * (0.82F + 0.2F * stain + 0.08F * grain), 1);
  });
}

Palette make_palette(Scene& s) {
  Palette p;
  p.white_wall = add_textured(s, plaster_texture("white plaster", {0.93F, 0.91F, 0.86F}, 1));
  p.ochre_wall = add_textured(s, plaster_texture("ochre plaster", {0.93F, 0.80F, 0.58F}, 2));
  p.brick = add_textured(s, brick_texture("brick", {0.72F, 0.40F, 0.30F}, {0.66F, 0.54F, 0.47F}, 4, 12, 3));
  p.rubble = add_textured(s, brick_texture("rubble", {0.72F, 0.68F, 0.60F}, {0.55F, 0.52F, 0.47F}, 3, 6, 4));
  p.red_tiles = add_textured(s, brick_texture("red tiles", {0.82F, 0.43F, 0.30F}, {0.58F, 0.30F, 0.22F}, 4, 4, 5));
  p.slate = add_textured(s, brick_texture("slate", {0.47F, 0.50F, 0.55F}, {0.33F, 0.35F, 0.39F}, 4, 5, 6));
  p.dark_wood = add_textured(s, wood_texture("dark wood", {0.42F, 0.31F, 0.23F}, {0.25F, 0.17F, 0.12F}, 7, 256));
  p.pale_wood = add_textured(s, wood_texture("pale wood", {0.72F, 0.60F, 0.45F}, {0.50F, 0.38F, 0.27F}, 8, 256));
  p.stone = add_textured(s, stone_texture("stone", {0.80F, 0.77F, 0.70F}, {0.52F, 0.50F, 0.46F}, 9));
  p.cloth = add_textured(s, cloth_texture("sailcloth", {0.95F, 0.92F, 0.84F}, {0.86F, 0.82F, 0.72F}, 64, 10, 256));
  p.hay = add_textured(s, crop_texture("hay", {0.88F, 0.78F, 0.45F}, {0.66F, 0.52F, 0.26F}, 60, 12));
  p.green = add_material(s, make_paint("green paint", {0.08F, 0.23F, 0.12F}));
  p.blue = add_material(s, make_paint("blue paint", {0.12F, 0.24F, 0.42F}));
  p.red = add_material(s, make_paint("red paint", {0.42F, 0.07F, 0.05F}));
  p.white = add_material(s, make_paint("white paint", {0.85F, 0.84F, 0.80F}));
  p.glass = add_material(s, make_paint("window glass", {0.035F, 0.05F, 0.065F}, 0.3F));
  p.gold = add_material(s, make_metal("gold", {0.95F, 0.72F, 0.30F}, 0.55F));
  p.water = add_material(s, make_paint("water", {0.10F, 0.22F, 0.27F}, 0.45F));
  p.iron = add_material(s, make_paint("iron", {0.08F, 0.08F, 0.09F}, 0.1F));
  return p;
}

void add_landscape(Scene& s, float detail) {
  const auto cells = [detail](float n) { return std::max(static_cast<std::uint32_t>(n * detail), 16U); };
  const std::uint32_t round = cells(280);
  const std::uint32_t grass = add_textured(s, grass_texture("grass"));
  const std::uint32_t country = add_textured(s, countryside_texture("countryside", 1024));
  const std::uint32_t haze = add_textured(s, haze_texture("far hills", 512));
  const std::uint32_t cobbles = add_textured(s, cobble_texture("cobbles", 12));
  for (const std::uint32_t m : {country, haze})
    s.textures[s.materials[m].base_texture.texture].wrap_u = Texture::Wrap::kClamp;
  add_object(s, make_land("meadow", 0, 145, round, cells(62), 24), grass);
  Mesh middle = make_land("countryside", 145, 400, round, cells(24), 800);
  for (glm::vec2& uv : middle.uvs) uv += 0.5F;
  add_object(s, std::move(middle), country);
  Mesh far = make_land("far hills", 400, 1000, round, cells(18), 2000);
  for (glm::vec2& uv : far.uvs) uv += 0.5F;
  add_object(s, std::move(far), haze);
  add_object(s, make_street("street", 5.2F, 1.3F / detail, 4), cobbles);
  add_object(s, make_square("square", 10.5F, cells(64), 4), cobbles);

  const std::uint32_t wheat =
      add_textured(s, crop_texture("wheat", {0.86F, 0.74F, 0.38F}, {0.62F, 0.49F, 0.25F}, 24, 21));
  const std::uint32_t soil =
      add_textured(s, crop_texture("ploughed", {0.50F, 0.37F, 0.27F}, {0.33F, 0.24F, 0.17F}, 10, 23));
  const std::uint32_t cabbage =
      add_textured(s, crop_texture("cabbage", {0.38F, 0.58F, 0.27F}, {0.40F, 0.31F, 0.22F}, 12, 25));
  const float cell = 2 / detail;
  add_object(s, make_field("wheat field", {58, 30}, {42, 50}, 0.03, 0.12F, cell, 12), wheat);
  add_object(s, make_field("ploughed field", {-66, 42}, {38, 56}, -0.02, 0.12F, cell, 12), soil);
  add_object(s, make_field("cabbage field", {56, -36}, {44, 46}, -0.04, 0.12F, cell, 9), cabbage);
  add_object(s, make_field("second wheat field", {-62, -18}, {36, 40}, 0.05, 0.12F, cell, 12), wheat);
}

struct HouseKind {
  const char* name;
  HouseShape shape;
  HouseMaterials paints;
};

std::vector<HouseKind> house_kinds(const Palette& c) {
  return {
      {"cottage",
       {.width = 6.4F, .length = 8.6F, .eaves = 2.9F, .ridge = 6.1F},
       {c.white_wall, c.red_tiles, c.white, c.green, c.glass, c.green, c.stone}},
      {"timbered house",
       {.width = 7,
        .length = 8.8F,
        .eaves = 5.2F,
        .ridge = 9.3F,
        .storeys = 2,
        .timbered = true,
        .shutters = false,
        .chimney = -0.28F},
       {c.white_wall, c.red_tiles, c.dark_wood, c.red, c.glass, c.red, c.stone}},
      {"brick house",
       {.width = 7,
        .length = 9.6F,
        .eaves = 5.1F,
        .ridge = 8.4F,
        .storeys = 2,
        .shutters = false,
        .dormers = 2,
        .chimney = 0.34F},
       {c.brick, c.slate, c.white, c.blue, c.glass, c.blue, c.stone}},
      {"stone barn",
       {.width = 8, .length = 11, .eaves = 3.9F, .ridge = 8.2F, .shutters = false, .barn = true},
       {c.rubble, c.red_tiles, c.dark_wood, c.iron, c.glass, c.pale_wood, c.stone}},
      {"ochre house",
       {.width = 6.8F, .length = 8, .eaves = 5.3F, .ridge = 8.6F, .storeys = 2, .chimney = 0.2F},
       {c.ochre_wall, c.slate, c.white, c.blue, c.glass, c.pale_wood, c.stone}},
      {"inn",
       {.width = 8.4F,
        .length = 13.5F,
        .eaves = 5.6F,
        .ridge = 10.2F,
        .storeys = 2,
        .timbered = true,
        .dormers = 3,
        .chimney = 0.36F},
       {c.ochre_wall, c.red_tiles, c.dark_wood, c.green, c.glass, c.green, c.stone}},
  };
}

/// Adds houses along both sides of the street and around the square. Each kind is shown several times.
void add_houses(Scene& s, const Palette& c, float detail) {
  std::vector<Building> buildings;
  for (const HouseKind& k : house_kinds(c)) buildings.push_back(add_house(s, k.name, k.shape, k.paints, detail));
  struct Plot {
    std::uint32_t kind;
    float z, aside;  ///< z of the house, and its distance to the right (east) of the street
  };
  constexpr Plot kPlots[] = {{0, 71, -10.5F}, {2, 57, -10},      {1, 43, -9.8F},    {4, 29, -10},   {0, 15.5F, -11},
                             {4, 73, 11},     {1, 57, 10},       {0, 43.5F, 10.4F}, {2, 30, 10.2F}, {4, 16, 10.6F},
                             {5, -5, -16.5F}, {1, -6.5F, 16.8F}, {4, -24, -10.2F},  {0, -37, -11},  {2, -27, 11},
                             {3, 36, -28},    {3, 2, 31}};
  for (const Plot& plot : kPlots) {
    const float x = street_x(plot.z) + plot.aside;
    const double along = static_cast<double>(street_x(plot.z + 4) - street_x(plot.z - 4)) / 8 / 6.2832;
    add_building_instances(s, buildings[plot.kind],
                           placement_at(point_on_ground(x, plot.z), along + (plot.aside > 0 ? 0.5 : 0.0)));
  }
  const HouseMaterials holy{c.white_wall, c.slate, c.dark_wood, c.iron, c.glass, c.dark_wood, c.stone};
  add_building_instances(s, add_church(s, holy, c.white, c.gold, detail),
                         placement_at(point_on_ground(kChurch.x, kChurch.y, -0.1F), 0.015));
}

void add_walls_and_fences(Scene& s, const Palette& c, float detail) {
  const std::uint32_t wall = add_mesh(s, make_stone_wall(4, detail, 3), c.rubble);
  const std::uint32_t fence = add_mesh(s, make_fence(4), c.pale_wood);
  const auto row = [&](std::uint32_t mesh, glm::vec2 from, glm::vec2 to) {
    const auto count = static_cast<int>(glm::distance(from, to) / 4 + 0.5F);
    const glm::vec2 step = (to - from) / static_cast<float>(count);
    for (int k = 0; k < count; ++k) {
      const glm::vec2 a = from + step * static_cast<float>(k), b = a + step;
      const glm::vec3 foot = point_on_ground(a.x, a.y), way = point_on_ground(b.x, b.y) - foot;
      const glm::vec3 side = glm::normalize(glm::cross(way, glm::vec3(0, 1, 0)));
      add_instance(
          s, mesh,
          {glm::vec4(way / 4.0F, 0), glm::vec4(0, 1, 0, 0), glm::vec4(side, 0), glm::vec4(foot + 0.5F * way, 1)});
    }
  };
  const auto beside = [](float z, float aside) { return glm::vec2(street_x(z) + aside, z); };
  for (const float aside : {-3.8F, 3.8F}) {
    row(wall, beside(92, aside), beside(80, aside));
    row(wall, beside(24, aside * 1.6F), beside(20, aside * 1.6F));
  }
  row(wall, kChurch + glm::vec2(-17, 21), kChurch + glm::vec2(-3, 22));
  row(wall, kChurch + glm::vec2(3, 22), kChurch + glm::vec2(17, 21));
  row(wall, kChurch + glm::vec2(17, 21), kChurch + glm::vec2(17, -7));
  row(wall, kChurch + glm::vec2(-17, 21), kChurch + glm::vec2(-17, -7));
  row(fence, {35, 58}, {35, 6});
  row(fence, {35, 58}, {78, 56});
  row(fence, {-46, 72}, {-46, 16});
  row(fence, {32, -14}, {32, -56});
  row(fence, beside(78, 7.5F), {34, 80});
}

void add_square(Scene& s, const Palette& c, float detail) {
  add_building_instances(s, add_fountain(s, c.stone, c.water, detail),
                         placement_at(point_on_ground(kSquare.x, kSquare.y, 0.12F)));
  add_building_instances(s, add_cart(s, c.pale_wood, c.hay, c.iron),
                         placement_at(point_on_ground(street_x(22) + 4.3F, 22), 0.21));
  const std::uint32_t wheel = add_mesh(s, make_wheel(), c.dark_wood);
  for (const float side : {-kWheelSide, kWheelSide}) {
    add_instance(s, wheel,
                 placement_at(point_on_ground(street_x(22) + 4.3F, 22), 0.21) * placement_at({0, kWheelRadius, side}));
  }
}

void add_windmill(Scene& s, const Palette& c, float detail) {
  const HouseMaterials paints{c.white_wall, c.slate, c.dark_wood, c.red, c.glass, c.red, c.stone};
  const glm::mat4 at = placement_at(point_on_ground(kMill.x, kMill.y), 0.13);
  add_building_instances(s, add_mill(s, paints, c.dark_wood, detail), at);
  constexpr float kQuarter = 23.3F / 15;  // seconds per quarter turn: the sails turn for the whole flight
  const std::uint32_t base = add_node(
      s, "mill", {.translation = glm::vec3(at * glm::vec4(kHub, 1)), .rotation = axis_rotation({0, 1, 0}, 0.13)});
  const std::uint32_t axle = add_node(s, "sails", {}, base);
  std::vector<TurnKey> keys;
  for (int k = 0; k <= 15; ++k)
    keys.push_back({kQuarter * static_cast<float>(k), axis_rotation({0, 0, 1}, -k / 4.0 + 0.07)});
  for (std::size_t k = 1; k < keys.size(); ++k) {
    if (glm::dot(keys[k].value, keys[k - 1].value) < 0) keys[k].value = -keys[k].value;
  }
  add_rotation_track(s, axle, keys);
  s.nodes[axle].rest.rotation = keys[0].value;
  const glm::vec2 round = circle_point(0.07);
  const glm::mat4 turned(glm::vec4(round.x, round.y, 0, 0), glm::vec4(-round.y, round.x, 0, 0), glm::vec4(0, 0, 1, 0),
                         glm::vec4(0, 0, 0, 1));
  for (const std::uint32_t mesh : add_sails(s, c.dark_wood, c.cloth)) {
    attach_to_node(s, add_instance(s, mesh, at * placement_at(kHub) * turned), axle);
  }
}

void add_cameras(Scene& s) {
  s.cameras.push_back(look_at("overview", {6, 19, 112}, {-13, 4, -10}, kFov));
  const auto along = [](float z, float above) { return point_on_ground(street_x(z), z, above); };
  s.cameras.push_back(look_at("street", along(62, 2), along(30, 3.2F), kFov));
  s.cameras.push_back(look_at("square", {7, 2.4F, 7}, {-6, 4.6F, -22}, kFov));
  const ViewKey keys[] = {{0, {6, 19, 112}, {-13, 4, -10}},
                          {2.4F, {-3, 9, 100}, {-1, 3, 50}},
                          {5, along(72, 2.6F), along(46, 3)},
                          {7.4F, along(44, 2.4F), along(20, 2.8F)},
                          {9.6F, along(18, 2.5F), {0, 2.5F, -10}},
                          {11.3F, {4.6F, 2.6F, 1}, {6.5F, 3.6F, -12}},
                          {13.3F, {2.6F, 4.6F, -12.5F}, {-3, 7.5F, -34}},
                          {15.4F, {3, 15, -26}, {-12, 5, -36}},
                          {17.6F, {20, 18, -20}, {-6, 4, -14}},
                          {20, {18, 15, 18}, {-6, 5, -22}},
                          {21.8F, {3, 13, -4}, {-8, 11, -46}},
                          {23.3F, {-3, 9.5F, -26}, {-8, 11.5F, -53}}};
  add_camera_path(s, "path", keys, kFov);
}

}  // namespace

Scene build_village(const BuiltinOptions& options) {
  const std::uint32_t triangles = options.triangles_or_default(kTriangles);
  const float detail = std::sqrt(static_cast<float>(triangles) / static_cast<float>(kTriangles));
  Scene scene;
  scene.name = "village";
  scene.background = {0.55F, 0.72F, 0.93F};
  const Palette palette = make_palette(scene);
  add_landscape(scene, detail);
  add_houses(scene, palette, detail);
  add_walls_and_fences(scene, palette, detail);
  add_square(scene, palette, detail);
  add_windmill(scene, palette, detail);
  add_cameras(scene);
  add_garden(scene, triangles, detail);
  Light sun;
  sun.kind = Light::Kind::kDirectional;
  sun.direction = glm::normalize(glm::vec3(0.62F, -0.66F, -0.42F));
  sun.intensity = {1, 0.92F, 0.78F};
  scene.lights.push_back(sun);
  finish_scene(scene, {0.20F, 0.24F, 0.30F});
  return scene;
}

}  // namespace traces
