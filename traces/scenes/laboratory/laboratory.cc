#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "traces/scene/cameras.h"
#include "traces/scene/scene.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/laboratory/glassware.h"
#include "traces/scenes/modelling/detail.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::laboratory {
namespace {

/// Indices of the laboratory's materials in Scene::materials.
struct Looks {
  std::uint32_t steel, iron, brass, wood, porcelain, plastic, cork, rubber;
  std::uint32_t tiles, floor, plaster, bench, lacquer, shelf, chart, rail, daylight, lamp;
  std::uint32_t page, label, stopper, flame, inner_flame, glass;
  std::uint32_t blue, green, orange, violet, pink, yellow, red, water;  ///< materials of liquids
  std::array<std::uint32_t, 4> bottles;
};

/// Returns a texture of the periodic table: 18 columns, seven rows and two below, coloured by kind of element.
Texture chart_texture() {
  constexpr glm::vec3 kColours[] = {{0.86F, 0.36F, 0.30F}, {0.93F, 0.66F, 0.28F}, {0.95F, 0.85F, 0.45F},
                                    {0.55F, 0.76F, 0.48F}, {0.42F, 0.68F, 0.80F}, {0.60F, 0.52F, 0.78F}};
  return paint_texture("chart of the elements", 1024, 512, [&](float u, float v) {
    const glm::vec4 paper(0.95F, 0.94F, 0.90F, 1), ink(0.13F, 0.13F, 0.16F, 1);
    if (v > 0.045F && v < 0.095F && std::abs(u - 0.5F) < 0.22F) {  // title, as bars instead of letters
      const auto letter = static_cast<std::uint64_t>(u * 70);
      const float in = u * 70 - static_cast<float>(letter);
      return random_unit(letter, 51) < 0.85F && in < 0.72F ? ink : paper;
    }
    const float x = (u - 0.05F) / 0.05F, y = (v - 0.14F) / 0.09F;
    if (x < 0 || y < 0 || x >= 18 || y >= 9.3F) return paper;
    const auto column = static_cast<int>(x);
    const bool is_apart = y >= 7.3F;
    const auto row = is_apart ? static_cast<int>(y - 0.3F) : static_cast<int>(y);
    if (!is_apart && y >= 7) return paper;
    const float in_x = x - static_cast<float>(column), in_y = (is_apart ? y - 0.3F : y) - static_cast<float>(row);
    const bool is_there = is_apart   ? column >= 2 && column < 17
                          : row == 0 ? column == 0 || column == 17
                          : row < 3  ? column < 2 || column > 11
                                     : true;
    if (!is_there || in_x < 0.06F || in_y < 0.06F || in_x > 0.94F || in_y > 0.94F) return paper;
    const auto id = static_cast<std::uint64_t>(row * 18 + column);
    if (in_x > 0.24F && in_x < 0.76F && in_y > 0.30F && in_y < 0.66F) {  // symbol of an element
      const auto i = static_cast<std::uint64_t>(in_x * 9), j = static_cast<std::uint64_t>(in_y * 11);
      if (random_unit(id, i, j) < 0.6F) return ink;
    }
    const int kind = is_apart ? 5 : column == 0 ? 0 : column == 1 ? 1 : column < 12 ? 2 : column < 16 ? 3 : 4;
    return glm::vec4(kColours[kind], 1);
  });
}

/// Returns a texture of a lined page with handwritten notes.
Texture page_texture() {
  return paint_texture("page", 512, 512, [](float u, float v) {
    const float y = v * 24;
    const auto line = static_cast<std::uint64_t>(y);
    const auto letter = static_cast<std::uint64_t>(u * 90);
    const float in = y - static_cast<float>(line);
    const glm::vec4 paper(0.95F, 0.95F, 0.92F, 1);
    if (in > 0.93F) return glm::vec4(0.65F, 0.75F, 0.88F, 1);
    if (u < 0.1F || u > 0.93F || line < 2 || line > 21 || u > 0.35F + 0.6F * random_unit(line, 71)) return paper;
    const bool is_ink = random_unit(letter / 5 * 7, line, 72) < 0.8F &&
                        random_unit(letter, line, static_cast<std::uint64_t>(in * 6)) < 0.5F;
    return is_ink && in > 0.3F ? glm::vec4(0.12F, 0.15F, 0.42F, 1) : paper;
  });
}

/// Returns a texture of a bottle's label with a red edge.
Texture label_texture() {
  return paint_texture("label", 128, 128, [](float u, float v) {
    const bool is_edge = u < 0.05F || u > 0.95F || v < 0.06F || v > 0.94F;
    const bool is_writing =
        v > 0.22F && v < 0.8F && u > 0.12F && u < 0.88F && v * 6 - std::floor(v * 6) < 0.5F &&
        random_unit(static_cast<std::uint64_t>(u * 24), static_cast<std::uint64_t>(v * 6), 81) < 0.7F;
    return is_edge      ? glm::vec4(0.65F, 0.15F, 0.12F, 1)
           : is_writing ? glm::vec4(0.15F, 0.15F, 0.2F, 1)
                        : glm::vec4(0.94F, 0.92F, 0.85F, 1);
  });
}

/// Returns clear glass. It transmits slightly less and emits a little, in place of paths that limited depth cuts off.
Material clear_glass() {
  Material m = make_glass("glass", {0.93F, 0.97F, 0.98F});
  m.transmission = 0.92F;
  m.emission = {0.045F, 0.054F, 0.057F};
  return m;
}

/// Returns a coloured liquid. It emits the light that it would scatter: shadow rays do not reach it through glass.
Material make_liquid(std::string name, const glm::vec3& colour) {
  Material m = make_glass(std::move(name), colour, 1.33F);
  m.transmission = 0.5F;
  m.emission = 0.42F * colour;
  return m;
}

Material make_flame(std::string name, const glm::vec3& emission) {
  Material m = make_glass(std::move(name), {0.10F, 0.22F, 0.75F}, 1.0F);
  m.transmission = 0.75F;
  m.emission = emission;
  return m;
}

/// Adds all textures and materials of the laboratory.
Looks add_laboratory_materials(Scene& scene) {
  const auto add = [&scene](Material material) { return add_material(scene, std::move(material)); };
  return {
      .steel = add(make_metal("steel", {0.80F, 0.81F, 0.83F}, 0.6F)),
      .iron = add(make_paint("cast iron", {0.10F, 0.14F, 0.17F}, 0.08F)),
      .brass = add(make_metal("brass", {0.92F, 0.70F, 0.36F}, 0.55F)),
      .wood =
          add_textured(scene, wood_texture("rack wood", {0.76F, 0.55F, 0.34F}, {0.56F, 0.36F, 0.20F}, 61, 256), 0.05F),
      .porcelain = add(make_paint("porcelain", {0.88F, 0.87F, 0.84F}, 0.10F)),
      .plastic = add(make_paint("white plastic", {0.80F, 0.82F, 0.84F}, 0.08F)),
      .cork = add(make_paint("cork", {0.55F, 0.37F, 0.21F})),
      .rubber = add(make_paint("red rubber", {0.52F, 0.13F, 0.08F}, 0.03F)),
      .tiles = add_textured(
          scene, tile_texture("wall tiles", {0.84F, 0.89F, 0.88F}, {0.80F, 0.86F, 0.86F}, {0.55F, 0.58F, 0.58F}, 8, 53),
          0.07F),
      .floor = add_textured(
          scene, tile_texture("floor", {0.62F, 0.58F, 0.52F}, {0.50F, 0.47F, 0.43F}, {0.33F, 0.31F, 0.29F}, 8, 55, 256),
          0),
      .plaster = add(make_paint("plaster", {0.80F, 0.80F, 0.76F})),
      .bench = add_textured(scene, stone_texture("bench top", {0.30F, 0.32F, 0.34F}, {0.19F, 0.20F, 0.22F}, 54), 0.14F),
      .lacquer = add(make_paint("lacquered wood", {0.74F, 0.76F, 0.74F}, 0.05F)),
      .shelf = add_textured(scene, wood_texture("beech", {0.80F, 0.62F, 0.42F}, {0.62F, 0.44F, 0.27F}, 52, 256), 0.04F),
      .chart = add_textured(scene, chart_texture(), 0),
      .rail = add(make_paint("black wood", {0.05F, 0.045F, 0.04F}, 0.05F)),
      .daylight = add(make_lamp("daylight", {9, 9.4F, 10})),
      .lamp = add(make_lamp("ceiling lamp", {12, 11.2F, 10})),
      .page = add_textured(scene, page_texture(), 0),
      .label = add_textured(scene, label_texture(), 0),
      .stopper = add(make_paint("black stopper", {0.03F, 0.03F, 0.035F}, 0.08F)),
      .flame = add(make_flame("flame", {0.07F, 0.16F, 0.50F})),
      .inner_flame = add(make_flame("inner flame", {0.35F, 0.65F, 0.95F})),
      .glass = add(clear_glass()),
      .blue = add(make_liquid("copper sulphate", {0.05F, 0.28F, 0.85F})),
      .green = add(make_liquid("nickel chloride", {0.08F, 0.62F, 0.22F})),
      .orange = add(make_liquid("dichromate", {0.95F, 0.38F, 0.04F})),
      .violet = add(make_liquid("permanganate", {0.42F, 0.06F, 0.55F})),
      .pink = add(make_liquid("phenolphthalein", {0.92F, 0.22F, 0.48F})),
      .yellow = add(make_liquid("chromate", {0.95F, 0.78F, 0.08F})),
      .red = add(make_liquid("iron thiocyanate", {0.70F, 0.04F, 0.05F})),
      .water = add(make_liquid("water", {0.62F, 0.74F, 0.78F})),
      .bottles = {add(make_paint("amber bottle", {0.20F, 0.09F, 0.03F}, 0.16F)),
                  add(make_paint("blue bottle", {0.06F, 0.13F, 0.25F}, 0.16F)),
                  add(make_paint("green bottle", {0.10F, 0.22F, 0.12F}, 0.16F)),
                  add(make_paint("white bottle", {0.55F, 0.56F, 0.52F}, 0.16F))},
  };
}

constexpr float kShelf = 0.375F, kUpperShelf = 0.60F;  ///< heights of the shelves
constexpr float kShelfFrom = 0.02F, kShelfTo = 0.98F;  ///< ends of the shelves in x
constexpr float kShelfDepth = -0.43F;                  ///< z of the middle of a shelf

constexpr float kFloor = -0.9F, kCeiling = 1.6F, kLeft = -1.35F, kRight = 1.45F, kBack = -0.52F, kFront = 1.9F;

void add_cupboards(Scene& scene, const Looks& looks, const Detail& detail) {
  const std::uint32_t white = looks.lacquer, steel = looks.steel;
  const std::uint32_t steps = detail.cell_count(2);
  const std::uint32_t door =
      add_mesh(scene, make_rounded_box("door", {-0.205F, -0.78F, 0}, {0.205F, -0.23F, 0.025F}, 0.008F, steps), white);
  const std::uint32_t drawer = add_mesh(
      scene, make_rounded_box("drawer", {-0.205F, -0.215F, 0}, {0.205F, -0.055F, 0.025F}, 0.008F, steps), white);
  const std::uint32_t handle = add_mesh(
      scene, make_rounded_box("handle", {-0.06F, -0.14F, 0.03F}, {0.06F, -0.125F, 0.05F}, 0.006F, steps), steel);
  for (int k = 0; k < 6; ++k) {
    const glm::mat4 at = placement_at({kLeft + 0.225F + 0.42F * static_cast<float>(k), 0, 0.27F});
    for (const std::uint32_t mesh : {door, drawer, handle}) add_instance(scene, mesh, at);
  }
  add_object(scene, make_box("cupboards", {kLeft, -0.8F, kBack}, {1.2F, -0.045F, 0.27F}), white);
}

void add_shelves(Scene& scene, std::uint32_t board, const Detail& detail) {
  const std::uint32_t steps = detail.cell_count(3);
  for (const float height : {kShelf, kUpperShelf}) {
    add_object(
        scene,
        make_rounded_box("shelf", {kShelfFrom, height - 0.022F, kBack}, {kShelfTo, height, -0.34F}, 0.005F, steps),
        board);
  }
  for (const float x : {kShelfFrom - 0.02F, kShelfTo}) {
    add_object(scene,
               make_rounded_box("shelf side", {x, kShelf - 0.05F, kBack}, {x + 0.02F, kUpperShelf + 0.2F, -0.335F},
                                0.005F, steps),
               board);
  }
}

/// Adds the room: bench (its top at y = 0), tiled wall with chart and shelves, cupboards, window on the left, lamp.
void add_room(Scene& scene, const Looks& looks, const Detail& detail) {
  const glm::vec3 x(kRight - kLeft, 0, 0), y(0, kCeiling - kFloor, 0), z(0, 0, kFront - kBack);
  const glm::vec3 low(kLeft, kFloor, kBack), high(kRight, kCeiling, kFront);
  Mesh back = make_quad("back wall", low, x, y, detail.cell_count(12, 2));
  scale_uvs(back, {2.24F, 2});
  add_object(scene, std::move(back), looks.tiles);
  add_object(scene, make_quad("floor", low, z, x, 2, 1.6F), looks.floor);
  add_object(scene, make_quad("left wall", low, y, z, 2), looks.plaster);
  add_object(scene, make_quad("right wall", high, -y, -z, 2), looks.plaster);
  add_object(scene, make_quad("front wall", high, -x, -y, 2), looks.plaster);
  add_object(scene, make_quad("ceiling", high, -z, -x, 2), looks.plaster);

  Mesh top = make_rounded_box("bench top", {kLeft, -0.04F, kBack}, {1.22F, 0, 0.32F}, 0.008F, detail.cell_count(3));
  for (std::size_t k = 0; k < top.uvs.size(); ++k)
    top.uvs[k] = {1.1F * top.positions[k].x, 1.1F * (top.positions[k].z + top.positions[k].y)};
  add_object(scene, std::move(top), looks.bench);
  add_cupboards(scene, looks, detail);
  add_shelves(scene, looks.shelf, detail);
  add_object(scene, make_quad("chart", {-0.80F, 0.21F, kBack + 0.004F}, {0.72F, 0, 0}, {0, 0.40F, 0}, 1), looks.chart);
  for (glm::vec2& uv : scene.meshes.back().uvs) uv.y = 1 - uv.y;
  add_object(scene, make_box("chart rail", {-0.81F, 0.61F, kBack}, {-0.07F, 0.622F, kBack + 0.012F}), looks.rail);

  // The panes of the window, in front of their frame, light the room. A lamp at the ceiling adds a little light.
  Mesh panes;
  for (int column = 0; column < 2; ++column) {
    for (int row = 0; row < 2; ++row) {
      const glm::vec3 corner(kLeft + 0.03F, 0.35F + 0.52F * static_cast<float>(row),
                             0.15F + 0.52F * static_cast<float>(column));
      append_mesh(panes, make_quad("", corner, {0, 0.48F, 0}, {0, 0, 0.48F}, 1));
    }
  }
  panes.name = "window";
  add_object(scene, std::move(panes), looks.daylight);
  add_object(scene, make_box("window frame", {kLeft, 0.30F, 0.10F}, {kLeft + 0.02F, 1.40F, 1.20F}), looks.plaster);
  add_object(scene, make_quad("ceiling lamp", {-0.1F, kCeiling - 0.01F, 0.5F}, {0.9F, 0, 0}, {0, 0, 0.3F}, 1),
             looks.lamp);
}

void add_placed(Scene& scene, Mesh mesh, std::uint32_t material, const glm::mat4& at) {
  add_instance(scene, add_mesh(scene, std::move(mesh), material), at);
}

Mesh make_thin_rod(const glm::vec3& from, const glm::vec3& to, float radius, const Detail& detail) {
  const std::array path{from, to};
  const std::array radii{radius};
  return make_tube("rod", path, radii, detail.cell_count(12, 5));
}

/// Adds a laboratory stand: foot, rod, and a clamp at height `clamp` that holds a vessel at distance `reach` from the
/// rod (along +x, rotated about y).
void add_stand(Scene& scene, const Looks& looks, const glm::vec3& position, double turns, float clamp, float reach,
               const Detail& detail) {
  const glm::mat4 at = placement_at(position, turns);
  add_placed(scene,
             make_rounded_box("foot", {-0.05F, 0, -0.075F}, {0.16F, 0.016F, 0.075F}, 0.005F, detail.cell_count(3)),
             looks.iron, at);
  Mesh steel = make_thin_rod({0, 0.015F, 0}, {0, 0.56F, 0}, 0.006F, detail);
  append_mesh(steel, make_thin_rod({0.01F, clamp, 0}, {reach - 0.035F, clamp, 0}, 0.004F, detail));
  steel.name = "rod";
  add_placed(scene, std::move(steel), looks.steel, at);
  Mesh holder = make_rounded_box("clamp", {-0.014F, clamp - 0.014F, -0.014F}, {0.016F, clamp + 0.014F, 0.014F}, 0.003F,
                                 detail.cell_count(2));
  append_mesh(holder, make_thin_rod({-0.014F, clamp, 0}, {-0.035F, clamp, 0}, 0.005F, detail));
  // Two fingers of the clamp around the neck.
  for (const float side : {-1.0F, 1.0F}) {
    std::vector<glm::vec3> finger;
    for (int k = 0; k <= 8; ++k) {
      const glm::vec2 way = circle_point(0.46 - 0.42 * k / 8);
      finger.emplace_back(reach + 0.0205F * way.x - 0.004F * (k == 0 ? 1.0F : 0.0F), clamp, side * 0.0205F * way.y);
    }
    const std::array radii{0.0035F};
    append_mesh(holder, make_tube("", finger, radii, detail.cell_count(8, 4)));
  }
  append_mesh(holder, make_rounded_box("", {reach - 0.04F, clamp - 0.009F, -0.009F},
                                       {reach - 0.019F, clamp + 0.009F, 0.009F}, 0.003F, detail.cell_count(2)));
  add_placed(scene, std::move(holder), looks.iron, at);
}

/// Adds a gas burner with its flame, below a tripod with a wire gauze at height 0.2.
void add_burner(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail) {
  const glm::mat4 at = placement_at(position);
  const std::uint32_t sides = detail.cell_count(28, 8);
  Outline foot({0, 0});
  foot.line_to(0.040F, 0)
      .arc_to(0.036F, 0.012F, 0.003F)
      .arc_to(0.012F, 0.022F, -0.002F)
      .line_to(0.010F, 0.026F)
      .line_to(0, 0.026F);
  add_placed(scene, make_lathe("burner foot", simplify_line(foot.points(), detail.cell_count(12, 7)), sides),
             looks.iron, at);
  Outline pipe({0.008F, 0.026F});
  pipe.line_to(0.012F, 0.028F)
      .line_to(0.012F, 0.045F)
      .line_to(0.008F, 0.047F)
      .line_to(0.008F, 0.115F)
      .line_to(0.010F, 0.117F);
  pipe.line_to(0.010F, 0.128F).line_to(0.0075F, 0.128F).line_to(0.0075F, 0.110F);
  Mesh barrel = make_lathe("burner", pipe.points(), sides);
  append_mesh(barrel, make_thin_rod({0.010F, 0.018F, 0}, {0.060F, 0.018F, 0}, 0.005F, detail));
  add_placed(scene, std::move(barrel), looks.brass, at);
  // The hose to the gas tap in the wall.
  const std::vector<glm::vec3> course{{0.055F, 0.018F, 0},     {0.085F, 0.016F, 0.005F}, {0.12F, 0.008F, -0.03F},
                                      {0.10F, 0.008F, -0.12F}, {0.03F, 0.008F, -0.20F},  {0.0F, 0.03F, -0.29F},
                                      {0.0F, 0.085F, -0.335F}};
  const std::array hose{0.0065F};
  add_placed(scene,
             make_tube("hose", catmull_rom(std::span<const glm::vec3>(course), detail.cell_count(7, 3)), hose,
                       detail.cell_count(12, 5)),
             looks.rubber, at);
  Mesh tap = make_thin_rod({0, 0.08F, -0.335F}, {0, 0.13F, -0.335F}, 0.007F, detail);
  append_mesh(tap, make_thin_rod({0, 0.12F, -0.40F}, {0, 0.12F, -0.32F}, 0.010F, detail));
  append_mesh(
      tap, make_rounded_box("", {-0.022F, 0.133F, -0.341F}, {0.022F, 0.141F, -0.329F}, 0.003F, detail.cell_count(2)));
  tap.name = "gas tap";
  add_placed(scene, std::move(tap), looks.brass, at);

  Outline outer({0.0065F, 0.126F});
  outer.arc_to(0.0115F, 0.148F, 0.001F).arc_to(0, 0.196F, 0.004F);
  Outline inner({0.0055F, 0.126F});
  inner.arc_to(0, 0.158F, 0.002F);
  add_placed(scene, make_lathe("flame", simplify_line(outer.points(), detail.cell_count(12, 5)), sides), looks.flame,
             at);
  add_placed(scene, make_lathe("inner flame", simplify_line(inner.points(), detail.cell_count(7, 4)), sides),
             looks.inner_flame, at);

  constexpr float kTop = 0.198F;
  Mesh tripod = transform_mesh(make_torus("", 0.06F, 0.004F, sides, detail.cell_count(8, 4)),
                               placement_at({0, kTop - 0.004F, 0}));
  for (int leg = 0; leg < 3; ++leg) {
    const glm::vec2 way = circle_point(leg / 3.0 + 0.08);
    append_mesh(tripod, make_thin_rod({0.095F * way.x, 0, 0.095F * way.y},
                                      {0.06F * way.x, kTop - 0.004F, 0.06F * way.y}, 0.004F, detail));
  }
  tripod.name = "tripod";
  add_placed(scene, std::move(tripod), looks.iron, at);
  // The gauze is woven: two layers of wire.
  Mesh gauze;
  const std::uint32_t wires = detail.cell_count(16, 6);
  for (std::uint32_t k = 0; k <= wires; ++k) {
    const float across = 0.128F * (static_cast<float>(k) / static_cast<float>(wires) - 0.5F);
    const std::array thin{0.0011F};
    const std::array one{glm::vec3(across, kTop + 0.0015F, -0.064F), glm::vec3(across, kTop + 0.0015F, 0.064F)};
    const std::array other{glm::vec3(-0.064F, kTop + 0.003F, across), glm::vec3(0.064F, kTop + 0.003F, across)};
    append_mesh(gauze, make_tube("", one, thin, 4));
    append_mesh(gauze, make_tube("", other, thin, 4));
  }
  gauze.name = "gauze";
  add_placed(scene, std::move(gauze), looks.steel, at);
}

/// Adds a wooden rack for six test tubes, 0.04 apart along x, whose bottoms are 0.02 above the bench.
void add_rack(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail) {
  const glm::mat4 at = placement_at(position);
  const std::uint32_t steps = detail.cell_count(2);
  Mesh rack = make_rounded_box("", {-0.135F, 0, -0.03F}, {0.135F, 0.018F, 0.03F}, 0.003F, steps);
  for (const float x : {-0.135F, 0.123F}) {
    append_mesh(rack, make_rounded_box("", {x, 0.018F, -0.028F}, {x + 0.012F, 0.115F, 0.028F}, 0.003F, steps));
  }
  // A shelf with holes is a strip on each side of the tubes, and bridges between them.
  for (const float y : {0.055F, 0.105F}) {
    for (const float z : {-0.026F, 0.0125F})
      append_mesh(rack, make_box("", {-0.123F, y, z}, {0.123F, y + 0.009F, z + 0.0135F}, 1, 4));
    for (int k = 0; k < 7; ++k) {
      const float x = -0.120F + 0.040F * static_cast<float>(k);
      append_mesh(rack, make_box("", {x - 0.008F, y, -0.0125F}, {x + 0.008F, y + 0.009F, 0.0125F}, 1, 4));
    }
  }
  rack.name = "rack";
  for (std::size_t k = 0; k < rack.uvs.size(); ++k)
    rack.uvs[k] = {2 * rack.positions[k].x, 3 * (rack.positions[k].y + rack.positions[k].z)};
  add_placed(scene, std::move(rack), looks.wood, at);
}

/// Adds a magnetic stirrer, with its plate at height 0.055.
void add_stirrer(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail) {
  const glm::mat4 at = placement_at(position);
  add_placed(
      scene,
      make_rounded_box("stirrer", {-0.075F, 0.004F, -0.08F}, {0.075F, 0.046F, 0.095F}, 0.008F, detail.cell_count(3)),
      looks.plastic, at);
  const Outline plate =
      Outline({0, 0.046F}).line_to(0.062F, 0.046F).line_to(0.062F, 0.052F).line_to(0.059F, 0.055F).line_to(0, 0.055F);
  add_placed(scene, make_lathe("plate", plate.points(), detail.cell_count(36, 10)), looks.steel, at);
  const Outline knob = Outline({0, 0}).line_to(0.014F, 0).line_to(0.012F, 0.012F).line_to(0, 0.013F);
  for (const float x : {-0.035F, 0.035F}) {
    const glm::mat4 front(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0),
                          glm::vec4(x, 0.026F, 0.095F, 1));
    add_placed(scene, make_lathe("knob", knob.points(), detail.cell_count(18, 6)), looks.iron, at * front);
  }
}

void add_mortar(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail) {
  Outline bowl({0, 0});
  bowl.line_to(0.026F, 0)
      .arc_to(0.022F, 0.010F, -0.001F)
      .arc_to(0.050F, 0.056F, 0.009F)
      .line_to(0.048F, 0.060F)
      .line_to(0.044F, 0.058F);
  bowl.arc_to(0, 0.016F, -0.017F);
  add_placed(scene,
             make_lathe("mortar", simplify_line(bowl.points(), detail.cell_count(20, 9)), detail.cell_count(36, 10)),
             looks.porcelain, placement_at(position));
  const std::vector<glm::vec3> path{
      {0.008F, 0.026F, 0}, {0.0F, 0.034F, 0}, {-0.014F, 0.048F, 0}, {-0.05F, 0.085F, 0.005F}, {-0.075F, 0.11F, 0.008F}};
  const std::array radii{0.0F, 0.012F, 0.010F, 0.007F, 0.008F};
  add_placed(scene, make_tube("pestle", path, radii, detail.cell_count(16, 6)), looks.porcelain,
             placement_at(position));
}

void add_notebook(Scene& scene, const Looks& looks, const glm::vec3& position, double turns, const Detail& detail) {
  const glm::mat4 at = placement_at(position, turns);
  add_placed(scene,
             make_rounded_box("cover", {-0.155F, 0, -0.105F}, {0.155F, 0.006F, 0.105F}, 0.002F, detail.cell_count(2)),
             looks.iron, at);
  for (const float side : {-1.0F, 1.0F}) {
    // A page that rises towards the fold.
    add_placed(scene,
               make_surface("page", detail.cell_count(10, 3), 2,
                            [side](float s, float t) {
                              const float out = side > 0 ? s : 1 - s;
                              return glm::vec3(side * (0.001F + 0.148F * out),
                                               0.007F + 0.012F * (1 - out) * (1 - out) * (0.3F + 2 * out),
                                               0.1F - 0.2F * t);
                            }),
               looks.page, at);
    for (glm::vec2& uv : scene.meshes.back().uvs) uv.y = 1 - uv.y;
  }
  const std::vector<glm::vec3> pen{{0.02F, 0.022F, 0.06F},
                                   {0.03F, 0.0215F, 0.05F},
                                   {0.035F, 0.0215F, 0.045F},
                                   {0.12F, 0.0185F, -0.035F},
                                   {0.125F, 0.018F, -0.04F}};
  const std::array radii{0.0005F, 0.003F, 0.0042F, 0.0042F, 0.003F};
  add_placed(scene, make_tube("pen", pen, radii, detail.cell_count(12, 5)), looks.rubber, at);
}

}  // namespace
}  // namespace traces::laboratory

namespace traces {
namespace {

using laboratory::Looks;
using laboratory::Vessel;

constexpr float kSeconds = 8;

/// Places vessels with their fillings; equal vessels share a mesh.
class Glassware {
 public:
  Glassware(Scene& scene, std::uint32_t glass, const Detail& detail) : scene_(scene), glass_(glass), detail_(detail) {}

  void place_vessel(Vessel vessel, const glm::vec3& at, float height, std::uint32_t filling, double turns = 0) {
    std::uint32_t& mesh = meshes_[static_cast<std::size_t>(vessel)];
    if (mesh == kNone) mesh = add_mesh(scene_, laboratory::make_vessel(vessel, detail_), glass_);
    add_instance(scene_, mesh, placement_at(at, turns));
    if (height > 0)
      add_instance(scene_, add_mesh(scene_, laboratory::make_filling(vessel, height, detail_), filling),
                   placement_at(at));
  }

  void add_placed(Mesh mesh, const glm::vec3& at) {
    add_instance(scene_, add_mesh(scene_, std::move(mesh), glass_), placement_at(at));
  }

 private:
  Scene& scene_;
  std::uint32_t glass_;
  Detail detail_;
  std::array<std::uint32_t, 9> meshes_{kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
};

/// Adds two rows of bottles with labels and stoppers.
void add_bottles(Scene& scene, const Looks& looks, const Detail& detail) {
  std::array<std::uint32_t, 4> bottles{};
  for (std::size_t k = 0; k < bottles.size(); ++k) {
    bottles[k] = add_mesh(scene, laboratory::make_filling(Vessel::kBottle, 0.125F, Detail{0.8 * detail.share}),
                          looks.bottles[k]);
  }
  const std::uint32_t label =
      add_mesh(scene,
               make_surface("label", detail.cell_count(10, 4), 1,
                            [](float s, float t) {
                              const glm::vec2 way = circle_point(0.25 - 0.17 + 0.34 * static_cast<double>(1 - s));
                              return glm::vec3(0.0335F * way.x, 0.03F + 0.04F * t, 0.0335F * way.y);
                            }),
               looks.label);
  for (glm::vec2& uv : scene.meshes.back().uvs) uv.y = 1 - uv.y;
  Outline stopper({0, 0.118F});
  stopper.line_to(0.013F, 0.118F)
      .line_to(0.014F, 0.128F)
      .line_to(0.019F, 0.131F)
      .arc_to(0.016F, 0.146F, 0.003F)
      .line_to(0, 0.148F);
  const std::uint32_t top = add_mesh(
      scene, make_lathe("stopper", simplify_line(stopper.points(), detail.cell_count(9, 6)), detail.cell_count(20, 7)),
      looks.stopper);
  for (const float height : {laboratory::kShelf, laboratory::kUpperShelf}) {
    const bool is_upper = height > laboratory::kShelf;
    const std::uint64_t row = is_upper ? 1 : 0;
    for (std::uint64_t k = 0; k < 10; ++k) {
      if (random_unit(k, row, 82) < 0.12F) continue;
      const float x = laboratory::kShelfFrom + 0.055F + 0.094F * static_cast<float>(k) +
                      random_between(-0.006F, 0.006F, k, row, 83);
      const glm::vec3 at(x, height, laboratory::kShelfDepth + random_between(-0.015F, 0.02F, k, row, 84));
      const glm::mat4 to_world = placement_at(at, static_cast<double>(random_between(-0.06F, 0.06F, k, row, 85)),
                                              glm::vec3(random_between(0.92F, 1.1F, k, row, 86)));
      add_instance(scene, bottles[static_cast<std::size_t>(4 * random_unit(k, row, 87))], to_world);
      add_instance(scene, label, to_world);
      add_instance(scene, top, to_world);
    }
  }
}

/// Adds the burette's tap, its falling drops, and the stirring bar in the flask.
void add_titration(Scene& scene, const Looks& looks, const glm::vec3& flask, float tip, std::uint32_t drop_stuff,
                   const Detail& detail) {
  Mesh tap = make_cylinder("burette tap", 0.008F, 0.03F, detail.cell_count(16, 6));
  for (glm::vec3& p : tap.positions) p = {p.y - 0.015F, -p.x, p.z};
  for (glm::vec3& n : tap.normals) n = {n.y, -n.x, n.z};
  append_mesh(tap,
              make_rounded_box("", {0.015F, -0.014F, -0.003F}, {0.021F, 0.014F, 0.003F}, 0.002F, detail.cell_count(2)));
  add_instance(scene, add_mesh(scene, std::move(tap), looks.plastic), placement_at({flask.x, tip + 0.038F, flask.z}));

  const Outline drop = Outline({0, -0.003F}).add_arc({0, 0}, 0.003F, -0.25, 0.12).line_to(0, 0.0065F);
  const std::uint32_t drop_mesh = add_mesh(
      scene, make_lathe("drop", simplify_line(drop.points(), detail.cell_count(10, 5)), detail.cell_count(14, 6)),
      drop_stuff);
  const std::uint32_t node = add_node(scene, "drop", {.translation = {flask.x, tip, flask.z}});
  attach_to_node(scene, add_instance(scene, drop_mesh), node);
  std::vector<Key> keys;
  constexpr float kPeriod = 2, kFall = 0.3F;
  for (float start = 0; start < kSeconds; start += kPeriod) {
    for (int k = 0; k <= 6; ++k) {
      const float t = static_cast<float>(k) / 6;
      keys.push_back({start + kPeriod - 0.4F + kFall * t, {flask.x, tip - (tip - flask.y - 0.03F) * t * t, flask.z}});
    }
    keys.push_back({start + kPeriod - 0.09F, {flask.x, tip + 0.02F, flask.z}});  // the next drop forms in the tip
    keys.push_back({start + kPeriod, {flask.x, tip, flask.z}});
  }
  add_translation_track(scene, node, keys);

  const std::array path{glm::vec3(-0.014F, 0, 0), glm::vec3(-0.012F, 0, 0), glm::vec3(0.012F, 0, 0),
                        glm::vec3(0.014F, 0, 0)};
  const std::array radii{0.001F, 0.003F, 0.003F, 0.001F};
  const std::uint32_t bar =
      add_mesh(scene, make_tube("stirring bar", path, radii, detail.cell_count(12, 5)), looks.porcelain);
  const std::uint32_t spin = add_node(scene, "stirring bar", {.translation = flask + glm::vec3(0, 0.009F, 0)});
  attach_to_node(scene, add_instance(scene, bar), spin);
  std::vector<TurnKey> turns;
  for (int k = 0; k <= 96; ++k)
    turns.push_back({kSeconds * static_cast<float>(k) / 96, axis_rotation({0, 1, 0}, 0.25 * k)});
  add_rotation_track(scene, spin, turns);
}

void add_apparatus(Scene& scene, const Looks& looks, const Detail& detail) {
  laboratory::add_room(scene, looks, detail);
  Glassware ware(scene, looks.glass, detail);

  // On the left: a flask over the burner.
  const glm::vec3 burner(-0.50F, 0, -0.13F);
  laboratory::add_burner(scene, looks, burner, detail);
  laboratory::add_stand(scene, looks, burner + glm::vec3(-0.17F, 0, -0.06F), -0.054, 0.338F, 0.18F, detail);
  ware.place_vessel(Vessel::kRound, burner + glm::vec3(0, 0.204F, 0), 0.055F, looks.orange);

  const glm::vec3 rack(-0.20F, 0, 0.07F);
  laboratory::add_rack(scene, looks, rack, detail);
  const std::uint32_t tubes[] = {looks.red, looks.orange, looks.yellow, looks.green, looks.blue, looks.violet};
  for (int k = 0; k < 6; ++k) {
    const float height = 0.05F + 0.05F * random_unit(static_cast<std::uint64_t>(k), 91);
    ware.place_vessel(Vessel::kTestTube, rack + glm::vec3(-0.10F + 0.04F * static_cast<float>(k), 0.0185F, 0), height,
                      tubes[k]);
  }

  // In the middle: a titration.
  const glm::vec3 stirrer(0.17F, 0, -0.08F), flask = stirrer + glm::vec3(0, 0.0555F, 0);
  constexpr float kTip = 0.215F;
  laboratory::add_stirrer(scene, looks, stirrer, detail);
  laboratory::add_stand(scene, looks, stirrer + glm::vec3(-0.05F, 0, -0.17F), -0.205, 0.46F, 0.177F, detail);
  ware.place_vessel(Vessel::kErlenmeyer, flask, 0.045F, looks.pink);
  ware.place_vessel(Vessel::kBurette, {flask.x, kTip, flask.z}, 0.31F, looks.water);
  add_titration(scene, looks, flask, kTip, looks.water, detail);

  // The rest of the bench.
  ware.place_vessel(Vessel::kBeaker, {0.03F, 0, 0.13F}, 0.062F, looks.blue, 0.4);
  ware.place_vessel(Vessel::kBeaker, {-0.03F, 0, -0.20F}, 0.045F, looks.yellow, 0.1);
  ware.place_vessel(Vessel::kErlenmeyer, {0.375F, 0, 0.05F}, 0.065F, looks.green);
  ware.place_vessel(Vessel::kErlenmeyer, {0.63F, 0, -0.16F}, 0.05F, looks.yellow);
  ware.place_vessel(Vessel::kVolumetric, {0.50F, 0, -0.06F}, 0.10F, looks.violet);
  ware.place_vessel(Vessel::kCylinder, {0.34F, 0.008F, -0.20F}, 0.13F, looks.red);
  ware.place_vessel(Vessel::kCylinder, {0.44F, 0.008F, -0.26F}, 0.16F, looks.blue);
  const Outline foot =
      Outline({0, 0}).line_to(0.032F, 0).line_to(0.032F, 0.004F).line_to(0.018F, 0.0065F).line_to(0, 0.0065F);
  ware.add_placed(make_lathe("cylinder foot", foot.points(), detail.cell_count(30, 8)), {0.34F, 0, -0.20F});
  ware.add_placed(make_lathe("cylinder foot", foot.points(), detail.cell_count(30, 8)), {0.44F, 0, -0.26F});
  const glm::vec3 ring(0.62F, 0, 0.09F);
  add_instance(
      scene,
      add_mesh(scene, make_torus("cork ring", 0.034F, 0.011F, detail.cell_count(30, 8), detail.cell_count(12, 5)),
               looks.cork),
      placement_at(ring + glm::vec3(0, 0.011F, 0)));
  ware.place_vessel(Vessel::kRound, ring + glm::vec3(0, 0.0105F, 0), 0.060F, looks.red);
  ware.place_vessel(Vessel::kDish, {0.20F, 0, 0.17F}, 0.007F, looks.green);
  ware.place_vessel(Vessel::kDish, {0.25F, 0, 0.08F}, 0, looks.green);
  ware.place_vessel(Vessel::kBeaker, {-0.36F, 0, -0.27F}, 0.07F, looks.water, 0.2);
  ware.place_vessel(Vessel::kErlenmeyer, {-0.72F, 0, 0.06F}, 0.055F, looks.blue);
  laboratory::add_mortar(scene, looks, {-0.44F, 0, 0.16F}, detail);
  laboratory::add_notebook(scene, looks, {0.44F, 0, 0.20F}, -0.04, detail);
  add_bottles(scene, looks, detail);
}

}  // namespace

/// Builds a chemist's bench with nested glass, where most rays are refracted.
Scene build_laboratory(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 98'000;
  const Detail detail = fit_detail(options.triangles_or_default(kClass), [](const Detail& at) {
    Scene shapes;
    add_apparatus(shapes, {}, at);
    return count_triangles(shapes);
  });
  Scene scene;
  scene.name = "laboratory";
  scene.background = glm::vec3(0.3F);
  add_apparatus(scene, laboratory::add_laboratory_materials(scene), detail);
  scene.cameras.push_back(look_at("front", {0.10F, 0.38F, 1.08F}, {0.035F, 0.195F, -0.12F}, 0.60F));
  scene.cameras.push_back(look_at("burner", {-0.30F, 0.30F, 0.52F}, {-0.46F, 0.19F, -0.13F}, 0.65F));
  const ViewKey path[] = {{0, {-0.75F, 0.30F, 0.62F}, {-0.42F, 0.17F, -0.12F}},
                          {2, {-0.40F, 0.28F, 0.58F}, {-0.20F, 0.14F, -0.05F}},
                          {4, {0.05F, 0.30F, 0.55F}, {0.12F, 0.15F, -0.08F}},
                          {6, {0.50F, 0.32F, 0.58F}, {0.40F, 0.13F, -0.05F}},
                          {8, {0.85F, 0.45F, 0.85F}, {0.25F, 0.17F, -0.12F}}};
  add_camera_path(scene, "path", path, 0.7F);
  finish_scene(scene);
  return scene;
}

}  // namespace traces
