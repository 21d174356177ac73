#include <array>
#include <cmath>

#include "traces/scenes/conference/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::conference {
namespace {

constexpr float kHalfTable = 2.75F, kHalfDepth = 0.82F;

/// Makes a slab with a rounded outline from `rings` (inset, height), outside in, bottom to top.
Mesh make_slab(std::string name, float a, float b, std::span<const glm::vec2> rings, std::uint32_t round) {
  const auto last = static_cast<std::uint32_t>(rings.size() - 1);
  return make_surface(
      std::move(name), round, last,
      [&](float s, float t) {
        const glm::vec2 ring = rings[static_cast<std::size_t>(t * static_cast<float>(last) + 0.5F)];
        const glm::vec2 p = on_rounded_rectangle(static_cast<double>(s), a - ring.x, b - ring.x);
        return glm::vec3(p.x, ring.y, -p.y);
      },
      true);
}

/// Makes the flat face inside that outline, facing up or down.
Mesh make_face(std::string name, float a, float b, float y, bool up, std::uint32_t round, std::uint32_t rows) {
  Mesh mesh = make_surface(
      std::move(name), round, rows,
      [=](float s, float t) {
        const glm::vec2 p = on_rounded_rectangle(static_cast<double>(s), a, b) * (up ? 1 - t : t);
        return glm::vec3(p.x, y, -p.y);
      },
      true);
  for (glm::vec3& n : mesh.normals) n = {0, up ? 1 : -1, 0};
  return mesh;
}

Mesh make_castor(const Detail& detail) {
  const std::uint32_t round = detail.cells(10, 4);
  const glm::vec2 wheel[] = {{0.004F, 0},      {0.022F, 0.001F}, {0.027F, 0.006F},
                             {0.027F, 0.016F}, {0.022F, 0.021F}, {0.004F, 0.022F}};
  Mesh mesh;
  for (const float z : {-0.025F, 0.003F}) {
    append(mesh, transformed(make_lathe("", detail.profile(wheel), round), turned({0, 0.028F, z}, {1, 0, 0}, 0.25)));
  }
  const glm::vec3 fork[] = {{0, 0.028F, 0}, {0, 0.055F, 0}, {-0.01F, 0.085F, 0}};
  append(mesh, make_tube("", fork, std::array{0.009F}, round));
  return mesh;
}

/// Makes the hard parts of a chair: five-star base, castors, gas lift, armrests, the shell of the back. The chair faces
/// +z.
Mesh make_chair_frame(const Detail& detail) {
  const std::uint32_t round = detail.cells(10, 4);
  Mesh mesh;
  mesh.name = "chair frame";
  for (int k = 0; k < 5; ++k) {
    const glm::mat4 turn = placed(glm::vec3(0), 0.2 * k + 0.05);
    const glm::vec3 arm[] = {{0.02F, 0.135F, 0}, {0.14F, 0.125F, 0}, {0.28F, 0.095F, 0}, {0.31F, 0.085F, 0}};
    const float radii[] = {0.026F, 0.022F, 0.016F, 0.014F};
    append(mesh, transformed(make_tube("", arm, radii, round), turn));
    append(mesh, transformed(make_castor(detail), turn * placed({0.30F, 0, 0}, 0.13 * k)));
  }
  const glm::vec2 lift[] = {{0.05F, 0.11F},  {0.05F, 0.155F}, {0.03F, 0.165F}, {0.03F, 0.29F}, {0.019F, 0.292F},
                            {0.019F, 0.41F}, {0.09F, 0.415F}, {0.09F, 0.43F},  {0, 0.43F}};
  append(mesh, make_lathe("", detail.profile(lift), detail.cells(16, 6)));
  for (const float side : {-1.0F, 1.0F}) {
    const glm::vec3 bow[] = {{side * 0.2F, 0.425F, 0.02F},  {side * 0.285F, 0.43F, 0.03F},
                             {side * 0.305F, 0.47F, 0.05F}, {side * 0.305F, 0.62F, 0.1F},
                             {side * 0.3F, 0.665F, 0.06F},  {side * 0.3F, 0.665F, -0.14F}};
    append(mesh, make_tube("", smoothed(bow, detail.cells(5)), std::array{0.013F}, round));
    append(mesh, make_cushion("", {side * 0.3F - 0.035F, 0.665F, -0.15F}, {side * 0.3F + 0.035F, 0.695F, 0.13F},
                              0.0145F, detail.cells(2), detail.cells(3)));
  }
  const glm::vec3 spine[] = {{0, 0.415F, -0.05F}, {0, 0.42F, -0.24F}, {0, 0.5F, -0.3F}, {0, 0.8F, -0.315F}};
  append(mesh, make_tube("", smoothed(spine, detail.cells(5)), std::array{0.022F}, round));
  return mesh;
}

/// Makes seat and back, both slightly concave.
Mesh make_upholstery(const Detail& detail) {
  const std::uint32_t steps = detail.cells(4), cells = detail.cells(10);
  Mesh mesh = warped(make_cushion("upholstery", {-0.25F, 0.43F, -0.24F}, {0.25F, 0.51F, 0.26F}, 0.038F, steps, cells),
                     [](const glm::vec3& p) {
                       const float x = p.x / 0.25F, z = p.z / 0.25F;
                       const float front = std::max(0.0F, z - 0.3F);
                       const float narrow = 1 - 0.06F * z * z;
                       return glm::vec3(p.x * narrow, p.y + 0.022F * x * x * x * x - 0.05F * front * front, p.z);
                     });
  append(mesh, warped(make_cushion("", {-0.225F, 0.56F, -0.03F}, {0.225F, 1.08F, 0.04F}, 0.034F, steps, cells),
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

void add_table(Scene& scene, const Materials& is, const Detail& detail) {
  const std::uint32_t round = detail.cells(112, 24);
  constexpr float y = kTableHeight;
  const glm::vec2 edge[] = {{0.07F, y - 0.05F}, {0.06F, y - 0.05F},   {0.012F, y - 0.032F}, {0.003F, y - 0.024F},
                            {0, y - 0.014F},    {0.003F, y - 0.006F}, {0.01F, y - 0.001F},  {0.016F, y}};
  Mesh top = make_slab("table edge", kHalfTable, kHalfDepth, edge, round);
  append(top, make_face("", kHalfTable - 0.016F, kHalfDepth - 0.016F, y, true, round, detail.cells(6)));
  append(top, make_face("", kHalfTable - 0.07F, kHalfDepth - 0.07F, y - 0.05F, false, round, 1));
  top.name = "table top";
  project_uvs(top, 0.55F);
  add_object(scene, std::move(top), is.table_wood);
  const glm::vec2 drum[] = {{0, 0.03F}, {0, y - 0.05F}}, plinth[] = {{0, 0}, {0, 0.025F}, {0.012F, 0.035F}};
  for (const float x : {-1.55F, 0.0F, 1.55F}) {
    Mesh foot = make_slab("table foot", 0.3F, 0.24F, drum, round / 2);
    project_uvs(foot, 0.8F, true);
    add_object(scene, transformed(std::move(foot), placed({x, 0, 0})), is.table_wood);
    Mesh base = make_slab("table plinth", 0.36F, 0.3F, plinth, round / 2);
    append(base, make_face("", 0.348F, 0.288F, 0.035F, true, round / 2, 1));
    add_object(scene, transformed(std::move(base), placed({x, 0, 0})), is.dark);
  }
}

void add_chairs(Scene& scene, const Materials& is, const Detail& detail) {
  const std::uint32_t frame = add_mesh(scene, make_chair_frame(detail), is.dark);
  const std::uint32_t upholstery = add_mesh(scene, make_upholstery(detail), is.fabric);
  std::uint64_t number = 0;
  const auto add_chair = [&](float x, float z, double turns) {
    ++number;
    const auto stray = [number](std::uint64_t what, float most) {
      return random_between(-most, most, 71, number, what);
    };
    const glm::mat4 at =
        placed({x + stray(0, 0.04F), 0, z + stray(1, 0.05F)}, turns + static_cast<double>(stray(2, 0.035F)));
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

}  // namespace traces::conference
