#include <array>
#include <cmath>

#include "traces/scenes/conference/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::conference {
namespace {

constexpr float kHalfTable = 2.75F, kHalfDepth = 0.82F;

/// Makes the side of a slab whose outline is a rounded rectangle with half extents `a` x `b`. `rings`: for each ring of
/// vertices, from bottom to top, its inset from that outline and its height.
Mesh make_slab(std::string name, float a, float b, std::span<const glm::vec2> rings, std::uint32_t round) {
  const auto last = static_cast<std::uint32_t>(rings.size() - 1);
  return make_surface(
      std::move(name), round, last,
      [&](float s, float t) {
        const glm::vec2 ring = rings[static_cast<std::size_t>(t * static_cast<float>(last) + 0.5F)];
        const glm::vec2 p = rounded_rectangle_point(static_cast<double>(s), a - ring.x, b - ring.x);
        return glm::vec3(p.x, ring.y, -p.y);
      },
      true);
}

/// Makes the flat face inside a rounded outline, facing up or down.
Mesh make_face(std::string name, float a, float b, float y, bool up, std::uint32_t round, std::uint32_t rows) {
  Mesh mesh = make_surface(
      std::move(name), round, rows,
      [=](float s, float t) {
        const glm::vec2 p = rounded_rectangle_point(static_cast<double>(s), a, b) * (up ? 1 - t : t);
        return glm::vec3(p.x, y, -p.y);
      },
      true);
  for (glm::vec3& n : mesh.normals) n = {0, up ? 1 : -1, 0};
  return mesh;
}

Mesh make_castor(const Detail& detail) {
  const std::uint32_t round = detail.cell_count(10, 4);
  const glm::vec2 wheel[] = {{0.004F, 0},      {0.022F, 0.001F}, {0.027F, 0.006F},
                             {0.027F, 0.016F}, {0.022F, 0.021F}, {0.004F, 0.022F}};
  Mesh mesh;
  for (const float z : {-0.025F, 0.003F}) {
    append_mesh(mesh, transform_mesh(make_lathe("", detail.coarser_profile(wheel), round),
                                     rotation_about({0, 0.028F, z}, {1, 0, 0}, 0.25)));
  }
  const glm::vec3 fork[] = {{0, 0.028F, 0}, {0, 0.055F, 0}, {-0.01F, 0.085F, 0}};
  append_mesh(mesh, make_tube("", fork, std::array{0.009F}, round));
  return mesh;
}

/// Makes the hard parts of an office chair that faces +z: five-star base, castors, gas lift, armrests, shell of the
/// back.
Mesh make_chair_frame(const Detail& detail) {
  const std::uint32_t round = detail.cell_count(10, 4);
  Mesh mesh;
  mesh.name = "chair frame";
  for (int k = 0; k < 5; ++k) {
    const glm::mat4 turn = placement_at(glm::vec3(0), 0.2 * k + 0.05);
    const glm::vec3 arm[] = {{0.02F, 0.135F, 0}, {0.14F, 0.125F, 0}, {0.28F, 0.095F, 0}, {0.31F, 0.085F, 0}};
    const float radii[] = {0.026F, 0.022F, 0.016F, 0.014F};
    append_mesh(mesh, transform_mesh(make_tube("", arm, radii, round), turn));
    append_mesh(mesh, transform_mesh(make_castor(detail), turn * placement_at({0.30F, 0, 0}, 0.13 * k)));
  }
  const glm::vec2 lift[] = {{0.05F, 0.11F},  {0.05F, 0.155F}, {0.03F, 0.165F}, {0.03F, 0.29F}, {0.019F, 0.292F},
                            {0.019F, 0.41F}, {0.09F, 0.415F}, {0.09F, 0.43F},  {0, 0.43F}};
  append_mesh(mesh, make_lathe("", detail.coarser_profile(lift), detail.cell_count(16, 6)));
  for (const float side : {-1.0F, 1.0F}) {
    const glm::vec3 bow[] = {{side * 0.2F, 0.425F, 0.02F},  {side * 0.285F, 0.43F, 0.03F},
                             {side * 0.305F, 0.47F, 0.05F}, {side * 0.305F, 0.62F, 0.1F},
                             {side * 0.3F, 0.665F, 0.06F},  {side * 0.3F, 0.665F, -0.14F}};
    append_mesh(mesh, make_tube("", catmull_rom(bow, detail.cell_count(5)), std::array{0.013F}, round));
    append_mesh(mesh, make_cushion("", {side * 0.3F - 0.035F, 0.665F, -0.15F}, {side * 0.3F + 0.035F, 0.695F, 0.13F},
                                   0.0145F, detail.cell_count(2), detail.cell_count(3)));
  }
  const glm::vec3 spine[] = {{0, 0.415F, -0.05F}, {0, 0.42F, -0.24F}, {0, 0.5F, -0.3F}, {0, 0.8F, -0.315F}};
  append_mesh(mesh, make_tube("", catmull_rom(spine, detail.cell_count(5)), std::array{0.022F}, round));
  return mesh;
}

/// Makes the seat and the back of a chair, both slightly concave.
Mesh make_upholstery(const Detail& detail) {
  const std::uint32_t steps = detail.cell_count(4), cells = detail.cell_count(10);
  Mesh mesh =
      warp_mesh(make_cushion("upholstery", {-0.25F, 0.43F, -0.24F}, {0.25F, 0.51F, 0.26F}, 0.038F, steps, cells),
                [](const glm::vec3& p) {
                  const float x = p.x / 0.25F, z = p.z / 0.25F;
                  const float front = std::max(0.0F, z - 0.3F);
                  const float narrow = 1 - 0.06F * z * z;
                  return glm::vec3(p.x * narrow, p.y + 0.022F * x * x * x * x - 0.05F * front * front, p.z);
                });
  append_mesh(mesh, warp_mesh(make_cushion("", {-0.225F, 0.56F, -0.03F}, {0.225F, 1.08F, 0.04F}, 0.034F, steps, cells),
                              [](const glm::vec3& p) {
                                const float x = p.x / 0.225F, y = (p.y - 0.56F) / 0.52F;
                                const float lumbar = 0.035F * (1 - (2 * y - 0.7F) * (2 * y - 0.7F));
                                return glm::vec3(p.x * (1 - 0.15F * y * y), p.y,
                                                 p.z - 0.27F + 0.06F * x * x + lumbar - 0.09F * y);
                              }));
  scale_uvs(mesh, glm::vec2(3.5F));
  return mesh;
}

}  // namespace

void add_table(Scene& scene, const Materials& materials, const Detail& detail) {
  const std::uint32_t round = detail.cell_count(112, 24);
  constexpr float y = kTableHeight;
  const glm::vec2 edge[] = {{0.07F, y - 0.05F}, {0.06F, y - 0.05F},   {0.012F, y - 0.032F}, {0.003F, y - 0.024F},
                            {0, y - 0.014F},    {0.003F, y - 0.006F}, {0.01F, y - 0.001F},  {0.016F, y}};
  Mesh top = make_slab("table edge", kHalfTable, kHalfDepth, edge, round);
  append_mesh(top, make_face("", kHalfTable - 0.016F, kHalfDepth - 0.016F, y, true, round, detail.cell_count(6)));
  append_mesh(top, make_face("", kHalfTable - 0.07F, kHalfDepth - 0.07F, y - 0.05F, false, round, 1));
  top.name = "table top";
  project_uvs(top, 0.55F);
  add_object(scene, std::move(top), materials.table_wood);
  const glm::vec2 drum[] = {{0, 0.03F}, {0, y - 0.05F}}, plinth[] = {{0, 0}, {0, 0.025F}, {0.012F, 0.035F}};
  for (const float x : {-1.55F, 0.0F, 1.55F}) {
    Mesh foot = make_slab("table foot", 0.3F, 0.24F, drum, round / 2);
    project_uvs(foot, 0.8F, true);
    add_object(scene, transform_mesh(std::move(foot), placement_at({x, 0, 0})), materials.table_wood);
    Mesh base = make_slab("table plinth", 0.36F, 0.3F, plinth, round / 2);
    append_mesh(base, make_face("", 0.348F, 0.288F, 0.035F, true, round / 2, 1));
    add_object(scene, transform_mesh(std::move(base), placement_at({x, 0, 0})), materials.dark);
  }
}

void add_chairs(Scene& scene, const Materials& materials, const Detail& detail) {
  const std::uint32_t frame = add_mesh(scene, make_chair_frame(detail), materials.dark);
  const std::uint32_t upholstery = add_mesh(scene, make_upholstery(detail), materials.fabric);
  std::uint64_t number = 0;
  const auto add_chair = [&](float x, float z, double turns) {
    ++number;
    const auto stray = [number](std::uint64_t what, float most) {
      return random_between(-most, most, 71, number, what);
    };
    const glm::mat4 at =
        placement_at({x + stray(0, 0.04F), 0, z + stray(1, 0.05F)}, turns + static_cast<double>(stray(2, 0.035F)));
    add_instance(scene, frame, at);
    add_instance(scene, upholstery, at);
  };
  for (int k = 0; k < 6; ++k) {
    const float x = -2.15F + 0.86F * static_cast<float>(k);
    add_chair(x, -1.06F, 0);
    if (k != 2) add_chair(x, 1.06F, 0.5);
  }
  add_chair(-0.28F, 1.5F, 0.36);  // pushed back from the table
  add_chair(-3.0F, 0, 0.25);
  add_chair(3.0F, 0, 0.75);
}

namespace {

void add_framed_picture(Scene& scene, std::uint32_t frame, std::uint32_t mount, std::uint32_t picture,
                        const glm::mat4& wall, float left, float low, float width, float height) {
  const glm::vec2 moulding[] = {{0, 0}, {0, 0.022F}, {0.012F, 0.032F}, {0.03F, 0.026F}, {0.04F, 0.012F}};
  const glm::mat4 at = wall * placement_at({left, low, 0});
  Mesh rim = make_panel("picture frame", width, height, moulding);
  rim.triangles.resize(rim.triangles.size() - 2);
  add_object(scene, transform_mesh(std::move(rim), at), frame);
  constexpr float kRim = 0.04F, kMount = 0.11F;
  add_object(scene,
             transform_mesh(
                 make_quad("mount", {kRim, kRim, 0.012F}, {width - 2 * kRim, 0, 0}, {0, height - 2 * kRim, 0}, 1), at),
             mount);
  Mesh sheet =
      make_quad("picture", {kMount, kMount, 0.014F}, {width - 2 * kMount, 0, 0}, {0, height - 2 * kMount, 0}, 1);
  for (glm::vec2& uv : sheet.uvs) uv.y = 1 - uv.y;
  add_object(scene, transform_mesh(std::move(sheet), at), picture);
}

Mesh make_laptop_case(const Detail& detail) {
  Mesh mesh = make_rounded_box("laptop", {-0.16F, 0, -0.11F}, {0.16F, 0.016F, 0.11F}, 0.006F, detail.cell_count(2));
  append_mesh(
      mesh, transform_mesh(make_rounded_box("", {-0.16F, 0, 0}, {0.16F, 0.22F, 0.008F}, 0.0038F, detail.cell_count(2)),
                           rotation_about({0, 0.014F, -0.105F}, {1, 0, 0}, -0.055)));
  return mesh;
}

Mesh make_laptop_keys() {
  const glm::vec2 key[] = {{0, 0}, {0.001F, 0.0025F}};
  Mesh mesh;
  mesh.name = "laptop keys";
  for (int row = 0; row < 5; ++row) {
    for (int k = 0; k < 14; ++k) {
      const glm::vec3 at(-0.143F + 0.0205F * static_cast<float>(k), 0.0162F, 0.012F - 0.021F * static_cast<float>(row));
      append_mesh(mesh, transform_mesh(make_panel("", 0.018F, 0.018F, key), floor_axes(at)));
    }
  }
  append_mesh(mesh, transform_mesh(make_panel("", 0.1F, 0.06F, key), floor_axes({-0.05F, 0.0145F, 0.1F})));
  return mesh;
}

Mesh make_laptop_screen() {
  Mesh mesh = make_quad("laptop screen", {-0.15F, 0.012F, 0.0085F}, {0.3F, 0, 0}, {0, 0.198F, 0}, 1);
  for (glm::vec2& uv : mesh.uvs) uv.y = 1 - uv.y;
  return transform_mesh(std::move(mesh), rotation_about({0, 0.014F, -0.105F}, {1, 0, 0}, -0.055));
}

Mesh make_cup(const Detail& detail) {
  const std::uint32_t round = detail.cell_count(22, 8);
  const glm::vec2 saucer[] = {{0, 0}, {0.04F, 0}, {0.075F, 0.012F}, {0.076F, 0.014F}, {0.042F, 0.005F}, {0, 0.004F}};
  const glm::vec2 cup[] = {{0, 0.005F},      {0.022F, 0.006F}, {0.024F, 0.012F}, {0.036F, 0.03F}, {0.041F, 0.066F},
                           {0.039F, 0.066F}, {0.034F, 0.03F},  {0.02F, 0.013F},  {0, 0.012F}};
  Mesh mesh = make_lathe("cup", detail.coarser_profile(saucer), round);
  append_mesh(mesh, make_lathe("", detail.coarser_profile(cup), round));
  const glm::vec3 ear[] = {{0.037F, 0.052F, 0}, {0.058F, 0.055F, 0}, {0.06F, 0.035F, 0}, {0.034F, 0.024F, 0}};
  append_mesh(mesh,
              make_tube("", catmull_rom(ear, detail.cell_count(4, 2)), std::array{0.0035F}, detail.cell_count(6, 4)));
  return mesh;
}

/// Makes a conference telephone: three arms with loudspeakers.
Mesh make_telephone(const Detail& detail) {
  return make_surface(
      "telephone", detail.cell_count(48, 18), 4,
      [](float s, float t) {
        const float arms = 0.5F + 0.5F * cos_turns(3.0 * static_cast<double>(s));
        const float reach = 0.07F + 0.12F * arms * arms;
        const float ring[] = {1, 0.97F, 0.75F, 0.35F, 0}, lift[] = {0.004F, 0.03F, 0.045F, 0.055F, 0.056F};
        const auto k = static_cast<std::size_t>(t * 4 + 0.5F);
        const glm::vec2 round = circle_point(static_cast<double>(s)) * reach * ring[k];
        return glm::vec3(round.x, lift[k], -round.y);
      },
      true);
}

Mesh make_leaves(const Detail& detail, const glm::vec3& centre, std::uint32_t count, float length, std::uint64_t seed) {
  Mesh mesh;
  mesh.name = "leaves";
  for (std::uint32_t k = 0; k < count; ++k) {
    const float turn = 0.382F * static_cast<float>(k) + 0.05F * random_unit(seed, k);
    const float age = (static_cast<float>(k) + 0.5F) / static_cast<float>(count);  // 1: outermost and lowest leaf
    const glm::vec2 round = circle_point(static_cast<double>(turn));
    const glm::vec3 way = glm::normalize(glm::vec3(round.x, 1.8F - 1.5F * age, round.y));
    const float reach = length * random_between(0.75F, 1.1F, seed, k, 1) * (0.65F + 0.35F * age);
    add_leaf(mesh, centre + glm::vec3(0.03F * round.x, 0.02F * (1 - age), 0.03F * round.y), way, reach, 0.13F * length,
             0.25F + 0.45F * age, detail.cell_count(10, 3));
  }
  return mesh;
}

Mesh make_clock_hands() {
  Mesh mesh = make_box("clock hands", {-0.004F, -0.02F, 0.02F}, {0.004F, 0.1F, 0.023F});
  append_mesh(mesh, transform_mesh(make_box("", {-0.005F, -0.02F, 0.016F}, {0.005F, 0.07F, 0.019F}),
                                   rotation_about(glm::vec3(0), {0, 0, 1}, 0.167)));
  return mesh;
}

}  // namespace

void add_wall_things(Scene& scene, const Materials& materials, const Detail& detail) {
  const glm::mat4 back = wall_axes({-kHalfLength, 0, -kHalfWidth}, {0, 0, 1});
  add_framed_picture(scene, materials.brass, materials.paper, materials.hills, back, 0.9F, 1.3F, 1.5F, 0.95F);
  add_framed_picture(scene, materials.dark, materials.paper, materials.shapes, back, 4.1F, 1.25F, 1.05F, 1.05F);
  add_framed_picture(scene, materials.brass, materials.paper, materials.sea, back, 6.85F, 1.3F, 1.5F, 0.95F);
  const glm::mat4 left = wall_axes({-kHalfLength, 0, kHalfWidth}, {1, 0, 0});
  add_framed_picture(scene, materials.dark, materials.paper, materials.sea, left, 2.6F, 1.35F, 0.95F, 0.68F);
  add_framed_picture(scene, materials.dark, materials.paper, materials.hills, left, 3.85F, 1.35F, 0.95F, 0.68F);
  // Screen and whiteboard at the end of the room.
  const glm::mat4 end = wall_axes({kHalfLength, 0, -kHalfWidth}, {-1, 0, 0});
  Mesh projection = make_quad("screen", {1.75F, 1.12F, 0.05F}, {2.5F, 0, 0}, {0, 1.4F, 0}, 1);
  for (glm::vec2& uv : projection.uvs) uv.y = 1 - uv.y;
  add_object(scene, transform_mesh(std::move(projection), end), materials.screen);
  Mesh casing = make_box("screen casing", {1.68F, 2.52F, 0.02F}, {4.32F, 2.62F, 0.12F});
  append_mesh(casing, make_box("", {1.71F, 1.08F, 0.042F}, {4.29F, 2.52F, 0.048F}));
  append_mesh(casing, transform_mesh(make_cylinder("", 0.014F, 2.58F, detail.cell_count(12, 5)),
                                     rotation_about({4.29F, 1.09F, 0.05F}, {0, 0, 1}, 0.25)));
  add_object(scene, transform_mesh(std::move(casing), end), materials.dark);
  const glm::vec2 board[] = {{0, 0}, {0, 0.03F}, {0.02F, 0.03F}, {0.022F, 0.02F}};
  add_object(scene, transform_mesh(make_panel("whiteboard", 1.5F, 1.05F, board), end * placement_at({4.62F, 1.2F, 0})),
             materials.chart);
  Mesh tray = make_box("pen tray", {4.75F, 1.15F, 0}, {5.95F, 1.165F, 0.09F});
  add_object(scene, transform_mesh(std::move(tray), end), materials.steel);
  for (const float x : {4.9F, 5.1F, 5.4F}) {
    const Mesh pen = transform_mesh(make_cylinder("pen", 0.009F, 0.13F, detail.cell_count(10, 5)),
                                    rotation_about({x + 0.13F, 1.175F, 0.05F}, {0, 0, 1}, 0.25));
    add_object(scene, transform_mesh(pen, end), x < 5 ? materials.red : materials.blue);
  }
  // A clock above the door.
  const glm::mat4 clock = wall_axes({-kHalfLength, 2.5F, 2.07F}, {1, 0, 0});
  const glm::vec2 rim[] = {{0.17F, 0}, {0.17F, 0.03F}, {0.155F, 0.035F}, {0.15F, 0.015F}},
                  face[] = {{0.15F, 0.012F}, {0, 0.012F}};
  const glm::mat4 flat = clock * rotation_about(glm::vec3(0), {1, 0, 0}, 0.25);
  add_object(scene,
             transform_mesh(make_lathe("clock rim", detail.coarser_profile(rim), detail.cell_count(32, 12)), flat),
             materials.dark);
  Mesh dial = make_lathe("clock face", detail.coarser_profile(face), detail.cell_count(32, 12));
  add_object(scene, transform_mesh(std::move(dial), flat), materials.white);
  add_object(scene, transform_mesh(make_clock_hands(), clock), materials.dark);
  // A sideboard below the middle picture.
  const glm::vec2 door[] = {{0.004F, 0}, {0.004F, 0.018F}, {0.05F, 0.018F}, {0.055F, 0.012F}};
  Mesh chest = make_box("sideboard", {3.3F, 0.06F, 0}, {5.9F, 0.8F, 0.42F});
  append_mesh(chest, make_rounded_box("", {3.26F, 0.8F, 0}, {5.94F, 0.835F, 0.46F}, 0.01F, detail.cell_count(2)));
  Mesh knobs;
  knobs.name = "knobs";
  for (int k = 0; k < 4; ++k) {
    const float x = 3.32F + 0.64F * static_cast<float>(k);
    append_mesh(chest, transform_mesh(make_panel("", 0.64F, 0.7F, door), placement_at({x, 0.08F, 0.42F})));
    append_mesh(knobs,
                make_sphere("", {x + (k % 2 == 0 ? 0.58F : 0.06F), 0.5F, 0.45F}, 0.016F, detail.cell_count(4, 2)));
  }
  chest = transform_mesh(std::move(chest), back);
  project_uvs(chest, 0.8F);
  add_object(scene, std::move(chest), materials.wood);
  add_object(scene, transform_mesh(std::move(knobs), back), materials.brass);
  const glm::vec2 flask[] = {{0, 0},          {0.06F, 0},     {0.065F, 0.01F}, {0.065F, 0.19F},
                             {0.05F, 0.235F}, {0.03F, 0.25F}, {0.03F, 0.275F}, {0, 0.28F}};
  const std::uint32_t can =
      add_mesh(scene, make_lathe("flask", detail.coarser_profile(flask), detail.cell_count(28, 10)), materials.steel);
  for (const float x : {4.1F, 4.28F}) add_instance(scene, can, back * placement_at({x, 0.835F, 0.22F}));
}

void add_table_things(Scene& scene, const Materials& materials, const Detail& detail) {
  constexpr float y = kTableHeight;
  const std::uint32_t parts[] = {add_mesh(scene, make_laptop_case(detail), materials.keys),
                                 add_mesh(scene, make_laptop_keys(), materials.dark),
                                 add_mesh(scene, make_laptop_screen(), materials.glow)};
  const glm::mat4 laptops[] = {placement_at({-1.3F, y, 0.5F}, 0.02), placement_at({1.28F, y, -0.5F}, 0.52),
                               placement_at({0.42F, y, 0.5F}, -0.03)};
  for (const glm::mat4& at : laptops) {
    for (const std::uint32_t part : parts) add_instance(scene, part, at);
  }
  const std::uint32_t cup = add_mesh(scene, make_cup(detail), materials.china);
  const glm::vec3 cups[] = {
      {-1.75F, y, 0.42F}, {-0.55F, y, -0.45F}, {0.78F, y, 0.42F}, {1.7F, y, -0.42F}, {2.2F, y, 0.3F}};
  for (const glm::vec3& at : cups)
    add_instance(scene, cup,
                 placement_at(at, static_cast<double>(random_unit(9, static_cast<std::uint64_t>(at.x * 8 + 40)))));
  const std::uint32_t pad =
      add_mesh(scene, make_box("note pad", {-0.105F, 0, -0.148F}, {0.105F, 0.008F, 0.148F}), materials.paper);
  const std::uint32_t pen =
      add_mesh(scene, make_cone("pen", 0.005F, 0.003F, 0.14F, detail.cell_count(10, 5)), materials.blue);
  for (int k = 0; k < 6; ++k) {
    const float x = -2.15F + 0.86F * static_cast<float>(k), side = k % 2 == 0 ? -1.0F : 1.0F;
    const glm::mat4 at =
        placement_at({x + 0.06F, y, side * 0.56F},
                     static_cast<double>(0.04F * (random_unit(12, static_cast<std::uint64_t>(k)) - 0.5F)));
    add_instance(scene, pad, at);
    add_instance(scene, pen, at * rotation_about({0.03F, 0.0135F, 0.06F}, {-0.6F, 0, -0.8F}, 0.25));
  }
  add_object(scene, transform_mesh(make_telephone(detail), placement_at({-0.35F, y, 0.02F}, 0.1)), materials.dark);
  const glm::vec2 bowl[] = {{0, 0},          {0.06F, 0},      {0.065F, 0.01F}, {0.1F, 0.05F},
                            {0.115F, 0.11F}, {0.11F, 0.115F}, {0.098F, 0.1F},  {0, 0.1F}};
  add_object(scene,
             transform_mesh(make_lathe("flower bowl", catmull_rom(detail.coarser_profile(bowl), detail.cell_count(3)),
                                       detail.cell_count(32, 10)),
                            placement_at({0.62F, y, -0.02F})),
             materials.china);
  Mesh leaves = make_leaves(detail, {0.62F, y + 0.08F, -0.02F}, detail.cell_count(30, 10), 0.26F, 5);
  Mesh blossoms;
  blossoms.name = "blossoms";
  for (std::uint64_t k = 0; k < 7; ++k) {
    const glm::vec2 round =
        circle_point(static_cast<double>(0.382F * static_cast<float>(k))) * (0.03F + 0.012F * static_cast<float>(k));
    const glm::vec3 centre(0.62F + round.x, y + 0.27F + 0.05F * random_unit(31, k), -0.02F + round.y);
    const glm::vec3 stalk[] = {{0.62F, y + 0.08F, -0.02F}, centre - glm::vec3(0, 0.08F, 0), centre};
    append_mesh(leaves, make_tube("", stalk, std::array{0.002F}, 4));
    for (int petal = 0; petal < 6; ++petal) {
      const glm::vec2 way = circle_point(petal / 6.0);
      add_leaf(blossoms, centre, glm::normalize(glm::vec3(way.x, 0.7F, way.y)), 0.045F, 0.02F, 0.3F,
               detail.cell_count(4, 2));
    }
  }
  add_object(scene, std::move(leaves), materials.leaf);
  add_object(scene, std::move(blossoms), materials.red);
}

void add_plant(Scene& scene, const Materials& materials, const Detail& detail) {
  const glm::vec3 corners[] = {{4.05F, 0, -2.65F}, {-4.1F, 0, -2.7F}};
  const glm::vec2 pot[] = {{0, 0},          {0.15F, 0},      {0.155F, 0.01F},  {0.2F, 0.3F},   {0.22F, 0.3F},
                           {0.225F, 0.31F}, {0.225F, 0.36F}, {0.215F, 0.365F}, {0.19F, 0.36F}, {0.185F, 0.32F}};
  const glm::vec2 ground[] = {{0.187F, 0.325F}, {0.1F, 0.34F}, {0, 0.345F}};
  const std::uint32_t round = detail.cell_count(36, 12);
  const std::uint32_t pot_mesh =
      add_mesh(scene, make_lathe("flower pot", detail.coarser_profile(pot), round), materials.terracotta);
  const std::uint32_t soil_mesh =
      add_mesh(scene, make_lathe("soil", detail.coarser_profile(ground), round), materials.soil);
  std::uint32_t seed = 40;
  for (const glm::vec3& at : corners) {
    add_instance(scene, pot_mesh, placement_at(at));
    add_instance(scene, soil_mesh, placement_at(at));
    Mesh foliage, canes;
    foliage.name = "foliage";
    canes.name = "canes";
    for (int cane = 0; cane < 3; ++cane) {
      const glm::vec2 round_at = 0.07F * circle_point(cane / 3.0);
      const float tall = 0.65F + 0.42F * static_cast<float>(cane);
      const glm::vec3 top = at + glm::vec3(1.4F * round_at.x, tall, 1.4F * round_at.y);
      const glm::vec3 path[] = {at + glm::vec3(round_at.x, 0.3F, round_at.y),
                                0.5F * (at + top) + glm::vec3(0, 0.15F, 0.01F), top};
      append_mesh(canes, make_tube("", path, std::array{0.018F, 0.016F, 0.013F}, detail.cell_count(8, 4)));
      append_mesh(foliage, make_leaves(detail, top, detail.cell_count(56, 14), 0.5F, ++seed));
    }
    add_object(scene, std::move(canes), materials.soil);
    add_object(scene, std::move(foliage), materials.leaf);
  }
}

}  // namespace traces::conference
