#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "traces/scenes/bathroom/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::bathroom {
namespace {

/// Makes a swan-necked tap at the origin, with its spout towards +z.
Mesh make_tap(const Detail& detail, float height, float reach) {
  const std::uint32_t round = detail.cell_count(16, 6);
  const glm::vec2 foot[] = {{0.028F, 0},     {0.028F, 0.008F}, {0.02F, 0.014F},
                            {0.017F, 0.05F}, {0.013F, 0.055F}, {0, 0.055F}};
  Mesh mesh = make_lathe("tap", detail.coarser_profile(foot), round);
  const glm::vec3 neck[] = {{0, 0.03F, 0},
                            {0, 0.7F * height, 0.0F},
                            {0, height, 0.35F * reach},
                            {0, 0.95F * height, 0.85F * reach},
                            {0, 0.72F * height, reach}};
  append_mesh(mesh, make_tube("", catmull_rom(neck, detail.cell_count(8, 3)), std::array{0.0105F}, round));
  for (const float side : {-1.0F, 1.0F}) {
    const glm::mat4 at = placement_at({side * 0.085F, 0, 0});
    const glm::vec2 knob[] = {{0.022F, 0},      {0.022F, 0.006F}, {0.012F, 0.012F}, {0.012F, 0.04F},
                              {0.018F, 0.046F}, {0.016F, 0.056F}, {0, 0.058F}};
    append_mesh(mesh, transform_mesh(make_lathe("", detail.coarser_profile(knob), round), at));
    for (int k = 0; k < 4; ++k) {
      const glm::vec2 way = circle_point(0.25 * k + 0.1);
      const glm::vec3 spoke[] = {{0, 0.05F, 0}, {0.034F * way.x, 0.05F, 0.034F * way.y}};
      append_mesh(mesh, transform_mesh(make_tube("", spoke, std::array{0.005F}, detail.cell_count(8, 4)), at));
      append_mesh(mesh,
                  transform_mesh(
                      make_sphere("", {0.036F * way.x, 0.05F, 0.036F * way.y}, 0.007F, detail.cell_count(3, 2)), at));
    }
  }
  return mesh;
}

Mesh make_drain(const Detail& detail) {
  const glm::vec2 plug[] = {{0.03F, 0}, {0.03F, 0.003F}, {0.022F, 0.004F}, {0.018F, 0.009F}, {0, 0.011F}};
  return make_lathe("drain", detail.coarser_profile(plug), detail.cell_count(20, 8));
}

}  // namespace

Mesh make_vessel(std::string name, std::span<const glm::vec3> rings, bool square, std::uint32_t round,
                 std::uint32_t steps) {
  const std::vector<glm::vec3> path = catmull_rom(rings, steps);
  const auto last = static_cast<std::uint32_t>(path.size() - 1);
  return make_surface(
      std::move(name), round, last,
      [&](float s, float t) {
        const glm::vec3 ring = path[static_cast<std::size_t>(t * static_cast<float>(last) + 0.5F)];
        const float a = std::max(ring.x, 0.0F), b = std::max(ring.y, 0.0F);
        const glm::vec2 p = square ? rounded_rectangle_point(static_cast<double>(s), a, b)
                                   : circle_point(static_cast<double>(s)) * glm::vec2(a, b);
        return glm::vec3(p.x, ring.z, -p.y);
      },
      true);
}

void add_tub(Scene& scene, const Materials& materials, const Detail& detail) {
  const glm::vec3 rings[] = {{0.80F, 0.34F, 0.0F},     {0.81F, 0.345F, 0.04F}, {0.835F, 0.37F, 0.30F},
                             {0.85F, 0.388F, 0.53F},   {0.86F, 0.40F, 0.555F}, {0.86F, 0.40F, 0.575F},
                             {0.845F, 0.385F, 0.585F}, {0.80F, 0.335F, 0.58F}, {0.785F, 0.32F, 0.565F},
                             {0.76F, 0.305F, 0.48F},   {0.70F, 0.27F, 0.22F},  {0.66F, 0.235F, 0.14F},
                             {0.56F, 0.16F, 0.11F},    {0.3F, 0.08F, 0.1F},    {0, 0, 0.098F}};
  const glm::vec3 middle(kTubLeft + kTubHalf, 0, kTubZ);
  add_object(scene,
             transform_mesh(make_vessel("bath tub", rings, true, detail.cell_count(112, 24), detail.cell_count(4)),
                            placement_at(middle)),
             materials.enamel);
  add_object(scene, transform_mesh(make_drain(detail), placement_at(middle + glm::vec3(-0.45F, 0.108F, 0))),
             materials.chrome);
  add_object(scene,
             transform_mesh(make_tap(detail, 0.2F, 0.2F), placement_at({kTubLeft + 0.035F, kTubRim, kTubZ}, 0.25)),
             materials.chrome);
  // The glass screen on the rim of the tub, hinged at the wall.
  const float z = kTubZ + 0.36F;
  // One sheet that does not refract: through two glass surfaces, paths of limited depth would not reach the chrome.
  add_object(scene, make_quad("shower screen", {-1.77F, kTubRim + 0.012F, z}, {0.82F, 0, 0}, {0, 1.4F, 0}, 1),
             materials.glass);
  Mesh profile = make_box("screen profile", {-1.79F, kTubRim + 0.01F, z - 0.012F}, {-1.765F, 2.01F, z + 0.012F});
  append_mesh(profile, make_box("", {-1.765F, kTubRim + 0.004F, z - 0.007F}, {-0.95F, kTubRim + 0.014F, z + 0.007F}));
  append_mesh(profile, make_box("", {-1.765F, 2.0F, z - 0.007F}, {-0.95F, 2.012F, z + 0.007F}));
  append_mesh(profile, make_box("", {-0.955F, kTubRim + 0.004F, z - 0.006F}, {-0.945F, 2.012F, z + 0.006F}));
  add_object(scene, std::move(profile), materials.chrome);
}

void add_vanity(Scene& scene, const Materials& materials, const Detail& detail) {
  constexpr float kLeft = 0.32F, kRight = 1.72F, kFront = -kHalfWidth + 0.5F, back = -kHalfWidth + 0.012F;
  Mesh cabinet = make_box("vanity", {kLeft, 0.25F, back}, {kRight, kCounter - 0.04F, kFront});
  const glm::vec2 drawer[] = {{0.004F, 0}, {0.004F, 0.018F}, {0.012F, 0.022F}, {0.05F, 0.022F}, {0.055F, 0.015F}};
  Mesh pulls;
  pulls.name = "drawer pulls";
  for (int row = 0; row < 2; ++row) {
    for (int k = 0; k < 2; ++k) {
      const glm::vec3 corner(kLeft + 0.7F * static_cast<float>(k), 0.25F + 0.275F * static_cast<float>(row), kFront);
      append_mesh(cabinet,
                  transform_mesh(make_panel("", 0.7F, 0.275F, detail.coarser_profile(drawer), detail.cell_count(3)),
                                 placement_at(corner)));
      const glm::vec3 bow[] = {corner + glm::vec3(0.27F, 0.14F, 0.012F), corner + glm::vec3(0.275F, 0.14F, 0.035F),
                               corner + glm::vec3(0.35F, 0.14F, 0.045F), corner + glm::vec3(0.425F, 0.14F, 0.035F),
                               corner + glm::vec3(0.43F, 0.14F, 0.012F)};
      append_mesh(
          pulls, make_tube("", catmull_rom(bow, detail.cell_count(4, 2)), std::array{0.005F}, detail.cell_count(8, 4)));
    }
  }
  for (const float x : {kLeft + 0.05F, kRight - 0.05F}) {
    for (const float z : {back + 0.05F, kFront - 0.05F}) {
      append_mesh(cabinet, transform_mesh(make_cone("", 0.018F, 0.03F, 0.25F, detail.cell_count(16, 6)),
                                          placement_at({x, 0, z})));
    }
  }
  project_uvs(cabinet, 0.8F);
  add_object(scene, std::move(cabinet), materials.oak);
  add_object(scene, std::move(pulls), materials.chrome);
  Mesh top = make_rounded_box("counter", {kLeft - 0.03F, kCounter - 0.04F, back},
                              {kRight + 0.03F, kCounter, kFront + 0.04F}, 0.008F, detail.cell_count(3));
  project_uvs(top, 0.9F);
  add_object(scene, std::move(top), materials.stone);
}

void add_basin(Scene& scene, const Materials& materials, const Detail& detail) {
  const glm::vec3 rings[] = {
      {0.15F, 0.11F, 0},        {0.19F, 0.14F, 0.03F},   {0.245F, 0.178F, 0.11F}, {0.255F, 0.187F, 0.135F},
      {0.252F, 0.184F, 0.142F}, {0.242F, 0.175F, 0.14F}, {0.23F, 0.163F, 0.115F}, {0.18F, 0.125F, 0.04F},
      {0.1F, 0.07F, 0.018F},    {0.04F, 0.03F, 0.014F},  {0, 0, 0.013F}};
  const glm::vec3 at(1.02F, kCounter, -kHalfWidth + 0.29F);
  add_object(scene,
             transform_mesh(make_vessel("wash basin", rings, false, detail.cell_count(72, 20), detail.cell_count(4)),
                            placement_at(at)),
             materials.enamel);
  add_object(scene, transform_mesh(make_drain(detail), placement_at(at + glm::vec3(0, 0.013F, 0))), materials.chrome);
  add_object(scene,
             transform_mesh(make_tap(detail, 0.28F, 0.17F), placement_at({1.02F, kCounter, -kHalfWidth + 0.075F})),
             materials.chrome);
}

/// Adds the mirror above the basin, and a row of bulbs above it.
void add_mirror(Scene& scene, const Materials& materials, const Detail& detail) {
  const glm::mat4 wall = wall_axes({-kHalfLength, 0, -kHalfWidth}, {0, 0, 1});
  const glm::vec2 rim[] = {{0, 0}, {0, 0.03F}, {0.02F, 0.035F}, {0.03F, 0.02F}, {0.03F, 0.018F}};
  Mesh frame = make_panel("mirror frame", 1.4F, 0.9F, rim);
  frame.triangles.resize(frame.triangles.size() - 2);
  add_object(scene, transform_mesh(std::move(frame), wall * placement_at({2.12F, 1.2F, 0})), materials.oak);
  add_object(scene, transform_mesh(make_quad("mirror", {2.15F, 1.23F, 0.019F}, {1.34F, 0, 0}, {0, 0.84F, 0}, 1), wall),
             materials.mirror);
  Mesh bulbs,
      sockets = transform_mesh(
          make_rounded_box("lamp strip", {2.3F, 2.15F, 0}, {3.34F, 2.21F, 0.03F}, 0.01F, detail.cell_count(2)), wall);
  bulbs.name = "bulbs";
  for (int k = 0; k < 6; ++k) {
    const float x = 2.4F + 0.168F * static_cast<float>(k);
    append_mesh(bulbs, transform_mesh(make_sphere("", {x, 2.18F, 0.085F}, 0.034F, detail.cell_count(6, 3)), wall));
    append_mesh(sockets, transform_mesh(make_cylinder("", 0.02F, 0.035F, detail.cell_count(14, 6)),
                                        wall * rotation_about({x, 2.18F, 0.025F}, {1, 0, 0}, 0.25)));
  }
  add_object(scene, std::move(bulbs), materials.lamp);
  add_object(scene, std::move(sockets), materials.chrome);
}

void add_toilet(Scene& scene, const Materials& materials, const Detail& detail) {
  const std::uint32_t round = detail.cell_count(64, 18), steps = detail.cell_count(4);
  const glm::vec3 bowl[] = {
      {0.12F, 0.10F, 0},      {0.115F, 0.095F, 0.04F}, {0.11F, 0.09F, 0.14F},  {0.17F, 0.14F, 0.25F},
      {0.235F, 0.18F, 0.37F}, {0.24F, 0.185F, 0.395F}, {0.235F, 0.18F, 0.40F}, {0.19F, 0.14F, 0.398F},
      {0.15F, 0.11F, 0.3F},   {0.06F, 0.05F, 0.18F},   {0, 0, 0.17F}};
  const glm::vec3 lid[] = {{0.225F, 0.175F, 0.41F}, {0.245F, 0.188F, 0.415F}, {0.247F, 0.19F, 0.43F},
                           {0.235F, 0.18F, 0.442F}, {0.12F, 0.1F, 0.448F},    {0, 0, 0.45F}};
  // Makes the outline of the toilet egg-shaped, with a longer front (-x).
  const auto egg = [](const glm::vec3& p) {
    return glm::vec3(p.x < 0 ? 1.15F * p.x : p.x, p.y, p.z * (1 - 0.25F * p.x / 0.25F * 0.3F));
  };
  const glm::mat4 at = placement_at({kHalfLength - 0.46F, 0, 0.1F});
  Mesh body = warp_mesh(make_vessel("toilet", bowl, false, round, steps), egg);
  append_mesh(body, warp_mesh(make_vessel("", lid, false, round, steps), egg));
  append_mesh(body, make_cushion("", {0.2F, 0.36F, -0.19F}, {0.44F, 0.78F, 0.19F}, 0.03F, detail.cell_count(4), 1));
  append_mesh(body, make_cushion("", {0.19F, 0.785F, -0.2F}, {0.445F, 0.82F, 0.2F}, 0.015F, detail.cell_count(3), 1));
  append_mesh(body, make_cushion("", {0.05F, 0.0F, -0.1F}, {0.40F, 0.37F, 0.1F}, 0.03F, detail.cell_count(3), 1));
  add_object(scene, transform_mesh(std::move(body), at), materials.enamel);
  const glm::vec2 button[] = {{0.025F, 0}, {0.025F, 0.004F}, {0.02F, 0.006F}, {0, 0.006F}};
  add_object(scene,
             transform_mesh(make_lathe("flush", detail.coarser_profile(button), detail.cell_count(16, 6)),
                            at * placement_at({0.32F, 0.82F, 0})),
             materials.chrome);
  // A roll of paper on its holder.
  const glm::vec3 holder[] = {{kHalfLength - 0.01F, 0.78F, 0.5F},
                              {kHalfLength - 0.06F, 0.78F, 0.5F},
                              {kHalfLength - 0.09F, 0.78F, 0.54F},
                              {kHalfLength - 0.09F, 0.78F, 0.64F}};
  add_object(scene,
             make_tube("paper holder", catmull_rom(holder, detail.cell_count(4, 2)), std::array{0.006F},
                       detail.cell_count(10, 5)),
             materials.chrome);
  const glm::vec2 roll[] = {{0.02F, 0}, {0.055F, 0}, {0.055F, 0.1F}, {0.02F, 0.1F}, {0.02F, 0}};
  add_object(scene,
             transform_mesh(make_lathe("paper roll", detail.coarser_profile(roll), detail.cell_count(36, 12)),
                            rotation_about({kHalfLength - 0.09F, 0.768F, 0.52F}, {1, 0, 0}, 0.25)),
             materials.white);
}

namespace {

Mesh make_rod(const glm::vec3& from, const glm::vec3& to, float radius, std::uint32_t round) {
  return make_tube("", std::array{from, to}, std::array{radius}, round);
}

/// Makes a metal hose whose radius alternates along its path.
Mesh make_hose(std::span<const glm::vec3> path, const Detail& detail) {
  const std::vector<glm::vec3> curve = catmull_rom(path, detail.cell_count(60, 12));
  std::vector<float> radii;
  for (std::size_t k = 0; k < curve.size(); ++k) radii.push_back(k % 2 == 0 ? 0.0075F : 0.0058F);
  return make_tube("shower hose", curve, radii, detail.cell_count(9, 5));
}

/// Makes a shower head with its jets towards -y.
Mesh make_head(const Detail& detail) {
  const glm::vec2 body[] = {{0, 0},          {0.05F, 0},      {0.055F, 0.005F}, {0.055F, 0.014F},
                            {0.035F, 0.03F}, {0.016F, 0.04F}, {0, 0.042F}};
  Mesh mesh = make_lathe("shower head", detail.coarser_profile(body), detail.cell_count(32, 10));
  for (int ring = 1; ring <= (detail.share < 0.5 ? 2 : 4); ++ring) {
    for (int k = 0; k < 6 * ring; ++k) {
      const glm::vec2 at = circle_point(k / (6.0 * ring)) * 0.0115F * static_cast<float>(ring);
      append_mesh(mesh, transform_mesh(make_cylinder("", 0.002F, 0.004F, detail.cell_count(6, 3)),
                                       placement_at({at.x, -0.004F, at.y})));
    }
  }
  return mesh;
}

/// Makes a wire basket of stacked hoops and of ribs that meet at the bottom; `a` is half its length, `b` half its
/// depth.
Mesh make_basket(const Detail& detail, float a, float b, float height, std::uint32_t most_ribs, int hoops) {
  const std::uint32_t sides = detail.cell_count(6, 3), round = detail.cell_count(48, 16);
  const int ribs = static_cast<int>(std::min(detail.cell_count(most_ribs, most_ribs / 3), most_ribs));
  const auto widening = [height](float y) { return 0.82F + 0.18F * y / height; };
  Mesh mesh;
  mesh.name = "wire basket";
  const auto add_hoop = [&](float y, float radius) {
    std::vector<glm::vec3> hoop;
    for (std::uint32_t k = 0; k <= round; ++k) {
      const glm::vec2 p =
          rounded_rectangle_point(k == round ? 0.0 : static_cast<double>(k) / round, a, b) * widening(y);
      hoop.emplace_back(p.x, y, p.y);
    }
    append_mesh(mesh, make_tube("", hoop, std::array{radius}, sides));
  };
  for (int k = 0; k <= hoops; ++k)
    add_hoop(0.004F + height * static_cast<float>(k) / static_cast<float>(hoops), k == hoops ? 0.003F : 0.0016F);
  for (int k = 0; k < ribs; ++k) {
    const glm::vec2 p = rounded_rectangle_point(static_cast<double>(k) / ribs, a, b), q = p * widening(0);
    append_mesh(mesh, make_rod({q.x, 0.003F, q.y}, {p.x, height, p.y}, 0.0014F, sides));
  }
  for (int k = 1; k < 10; ++k) {
    const float x = a * widening(0) * (0.2F * static_cast<float>(k) - 1), reach = b * widening(0) * 0.97F;
    append_mesh(mesh, make_rod({x, 0.003F, -reach}, {x, 0.003F, reach}, 0.0014F, sides));
  }
  return mesh;
}

}  // namespace

void add_shower(Scene& scene, const Materials& materials, const Detail& detail) {
  const std::uint32_t round = detail.cell_count(14, 6);
  constexpr float x = -kHalfLength + 0.06F, z = kTubZ - 0.14F;
  Mesh rail = make_rod({x, 1.05F, z}, {x, 1.98F, z}, 0.011F, round);
  rail.name = "shower rail";
  for (const float y : {1.1F, 1.93F})
    append_mesh(rail, make_rod({-kHalfLength + 0.005F, y, z}, {x, y, z}, 0.012F, round));
  append_mesh(rail, make_sphere("", {x, 1.8F, z}, 0.022F, detail.cell_count(6, 3)));
  const glm::vec3 arm[] = {{x, 1.8F, z}, {x + 0.05F, 1.8F, z}, {x + 0.14F, 1.85F, z}, {x + 0.22F, 1.88F, z}};
  append_mesh(rail, make_tube("", catmull_rom(arm, detail.cell_count(6, 2)), std::array{0.012F}, round));
  append_mesh(rail, transform_mesh(make_head(detail), rotation_about({x + 0.25F, 1.85F, z}, {0, 0, 1}, 0.06)));
  // The mixer tap that holds the hose.
  append_mesh(rail, make_rod({x, 0.95F, z - 0.02F}, {x, 0.95F, z + 0.3F}, 0.022F, round));
  for (const float end : {-0.05F, 0.3F})
    append_mesh(rail, make_rod({x, 0.95F, z + end}, {x, 0.95F, z + end + 0.04F}, 0.028F, round));
  for (const float at : {0.03F, 0.25F})
    append_mesh(rail, make_rod({-kHalfLength, 0.95F, z + at}, {x, 0.95F, z + at}, 0.016F, round));
  add_object(scene, std::move(rail), materials.chrome);
  const glm::vec3 path[] = {{x, 0.93F, z + 0.14F},         {x + 0.01F, 0.84F, z + 0.15F}, {x + 0.05F, 0.70F, z + 0.2F},
                            {x + 0.12F, 0.66F, z + 0.12F}, {x + 0.16F, 0.85F, z + 0.05F}, {x + 0.12F, 1.3F, z + 0.09F},
                            {x + 0.06F, 1.65F, z + 0.04F}, {x + 0.04F, 1.79F, z}};
  add_object(scene, make_hose(path, detail), materials.chrome);

  // A towel rail above the tub, and a radiator of rods on the wall at +x.
  constexpr float back = -kHalfWidth;
  Mesh bar = make_rod({-0.98F, 1.52F, back + 0.075F}, {-0.08F, 1.52F, back + 0.075F}, 0.009F, round);
  bar.name = "towel rail";
  for (const float at : {-0.96F, -0.1F}) {
    append_mesh(bar, make_rod({at, 1.52F, back + 0.008F}, {at, 1.52F, back + 0.075F}, 0.007F, round));
    append_mesh(bar, transform_mesh(make_cylinder("", 0.024F, 0.01F, detail.cell_count(20, 8)),
                                    rotation_about({at, 1.52F, back + 0.009F}, {1, 0, 0}, 0.25)));
  }
  add_object(scene, std::move(bar), materials.chrome);
  Mesh ladder;
  ladder.name = "towel radiator";
  constexpr float wall = kHalfLength - 0.075F, from = -0.78F, to = -0.3F;
  for (const float at : {from, to}) append_mesh(ladder, make_rod({wall, 0.35F, at}, {wall, 1.62F, at}, 0.014F, round));
  for (int k = 0; k < 20; ++k) {
    const float y = 0.4F + 0.058F * static_cast<float>(k + k / 5);
    if (y < 1.6F) append_mesh(ladder, make_rod({wall, y, from}, {wall, y, to}, 0.008F, round));
  }
  for (const float y : {0.45F, 1.5F}) {
    for (const float at : {from, to})
      append_mesh(ladder, make_rod({kHalfLength - 0.005F, y, at}, {wall, y, at}, 0.008F, round));
  }
  add_object(scene, std::move(ladder), materials.chrome);
}

void add_baskets(Scene& scene, const Materials& materials, const Detail& detail) {
  // Laundry on the floor at the tub's end, bottles in a caddy on the tiles, soap on the tub's rim.
  const glm::mat4 laundry = placement_at({0.02F, 0.005F, -1.18F});
  add_object(scene, transform_mesh(make_basket(detail, 0.19F, 0.19F, 0.42F, 52, 9), laundry), materials.wire);
  Mesh rolls;
  rolls.name = "rolled towels";
  constexpr float kTurns = 3.4F;
  for (int k = 0; k < 5; ++k) {
    const glm::vec2 at = k == 4 ? glm::vec2(0) : 0.095F * circle_point(0.25 * k + 0.1);
    append_mesh(rolls,
                transform_mesh(make_surface("", detail.cell_count(64, 20), detail.cell_count(10, 2),
                                            [&](float s, float t) {
                                              const glm::vec2 p =
                                                  circle_point(static_cast<double>(kTurns * s)) * (0.012F + 0.05F * s);
                                              return glm::vec3(
                                                  p.x, 0.5F * t * (1 - 0.03F * s * static_cast<float>(k % 3)), -p.y);
                                            }),
                               laundry * placement_at({at.x, 0.012F, at.y}, 0.17 * k)));
  }
  scale_uvs(rolls, {6, 2});
  add_object(scene, std::move(rolls), materials.towel);
  const glm::mat4 caddy = placement_at({-1.3F, 1.25F, -kHalfWidth + 0.075F});
  add_object(scene, transform_mesh(make_basket(detail, 0.17F, 0.06F, 0.09F, 40, 4), caddy), materials.chrome);
}

namespace {

/// Makes a towel that hangs over a rail along x at the origin, with soft waves. `front` is its length on the side of
/// +z, `back` on the other side. It is two sheets joined at the hems.
Mesh make_towel(const Detail& detail, float width, float front, float back, float radius, std::uint32_t seed) {
  constexpr float kThick = 0.007F, kQuarter = 1.5708F;
  const float over = 2 * kQuarter * radius, length = front + over + back;
  const auto on_sheet = [=](float s, float t, float lift) {
    const float at = t * length;
    const float r = radius + lift;
    glm::vec2 p;  // (z, y) of the section
    float down = 0;
    if (at < front) {
      down = front - at;
      p = {r, -down};
    } else if (at < front + over) {
      const glm::vec2 round = circle_point(static_cast<double>((at - front) / over) * 0.5);
      p = r * round;
    } else {
      down = at - front - over;
      p = {-r, -down};
    }
    const float loose = down / (down + 0.15F);
    const float wave = 0.016F * sin_turns(static_cast<double>(2.3F * s + 0.1F * static_cast<float>(seed))) +
                       0.012F * (value_noise(s * 0.99F, down, 4, seed) - 0.5F);
    const float narrow = 1 - 0.05F * loose * value_noise(0.3F, down, 3, seed + 1);
    return glm::vec3((s - 0.5F) * width * narrow, p.y + 0.006F * loose * wave / 0.016F,
                     p.x + (p.x > 0 ? std::max(wave, -0.2F * radius) : -std::max(wave, -0.2F * radius)) * loose);
  };
  const std::uint32_t columns = detail.cell_count(34, 8), rows = detail.cell_count(64, 16);
  Mesh mesh = make_surface("towel", columns, rows, [&](float s, float t) {
    const float hem = std::min(1.0F, 20 * std::min(std::min(s, 1 - s), std::min(t, 1 - t)));
    return on_sheet(s, t, kThick * hem);
  });
  append_mesh(mesh, make_surface("", columns, rows, [&](float s, float t) { return on_sheet(1 - s, t, 0); }));
  // Fringes along the front hem.
  const std::uint32_t threads = detail.piece_count(static_cast<std::uint32_t>(170 * width), 10);
  for (std::uint32_t k = 0; k < threads; ++k) {
    const float s = (static_cast<float>(k) + 0.5F) / static_cast<float>(threads);
    const glm::vec3 top = on_sheet(s, 0, 0.002F);
    const auto stray = [&](std::uint32_t what) { return 0.008F * (random_unit(seed, k, what) - 0.5F); };
    const glm::vec3 path[] = {top, top + glm::vec3(stray(0), -0.018F, stray(1)),
                              top + glm::vec3(stray(2), -0.04F, stray(3))};
    append_mesh(mesh, make_tube("", path, std::array{0.0012F, 0.0011F, 0.0F}, 3));
  }
  return mesh;
}

}  // namespace

void add_towels(Scene& scene, const Materials& materials, const Detail& detail) {
  constexpr float back = -kHalfWidth + 0.075F;
  add_object(scene,
             transform_mesh(make_towel(detail, 0.42F, 0.62F, 0.45F, 0.012F, 3), placement_at({-0.73F, 1.52F, back})),
             materials.towel);
  add_object(scene,
             transform_mesh(make_towel(detail, 0.3F, 0.44F, 0.32F, 0.012F, 7), placement_at({-0.3F, 1.52F, back})),
             materials.striped);
  const float y = 0.4F + 0.058F * 17;
  add_object(scene,
             transform_mesh(make_towel(detail, 0.38F, 0.5F, 0.4F, 0.012F, 12),
                            placement_at({kHalfLength - 0.075F, y, -0.54F}, -0.25)),
             materials.striped);
}

/// Adds a mat of tufts on the floor at the tub.
void add_mat(Scene& scene, const Materials& materials, const Detail& detail) {
  constexpr float kLength = 0.8F, kDepth = 0.5F, kLow = 0.012F;
  Mesh mat = make_rounded_box("bath mat", {-kLength / 2, 0.004F, -kDepth / 2}, {kLength / 2, kLow, kDepth / 2}, 0.0035F,
                              detail.cell_count(2));
  const std::uint32_t columns = detail.cell_count(104, 16), rows = detail.cell_count(64, 10);
  const float thick = 0.45F * kLength / static_cast<float>(columns);
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const auto stray = [&](std::uint32_t what) { return random_unit(i, j, what) - 0.5F; };
      const glm::vec3 root(
          kLength * ((static_cast<float>(i) + 0.5F + 0.6F * stray(0)) / static_cast<float>(columns) - 0.5F),
          kLow - 0.001F, kDepth * ((static_cast<float>(j) + 0.5F + 0.6F * stray(1)) / static_cast<float>(rows) - 0.5F));
      const glm::vec3 tip = root + glm::vec3(0.014F * stray(2), 0.022F + 0.008F * stray(3), 0.014F * stray(4));
      append_mesh(mat, make_tube("", std::array{root, tip}, std::array{thick, 0.0F}, 3));
    }
  }
  add_object(scene, transform_mesh(std::move(mat), placement_at({-0.72F, 0, -0.35F}, 0.015)), materials.mat);
}

namespace {

/// Adds a bottle with shoulders, and its screw cap.
void add_bottle(Scene& scene, const Detail& detail, const glm::vec3& at, float radius, float height, std::uint32_t body,
                std::uint32_t cap) {
  const std::uint32_t round = detail.cell_count(32, 10);
  const glm::vec2 shape[] = {
      {0.85F * radius, 0},      {radius, 0.04F * height},        {radius, 0.4F * height},
      {radius, 0.75F * height}, {0.8F * radius, 0.87F * height}, {0.38F * radius, 0.93F * height},
      {0.35F * radius, height}};
  add_object(
      scene,
      transform_mesh(make_lathe("bottle", catmull_rom(detail.coarser_profile(shape), detail.cell_count(4, 2)), round),
                     placement_at(at)),
      body);
  std::vector<glm::vec2> top{{0.45F * radius, 0}};
  for (int k = 0; k < 4; ++k) {
    const float y = 0.012F * static_cast<float>(k);
    top.emplace_back(0.5F * radius, y + 0.002F);
    top.emplace_back(0.5F * radius, y + 0.008F);
    top.emplace_back(0.47F * radius, y + 0.009F);
    top.emplace_back(0.47F * radius, y + 0.011F);
  }
  top.emplace_back(0.46F * radius, 0.05F);
  top.emplace_back(0, 0.051F);
  add_object(scene,
             transform_mesh(make_lathe("cap", detail.coarser_profile(top), round),
                            placement_at(at + glm::vec3(0, 0.95F * height, 0))),
             cap);
}

/// Adds a soap dispenser with a pump.
void add_dispenser(Scene& scene, const Materials& materials, const Detail& detail, const glm::vec3& at) {
  const std::uint32_t round = detail.cell_count(36, 12);
  const glm::vec2 body[] = {{0.034F, 0},      {0.04F, 0.006F},  {0.041F, 0.05F}, {0.041F, 0.1F},
                            {0.036F, 0.118F}, {0.018F, 0.128F}, {0.016F, 0.132F}};
  add_object(scene,
             transform_mesh(make_lathe("soap dispenser",
                                       catmull_rom(detail.coarser_profile(body), detail.cell_count(4, 2)), round),
                            placement_at(at)),
             materials.amber);
  const glm::vec2 collar[] = {{0.019F, 0.128F}, {0.019F, 0.143F}, {0.006F, 0.145F}, {0.006F, 0.165F},
                              {0.013F, 0.167F}, {0.013F, 0.178F}, {0, 0.18F}};
  Mesh pump = make_lathe("pump", detail.coarser_profile(collar), detail.cell_count(20, 8));
  const glm::vec3 spout[] = {{0, 0.172F, 0}, {0, 0.174F, 0.025F}, {0, 0.172F, 0.045F}, {0, 0.16F, 0.052F}};
  append_mesh(
      pump, make_tube("", catmull_rom(spout, detail.cell_count(5, 2)), std::array{0.0045F}, detail.cell_count(10, 4)));
  add_object(scene, transform_mesh(std::move(pump), placement_at(at, 0.05)), materials.chrome);
}

/// Makes bristles along +y on a rectangle around the origin.
Mesh make_bristles(std::string name, float half_length, float half_width, float tall, float radius,
                   std::uint32_t columns, std::uint32_t rows) {
  Mesh mesh;
  mesh.name = std::move(name);
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const float u = 2 * (static_cast<float>(i) + 0.5F) / static_cast<float>(columns) - 1;
      const float v = 2 * (static_cast<float>(j) + 0.5F) / static_cast<float>(rows) - 1;
      if (u * u * u * u + v * v * v * v > 1) continue;
      const float bend = 0.12F * tall * (random_unit(i, j, 21) - 0.5F);
      const glm::vec3 root(half_length * u, 0, half_width * v);
      append_mesh(
          mesh, make_tube("", std::array{root, root + glm::vec3(bend + 0.1F * tall * u, tall, bend + 0.1F * tall * v)},
                          std::array{radius, 0.4F * radius}, 3));
    }
  }
  return mesh;
}

/// Adds a brush: an oval head that tapers into a handle along x, with its bristles upwards.
void add_brush(Scene& scene, const Materials& materials, const Detail& detail, const glm::mat4& at, float size,
               std::uint32_t wood) {
  Mesh body = warp_mesh(make_cushion("brush", {-0.5F, -0.09F, -0.13F}, {0.5F, 0.0F, 0.13F}, 0.044F,
                                     detail.cell_count(4), detail.cell_count(6)),
                        [](const glm::vec3& p) {
                          const float along = std::min(std::max((p.x - 0.0F) / 0.25F, 0.0F), 1.0F);
                          const float narrow = 1 - 0.62F * along * along * (3 - 2 * along);
                          return glm::vec3(p.x, p.y, p.z * narrow);
                        });
  const glm::mat4 scaled = at * placement_at(glm::vec3(0), 0, glm::vec3(size));
  add_object(scene, transform_mesh(std::move(body), scaled), wood);
  Mesh bristles =
      make_bristles("bristles", 0.22F, 0.105F, 0.13F, 0.0035F, detail.cell_count(36, 8), detail.cell_count(18, 4));
  add_object(scene, transform_mesh(std::move(bristles), scaled * placement_at({-0.24F, -0.002F, 0})),
             materials.bristle);
}

void add_toothbrushes(Scene& scene, const Materials& materials, const Detail& detail, const glm::vec3& at) {
  const glm::vec2 tumbler[] = {{0.03F, 0}, {0.036F, 0.1F}, {0.0345F, 0.1F}, {0.0285F, 0.008F}, {0, 0.008F}};
  add_object(scene,
             transform_mesh(make_lathe("tumbler", detail.coarser_profile(tumbler), detail.cell_count(36, 12)),
                            placement_at(at)),
             materials.white);
  const std::uint32_t inks[] = {materials.blue, materials.rose, materials.green};
  for (std::uint32_t k = 0; k < 3; ++k) {
    const glm::mat4 lean = placement_at(at + glm::vec3(0, 0.012F, 0), 0.33 * k) *
                           rotation_about(glm::vec3(-0.018F, 0, 0), {0, 0, 1}, -0.045);
    const glm::vec3 stick[] = {{0, 0, 0}, {0.001F, 0.06F, 0}, {0.001F, 0.12F, 0}, {0, 0.15F, 0}, {0, 0.18F, 0}};
    const float radii[] = {0.0045F, 0.0055F, 0.004F, 0.0035F, 0.005F};
    add_object(scene, transform_mesh(make_tube("toothbrush", stick, radii, detail.cell_count(8, 4)), lean), inks[k]);
    const Mesh tufts = make_bristles("toothbrush bristles", 0.013F, 0.0055F, 0.011F, 0.0006F, detail.cell_count(14, 4),
                                     detail.cell_count(7, 3));
    add_object(scene, transform_mesh(tufts, lean * rotation_about({0.0035F, 0.168F, 0}, {0, 0, 1}, -0.25)),
               materials.bristle);
  }
}

void add_duck(Scene& scene, const Materials& materials, const Detail& detail, const glm::mat4& at) {
  const std::uint32_t cells = detail.cell_count(10, 4);
  Mesh duck = warp_mesh(make_sphere("rubber duck", glm::vec3(0), 1, cells), [](const glm::vec3& p) {
    const float tail = std::max(0.0F, -p.x);
    return glm::vec3(0.06F * p.x, 0.036F + 0.038F * p.y + 0.035F * tail * tail * tail,
                     0.042F * p.z * (1 - 0.35F * tail));
  });
  append_mesh(duck, make_sphere("", {0.035F, 0.092F, 0}, 0.031F, cells));
  for (const float side : {-1.0F, 1.0F}) {
    append_mesh(duck, transform_mesh(warp_mesh(make_sphere("", glm::vec3(0), 1, detail.cell_count(6, 3)),
                                               [](const glm::vec3& p) {
                                                 return glm::vec3(0.03F * p.x, 0.017F * p.y + 0.01F * p.x * p.x,
                                                                  0.007F * p.z);
                                               }),
                                     placement_at({-0.008F, 0.045F, side * 0.04F})));
  }
  duck.uvs.clear();
  add_object(scene, transform_mesh(std::move(duck), at), materials.duck);
  Mesh beak = warp_mesh(make_sphere("beak", glm::vec3(0), 1, detail.cell_count(5, 3)), [](const glm::vec3& p) {
    return glm::vec3(0.07F + 0.014F * p.x, 0.088F + 0.005F * p.y, 0.013F * p.z);
  });
  add_object(scene, transform_mesh(std::move(beak), at), materials.beak);
  Mesh eyes = make_sphere("eyes", {0.061F, 0.102F, 0.014F}, 0.004F, detail.cell_count(3, 2));
  append_mesh(eyes, make_sphere("", {0.061F, 0.102F, -0.014F}, 0.004F, detail.cell_count(3, 2)));
  add_object(scene, transform_mesh(std::move(eyes), at), materials.black);
}

void add_fern(Scene& scene, const Materials& materials, const Detail& detail, const glm::vec3& at) {
  const glm::vec2 pot[] = {{0.035F, 0},     {0.05F, 0.08F},   {0.055F, 0.08F}, {0.055F, 0.095F},
                           {0.05F, 0.095F}, {0.045F, 0.085F}, {0, 0.085F}};
  add_object(
      scene,
      transform_mesh(make_lathe("pot", detail.coarser_profile(pot), detail.cell_count(28, 10)), placement_at(at)),
      materials.white);
  Mesh fern;
  fern.name = "fern";
  const std::uint32_t fronds = detail.cell_count(20, 8);
  for (std::uint32_t k = 0; k < fronds; ++k) {
    const glm::vec2 way = circle_point(static_cast<double>(0.382F * static_cast<float>(k)));
    const float rise = random_between(0.35F, 1.3F, 61, k), reach = random_between(0.16F, 0.24F, 62, k);
    const glm::vec3 direction = glm::normalize(glm::vec3(way.x, rise, way.y)), across(-way.y, 0, way.x);
    const auto on_rib = [&](float t) {
      return at + glm::vec3(0, 0.085F, 0) + reach * (t * direction - glm::vec3(0, 0.75F * t * t, 0));
    };
    const std::uint32_t leaflets = detail.cell_count(11, 5);
    for (std::uint32_t j = 1; j <= leaflets; ++j) {
      const float t = static_cast<float>(j) / static_cast<float>(leaflets);
      for (const float side : {-1.0F, 1.0F}) {
        add_leaf(fern, on_rib(t), glm::normalize(side * across + 0.5F * glm::vec3(way.x, 0.2F, way.y)),
                 0.06F * (1.1F - t), 0.011F, 0.3F, detail.cell_count(3, 2));
      }
    }
    const glm::vec3 rib[] = {on_rib(0), on_rib(0.33F), on_rib(0.66F), on_rib(1)};
    append_mesh(fern, make_tube("", rib, std::array{0.0015F}, 3));
  }
  add_object(scene, std::move(fern), materials.leaf);
}

}  // namespace

void add_toiletries(Scene& scene, const Materials& materials, const Detail& detail) {
  constexpr float back = -kHalfWidth;
  add_dispenser(scene, materials, detail, {0.66F, kCounter, back + 0.34F});
  add_toothbrushes(scene, materials, detail, {1.4F, kCounter, back + 0.22F});
  add_bottle(scene, detail, {1.56F, kCounter, back + 0.17F}, 0.032F, 0.2F, materials.bottle, materials.green);
  add_bottle(scene, detail, {1.63F, kCounter, back + 0.3F}, 0.026F, 0.13F, materials.water, materials.chrome);
  add_bottle(scene, detail, {1.53F, kCounter, back + 0.38F}, 0.02F, 0.09F, materials.rose, materials.white);
  add_fern(scene, materials, detail, {0.46F, kCounter, back + 0.18F});
  add_brush(scene, materials, detail, placement_at({0.52F, kCounter + 0.022F, back + 0.45F}, 0.06), 0.22F,
            materials.oak);
  // Bottles and soap in the caddy above the tub, and on the tub's rim.
  const float y = 1.256F, z = back + 0.075F;
  add_bottle(scene, detail, {-1.41F, y, z}, 0.033F, 0.2F, materials.blue, materials.white);
  add_bottle(scene, detail, {-1.32F, y, z}, 0.03F, 0.17F, materials.bottle, materials.rose);
  add_bottle(scene, detail, {-1.24F, y, z}, 0.028F, 0.21F, materials.green, materials.white);
  add_duck(scene, materials, detail, placement_at({-0.28F, kTubRim + 0.004F, kTubZ + 0.362F}, 0.11));
  add_brush(scene, materials, detail, placement_at({-0.055F, kTubRim + 0.04F, kTubZ - 0.05F}, 0.24), 0.34F,
            materials.oak);
  Mesh soap = make_cushion("soap", {-0.04F, 0, -0.026F}, {0.04F, 0.026F, 0.026F}, 0.0125F, detail.cell_count(4), 1);
  add_object(scene, transform_mesh(std::move(soap), placement_at({0.72F, kCounter, back + 0.47F}, 0.07)),
             materials.rose);
  // A rack across the tub with a sponge.
  Mesh rack;
  rack.name = "bath rack";
  for (int k = 0; k < 5; ++k) {
    const float x = -0.86F + 0.035F * static_cast<float>(k);
    append_mesh(rack, make_rounded_box("", {x, kTubRim + 0.004F, kTubZ - 0.4F},
                                       {x + 0.024F, kTubRim + 0.02F, kTubZ + 0.4F}, 0.004F, detail.cell_count(2)));
  }
  for (const float at : {-0.3F, 0.3F})
    append_mesh(rack, make_box("", {-0.86F, kTubRim + 0.0F, kTubZ + at - 0.015F},
                               {-0.696F, kTubRim + 0.006F, kTubZ + at + 0.015F}));
  project_uvs(rack, 1.5F);
  add_object(scene, std::move(rack), materials.oak);
  Mesh sponge = warp_mesh(
      make_cushion("sponge", {-0.06F, 0, -0.045F}, {0.06F, 0.05F, 0.045F}, 0.02F, detail.cell_count(4),
                   detail.cell_count(10)),
      [](const glm::vec3& p) { return p * (1 + 0.16F * (fractal_noise(60.0F * p + glm::vec3(9), 2, 5) - 0.5F)); });
  add_object(scene, transform_mesh(std::move(sponge), placement_at({-0.78F, kTubRim + 0.02F, kTubZ + 0.08F}, 0.1)),
             materials.duck);
}

}  // namespace traces::bathroom
