#include <algorithm>
#include <array>
#include <vector>

#include "traces/scenes/bathroom/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::bathroom {
namespace {

Mesh make_rod(const glm::vec3& from, const glm::vec3& to, float radius, std::uint32_t round) {
  return make_tube("", std::array{from, to}, std::array{radius}, round);
}

/// Makes a metal hose whose radius alternates along the path.
Mesh make_hose(std::span<const glm::vec3> path, const Detail& detail) {
  const std::vector<glm::vec3> curve = smoothed(path, detail.cells(60, 12));
  std::vector<float> radii;
  for (std::size_t k = 0; k < curve.size(); ++k) radii.push_back(k % 2 == 0 ? 0.0075F : 0.0058F);
  return make_tube("shower hose", curve, radii, detail.cells(9, 5));
}

/// Makes a shower head, its jets towards -y.
Mesh make_head(const Detail& detail) {
  const glm::vec2 body[] = {{0, 0},          {0.05F, 0},      {0.055F, 0.005F}, {0.055F, 0.014F},
                            {0.035F, 0.03F}, {0.016F, 0.04F}, {0, 0.042F}};
  Mesh mesh = make_lathe("shower head", detail.profile(body), detail.cells(32, 10));
  for (int ring = 1; ring <= (detail.share < 0.5 ? 2 : 4); ++ring) {
    for (int k = 0; k < 6 * ring; ++k) {
      const glm::vec2 at = on_circle(k / (6.0 * ring)) * 0.0115F * static_cast<float>(ring);
      append(mesh, transformed(make_cylinder("", 0.002F, 0.004F, detail.cells(6, 3)), placed({at.x, -0.004F, at.y})));
    }
  }
  return mesh;
}

/// Makes a wire basket of stacked hoops and of ribs that meet at the bottom. `a`: half length, `b`: half depth.
Mesh make_basket(const Detail& detail, float a, float b, float height, std::uint32_t most_ribs, int hoops) {
  const std::uint32_t sides = detail.cells(6, 3), round = detail.cells(48, 16);
  const int ribs = static_cast<int>(std::min(detail.cells(most_ribs, most_ribs / 3), most_ribs));
  const auto widening = [height](float y) { return 0.82F + 0.18F * y / height; };
  Mesh mesh;
  mesh.name = "wire basket";
  const auto add_hoop = [&](float y, float radius) {
    std::vector<glm::vec3> hoop;
    for (std::uint32_t k = 0; k <= round; ++k) {
      const glm::vec2 p = on_rounded_rectangle(k == round ? 0.0 : static_cast<double>(k) / round, a, b) * widening(y);
      hoop.emplace_back(p.x, y, p.y);
    }
    append(mesh, make_tube("", hoop, std::array{radius}, sides));
  };
  for (int k = 0; k <= hoops; ++k)
    add_hoop(0.004F + height * static_cast<float>(k) / static_cast<float>(hoops), k == hoops ? 0.003F : 0.0016F);
  for (int k = 0; k < ribs; ++k) {
    const glm::vec2 p = on_rounded_rectangle(static_cast<double>(k) / ribs, a, b), q = p * widening(0);
    append(mesh, make_rod({q.x, 0.003F, q.y}, {p.x, height, p.y}, 0.0014F, sides));
  }
  for (int k = 1; k < 10; ++k) {
    const float x = a * widening(0) * (0.2F * static_cast<float>(k) - 1), reach = b * widening(0) * 0.97F;
    append(mesh, make_rod({x, 0.003F, -reach}, {x, 0.003F, reach}, 0.0014F, sides));
  }
  return mesh;
}

}  // namespace

void add_shower(Scene& scene, const Materials& is, const Detail& detail) {
  const std::uint32_t round = detail.cells(14, 6);
  constexpr float x = -kHalfLength + 0.06F, z = kTubZ - 0.14F;
  Mesh rail = make_rod({x, 1.05F, z}, {x, 1.98F, z}, 0.011F, round);
  rail.name = "shower rail";
  for (const float y : {1.1F, 1.93F}) append(rail, make_rod({-kHalfLength + 0.005F, y, z}, {x, y, z}, 0.012F, round));
  append(rail, make_sphere("", {x, 1.8F, z}, 0.022F, detail.cells(6, 3)));
  const glm::vec3 arm[] = {{x, 1.8F, z}, {x + 0.05F, 1.8F, z}, {x + 0.14F, 1.85F, z}, {x + 0.22F, 1.88F, z}};
  append(rail, make_tube("", smoothed(arm, detail.cells(6, 2)), std::array{0.012F}, round));
  append(rail, transformed(make_head(detail), turned({x + 0.25F, 1.85F, z}, {0, 0, 1}, 0.06)));
  // The mixer tap that holds the hose.
  append(rail, make_rod({x, 0.95F, z - 0.02F}, {x, 0.95F, z + 0.3F}, 0.022F, round));
  for (const float end : {-0.05F, 0.3F})
    append(rail, make_rod({x, 0.95F, z + end}, {x, 0.95F, z + end + 0.04F}, 0.028F, round));
  for (const float at : {0.03F, 0.25F})
    append(rail, make_rod({-kHalfLength, 0.95F, z + at}, {x, 0.95F, z + at}, 0.016F, round));
  add_object(scene, std::move(rail), is.chrome);
  const glm::vec3 path[] = {{x, 0.93F, z + 0.14F},         {x + 0.01F, 0.84F, z + 0.15F}, {x + 0.05F, 0.70F, z + 0.2F},
                            {x + 0.12F, 0.66F, z + 0.12F}, {x + 0.16F, 0.85F, z + 0.05F}, {x + 0.12F, 1.3F, z + 0.09F},
                            {x + 0.06F, 1.65F, z + 0.04F}, {x + 0.04F, 1.79F, z}};
  add_object(scene, make_hose(path, detail), is.chrome);

  // A towel rail above the tub, and a radiator of rods on the wall at +x.
  constexpr float back = -kHalfWidth;
  Mesh bar = make_rod({-0.98F, 1.52F, back + 0.075F}, {-0.08F, 1.52F, back + 0.075F}, 0.009F, round);
  bar.name = "towel rail";
  for (const float at : {-0.96F, -0.1F}) {
    append(bar, make_rod({at, 1.52F, back + 0.008F}, {at, 1.52F, back + 0.075F}, 0.007F, round));
    append(bar, transformed(make_cylinder("", 0.024F, 0.01F, detail.cells(20, 8)),
                            turned({at, 1.52F, back + 0.009F}, {1, 0, 0}, 0.25)));
  }
  add_object(scene, std::move(bar), is.chrome);
  Mesh ladder;
  ladder.name = "towel radiator";
  constexpr float wall = kHalfLength - 0.075F, from = -0.78F, to = -0.3F;
  for (const float at : {from, to}) append(ladder, make_rod({wall, 0.35F, at}, {wall, 1.62F, at}, 0.014F, round));
  for (int k = 0; k < 20; ++k) {
    const float y = 0.4F + 0.058F * static_cast<float>(k + k / 5);
    if (y < 1.6F) append(ladder, make_rod({wall, y, from}, {wall, y, to}, 0.008F, round));
  }
  for (const float y : {0.45F, 1.5F}) {
    for (const float at : {from, to})
      append(ladder, make_rod({kHalfLength - 0.005F, y, at}, {wall, y, at}, 0.008F, round));
  }
  add_object(scene, std::move(ladder), is.chrome);
}

void add_baskets(Scene& scene, const Materials& is, const Detail& detail) {
  // Laundry on the floor at the tub's end, bottles in a caddy on the tiles, soap on the tub's rim.
  const glm::mat4 laundry = placed({0.02F, 0.005F, -1.18F});
  add_object(scene, transformed(make_basket(detail, 0.19F, 0.19F, 0.42F, 52, 9), laundry), is.wire);
  Mesh rolls;
  rolls.name = "rolled towels";
  constexpr float kTurns = 3.4F;
  for (int k = 0; k < 5; ++k) {
    const glm::vec2 at = k == 4 ? glm::vec2(0) : 0.095F * on_circle(0.25 * k + 0.1);
    append(rolls, transformed(make_surface("", detail.cells(64, 20), detail.cells(10, 2),
                                           [&](float s, float t) {
                                             const glm::vec2 p =
                                                 on_circle(static_cast<double>(kTurns * s)) * (0.012F + 0.05F * s);
                                             return glm::vec3(
                                                 p.x, 0.5F * t * (1 - 0.03F * s * static_cast<float>(k % 3)), -p.y);
                                           }),
                              laundry * placed({at.x, 0.012F, at.y}, 0.17 * k)));
  }
  scale_uvs(rolls, {6, 2});
  add_object(scene, std::move(rolls), is.towel);
  const glm::mat4 caddy = placed({-1.3F, 1.25F, -kHalfWidth + 0.075F});
  add_object(scene, transformed(make_basket(detail, 0.17F, 0.06F, 0.09F, 40, 4), caddy), is.chrome);
}

}  // namespace traces::bathroom
