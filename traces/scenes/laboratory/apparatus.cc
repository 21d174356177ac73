#include "traces/scenes/laboratory/apparatus.h"

#include <array>
#include <utility>
#include <vector>

#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"
#include "traces/scenes/modelling/turned.h"

namespace traces::laboratory {
namespace {

void add(Scene& scene, Mesh mesh, std::uint32_t material, const glm::mat4& at) {
  add_instance(scene, add_mesh(scene, std::move(mesh), material), at);
}

Mesh rod(const glm::vec3& from, const glm::vec3& to, float radius, const Detail& detail) {
  const std::array path{from, to};
  const std::array radii{radius};
  return make_tube("rod", path, radii, detail.cells(12, 5));
}

}  // namespace

void add_stand(Scene& scene, const Looks& looks, const glm::vec3& position, double turns, float clamp, float reach,
               const Detail& detail) {
  const glm::mat4 at = placed(position, turns);
  add(scene, make_rounded_box("foot", {-0.05F, 0, -0.075F}, {0.16F, 0.016F, 0.075F}, 0.005F, detail.cells(3)),
      looks.iron, at);
  Mesh steel = rod({0, 0.015F, 0}, {0, 0.56F, 0}, 0.006F, detail);
  append(steel, rod({0.01F, clamp, 0}, {reach - 0.035F, clamp, 0}, 0.004F, detail));
  steel.name = "rod";
  add(scene, std::move(steel), looks.steel, at);
  Mesh holder = make_rounded_box("clamp", {-0.014F, clamp - 0.014F, -0.014F}, {0.016F, clamp + 0.014F, 0.014F}, 0.003F,
                                 detail.cells(2));
  append(holder, rod({-0.014F, clamp, 0}, {-0.035F, clamp, 0}, 0.005F, detail));
  // Two fingers round the neck.
  for (const float side : {-1.0F, 1.0F}) {
    std::vector<glm::vec3> finger;
    for (int k = 0; k <= 8; ++k) {
      const glm::vec2 way = on_circle(0.46 - 0.42 * k / 8);
      finger.emplace_back(reach + 0.0205F * way.x - 0.004F * (k == 0 ? 1.0F : 0.0F), clamp, side * 0.0205F * way.y);
    }
    const std::array radii{0.0035F};
    append(holder, make_tube("", finger, radii, detail.cells(8, 4)));
  }
  append(holder, make_rounded_box("", {reach - 0.04F, clamp - 0.009F, -0.009F},
                                  {reach - 0.019F, clamp + 0.009F, 0.009F}, 0.003F, detail.cells(2)));
  add(scene, std::move(holder), looks.iron, at);
}

void add_burner(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail) {
  const glm::mat4 at = placed(position);
  const std::uint32_t sides = detail.cells(28, 8);
  Outline foot({0, 0});
  foot.line(0.040F, 0).arc(0.036F, 0.012F, 0.003F).arc(0.012F, 0.022F, -0.002F).line(0.010F, 0.026F).line(0, 0.026F);
  add(scene, make_lathe("burner foot", simplified(foot.points(), detail.cells(12, 7)), sides), looks.iron, at);
  Outline pipe({0.008F, 0.026F});
  pipe.line(0.012F, 0.028F).line(0.012F, 0.045F).line(0.008F, 0.047F).line(0.008F, 0.115F).line(0.010F, 0.117F);
  pipe.line(0.010F, 0.128F).line(0.0075F, 0.128F).line(0.0075F, 0.110F);
  Mesh barrel = make_lathe("burner", pipe.points(), sides);
  append(barrel, rod({0.010F, 0.018F, 0}, {0.060F, 0.018F, 0}, 0.005F, detail));
  add(scene, std::move(barrel), looks.brass, at);
  // The hose to the gas tap in the wall.
  const std::vector<glm::vec3> course{{0.055F, 0.018F, 0},     {0.085F, 0.016F, 0.005F}, {0.12F, 0.008F, -0.03F},
                                      {0.10F, 0.008F, -0.12F}, {0.03F, 0.008F, -0.20F},  {0.0F, 0.03F, -0.29F},
                                      {0.0F, 0.085F, -0.335F}};
  const std::array hose{0.0065F};
  add(scene,
      make_tube("hose", smoothed(std::span<const glm::vec3>(course), detail.cells(7, 3)), hose, detail.cells(12, 5)),
      looks.rubber, at);
  Mesh tap = rod({0, 0.08F, -0.335F}, {0, 0.13F, -0.335F}, 0.007F, detail);
  append(tap, rod({0, 0.12F, -0.40F}, {0, 0.12F, -0.32F}, 0.010F, detail));
  append(tap, make_rounded_box("", {-0.022F, 0.133F, -0.341F}, {0.022F, 0.141F, -0.329F}, 0.003F, detail.cells(2)));
  tap.name = "gas tap";
  add(scene, std::move(tap), looks.brass, at);

  Outline outer({0.0065F, 0.126F});
  outer.arc(0.0115F, 0.148F, 0.001F).arc(0, 0.196F, 0.004F);
  Outline inner({0.0055F, 0.126F});
  inner.arc(0, 0.158F, 0.002F);
  add(scene, make_lathe("flame", simplified(outer.points(), detail.cells(12, 5)), sides), looks.flame, at);
  add(scene, make_lathe("inner flame", simplified(inner.points(), detail.cells(7, 4)), sides), looks.inner_flame, at);

  constexpr float kTop = 0.198F;
  Mesh tripod = transformed(make_torus("", 0.06F, 0.004F, sides, detail.cells(8, 4)), placed({0, kTop - 0.004F, 0}));
  for (int leg = 0; leg < 3; ++leg) {
    const glm::vec2 way = on_circle(leg / 3.0 + 0.08);
    append(tripod,
           rod({0.095F * way.x, 0, 0.095F * way.y}, {0.06F * way.x, kTop - 0.004F, 0.06F * way.y}, 0.004F, detail));
  }
  tripod.name = "tripod";
  add(scene, std::move(tripod), looks.iron, at);
  // The gauze is woven: two layers of wire.
  Mesh gauze;
  const std::uint32_t wires = detail.cells(16, 6);
  for (std::uint32_t k = 0; k <= wires; ++k) {
    const float across = 0.128F * (static_cast<float>(k) / static_cast<float>(wires) - 0.5F);
    const std::array thin{0.0011F};
    const std::array one{glm::vec3(across, kTop + 0.0015F, -0.064F), glm::vec3(across, kTop + 0.0015F, 0.064F)};
    const std::array other{glm::vec3(-0.064F, kTop + 0.003F, across), glm::vec3(0.064F, kTop + 0.003F, across)};
    append(gauze, make_tube("", one, thin, 4));
    append(gauze, make_tube("", other, thin, 4));
  }
  gauze.name = "gauze";
  add(scene, std::move(gauze), looks.steel, at);
}

void add_rack(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail) {
  const glm::mat4 at = placed(position);
  const std::uint32_t steps = detail.cells(2);
  Mesh rack = make_rounded_box("", {-0.135F, 0, -0.03F}, {0.135F, 0.018F, 0.03F}, 0.003F, steps);
  for (const float x : {-0.135F, 0.123F}) {
    append(rack, make_rounded_box("", {x, 0.018F, -0.028F}, {x + 0.012F, 0.115F, 0.028F}, 0.003F, steps));
  }
  // A shelf with holes: a strip on each side of the tubes, and bridges between them.
  for (const float y : {0.055F, 0.105F}) {
    for (const float z : {-0.026F, 0.0125F})
      append(rack, make_box("", {-0.123F, y, z}, {0.123F, y + 0.009F, z + 0.0135F}, 1, 4));
    for (int k = 0; k < 7; ++k) {
      const float x = -0.120F + 0.040F * static_cast<float>(k);
      append(rack, make_box("", {x - 0.008F, y, -0.0125F}, {x + 0.008F, y + 0.009F, 0.0125F}, 1, 4));
    }
  }
  rack.name = "rack";
  for (std::size_t k = 0; k < rack.uvs.size(); ++k)
    rack.uvs[k] = {2 * rack.positions[k].x, 3 * (rack.positions[k].y + rack.positions[k].z)};
  add(scene, std::move(rack), looks.wood, at);
}

void add_stirrer(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail) {
  const glm::mat4 at = placed(position);
  add(scene, make_rounded_box("stirrer", {-0.075F, 0.004F, -0.08F}, {0.075F, 0.046F, 0.095F}, 0.008F, detail.cells(3)),
      looks.plastic, at);
  const Outline plate =
      Outline({0, 0.046F}).line(0.062F, 0.046F).line(0.062F, 0.052F).line(0.059F, 0.055F).line(0, 0.055F);
  add(scene, make_lathe("plate", plate.points(), detail.cells(36, 10)), looks.steel, at);
  const Outline knob = Outline({0, 0}).line(0.014F, 0).line(0.012F, 0.012F).line(0, 0.013F);
  for (const float x : {-0.035F, 0.035F}) {
    const glm::mat4 front(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0),
                          glm::vec4(x, 0.026F, 0.095F, 1));
    add(scene, make_lathe("knob", knob.points(), detail.cells(18, 6)), looks.iron, at * front);
  }
}

void add_mortar(Scene& scene, const Looks& looks, const glm::vec3& position, const Detail& detail) {
  Outline bowl({0, 0});
  bowl.line(0.026F, 0)
      .arc(0.022F, 0.010F, -0.001F)
      .arc(0.050F, 0.056F, 0.009F)
      .line(0.048F, 0.060F)
      .line(0.044F, 0.058F);
  bowl.arc(0, 0.016F, -0.017F);
  add(scene, make_lathe("mortar", simplified(bowl.points(), detail.cells(20, 9)), detail.cells(36, 10)),
      looks.porcelain, placed(position));
  const std::vector<glm::vec3> path{
      {0.008F, 0.026F, 0}, {0.0F, 0.034F, 0}, {-0.014F, 0.048F, 0}, {-0.05F, 0.085F, 0.005F}, {-0.075F, 0.11F, 0.008F}};
  const std::array radii{0.0F, 0.012F, 0.010F, 0.007F, 0.008F};
  add(scene, make_tube("pestle", path, radii, detail.cells(16, 6)), looks.porcelain, placed(position));
}

void add_notebook(Scene& scene, const Looks& looks, const glm::vec3& position, double turns, const Detail& detail) {
  const glm::mat4 at = placed(position, turns);
  add(scene, make_rounded_box("cover", {-0.155F, 0, -0.105F}, {0.155F, 0.006F, 0.105F}, 0.002F, detail.cells(2)),
      looks.iron, at);
  for (const float side : {-1.0F, 1.0F}) {
    // A page that rises towards the fold.
    add(scene,
        make_surface("page", detail.cells(10, 3), 2,
                     [side](float s, float t) {
                       const float out = side > 0 ? s : 1 - s;
                       return glm::vec3(side * (0.001F + 0.148F * out),
                                        0.007F + 0.012F * (1 - out) * (1 - out) * (0.3F + 2 * out), 0.1F - 0.2F * t);
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
  add(scene, make_tube("pen", pen, radii, detail.cells(12, 5)), looks.rubber, at);
}

}  // namespace traces::laboratory
