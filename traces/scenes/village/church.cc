#include <algorithm>

#include <glm/geometric.hpp>

#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"
#include "traces/scenes/village/houses.h"

namespace traces::village {
namespace {

constexpr float kTower = 5.4F, kTowerTop = 17.5F, kSpireTop = 30;
constexpr float kTowerZ = 11;  // the nave's front is at 9.5

void add_arch_window(Parts& parts, const Paints& p, const glm::mat4& at, float width, float height) {
  const glm::mat4 back = at * placed({0, 0, -0.04F});
  parts.add(p.stone, make_arch(width + 0.36F, height + 0.2F, 0.12F, 10), back);
  parts.add(p.glass, make_arch(width, height, 0.14F, 10), back);
  parts.box(p.timber, at, {-0.03F, 0, 0.05F}, {0.03F, height - 0.1F, 0.13F});
  for (const float y : {0.3F, 0.6F}) {
    parts.box(p.timber, at, {-width / 2, y * height - 0.03F, 0.05F}, {width / 2, y * height + 0.03F, 0.13F});
  }
  parts.box(p.stone, at, {-width / 2 - 0.3F, -0.16F, -0.1F}, {width / 2 + 0.3F, 0, 0.25F});
}

void add_nave(Parts& parts, const Paints& p, const HouseShape& nave) {
  for (const double turns : {0.0, 0.5}) {
    for (int k = 0; k < 5; ++k) {
      const float x = 3.7F * static_cast<float>(k - 2);
      if (k < 4) add_arch_window(parts, p, wall_frame(turns, nave.width / 2, x + 1.85F, 1.5F), 1.3F, 3.9F);
      const glm::mat4 at = wall_frame(turns, nave.width / 2, x);
      parts.box(p.stone, at, {-0.35F, -1, -0.1F}, {0.35F, 2.6F, 0.95F});
      parts.box(p.stone, at, {-0.3F, 2.6F, -0.1F}, {0.3F, nave.eaves - 0.6F, 0.5F});
    }
  }
  const glm::vec2 apse[] = {{3.3F, -1}, {3.3F, 4.9F}, {3.55F, 4.9F}, {3.55F, 5.1F}, {0, 7.6F}};
  Mesh round = make_lathe("", std::span(apse).first(3), 32);
  scale_uvs(round, {20, 4});
  parts.add(p.wall, round, placed({0, 0, -nave.length / 2}));
  Mesh cone = make_lathe("", std::span(apse).subspan(2), 32);
  scale_uvs(cone, {20, 4});
  parts.add(p.roof, cone, placed({0, 0, -nave.length / 2}));
  for (const double turns : {0.15, 0.25, 0.35}) {
    add_arch_window(parts, p, placed({0, 0, -nave.length / 2}) * wall_frame(turns, 3.3F, 0, 1.6F), 0.8F, 2.5F);
  }
}

void add_clock(Parts& parts, const glm::mat4& at, std::uint32_t white, std::uint32_t gold, std::uint32_t dark) {
  const glm::mat4 face =
      at * glm::mat4(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0), glm::vec4(0, 0, 0, 1));
  parts.add(gold, make_cylinder("", 1.15F, 0.1F, 40), face);
  parts.add(white, make_cylinder("", 1.02F, 0.13F, 40), face);
  for (int k = 0; k < 12; ++k) {
    const glm::vec2 round = on_circle(k / 12.0) * 0.86F;
    parts.add(dark,
              transformed(make_box("", {-0.05F, -0.09F, 0}, {0.05F, 0.09F, 0.16F}), placed({round.x, round.y, 0})), at);
  }
  parts.box(dark, at, {-0.04F, -0.15F, 0}, {0.04F, 0.8F, 0.18F});
  parts.box(dark, at, {-0.55F, -0.05F, 0}, {0.15F, 0.05F, 0.2F});
}

void add_tower(Parts& parts, const Paints& p, std::uint32_t white, std::uint32_t gold) {
  const float w = kTower / 2;
  const glm::mat4 foot = placed({0, 0, kTowerZ});
  for (int side = 0; side < 4; ++side) {
    const glm::mat4 at = foot * wall_frame(side / 4.0, w);
    parts.panel(p.wall, at, {-w, -1, 0}, {kTower, 0, 0}, {0, kTowerTop + 1, 0});
    for (int k = 0; k < 22; ++k) {  // corner stones, alternately long and short
      const float y = 0.8F * static_cast<float>(k) - 0.4F;
      const float reach = (k + side) % 2 == 0 ? 0.75F : 0.45F;
      parts.box(p.stone, at, {-w - 0.05F, y, -0.2F}, {-w + reach, y + 0.74F, 0.05F});
      parts.box(p.stone, at, {w - (1.2F - reach), y, -0.2F}, {w + 0.04F, y + 0.74F, 0.045F});
    }
    for (const float x : {-0.95F, 0.95F}) {
      const glm::mat4 opening = at * placed({x, 12.9F, -0.03F});
      parts.add(p.stone, make_arch(1.5F, 3.6F, 0.1F, 8), opening * placed({0, -0.15F, 0}));
      parts.add(p.timber, make_arch(1.15F, 3.3F, 0.12F, 8), opening);
      for (int k = 0; k < 9; ++k) {
        const float y = 0.1F + 0.3F * static_cast<float>(k);
        parts.box(p.door, opening, {-0.52F, y, 0.1F}, {0.52F, y + 0.1F, 0.22F});
      }
    }
    for (const float y : {6.2F, 12.3F, kTowerTop - 0.35F}) {
      parts.box(p.stone, at, {-w - 0.15F, y, -0.2F}, {w + 0.15F, y + 0.35F, 0.16F});
    }
    add_clock(parts, at * placed({0, 10.2F, 0}), white, gold, p.timber);
    if (side % 2 == 0) add_arch_window(parts, p, at * placed({0, 3, 0}), 0.7F, 2);
    // The spire's eight sides: the transition from square to octagon is simplified to two slopes.
    for (int part = 0; part < 2; ++part) {
      const float low = part == 0 ? w + 0.35F : w * 0.62F, high = part == 0 ? w * 0.62F : 0.12F;
      const float from = part == 0 ? kTowerTop : kTowerTop + 2.6F, to = part == 0 ? kTowerTop + 2.6F : kSpireTop;
      Mesh slope = make_surface("", 1, part == 0 ? 3 : 8, [&](float s, float t) {
        const float out = low + (high - low) * t;
        return glm::vec3((2 * s - 1) * out, from + (to - from) * t, out);
      });
      for (std::size_t i = 0; i < slope.uvs.size(); ++i) slope.uvs[i] = {slope.positions[i].x, -slope.positions[i].y};
      parts.add(p.roof, slope, foot * placed({0, 0, 0}, side / 4.0));
    }
  }
  parts.box(p.stone, foot, {-w - 0.3F, kTowerTop - 0.05F, -w - 0.3F}, {w + 0.3F, kTowerTop, w + 0.3F});
  parts.add(gold, make_sphere("", {0, kSpireTop + 0.2F, 0}, 0.32F, 6), foot);
  parts.box(gold, foot, {-0.06F, kSpireTop, -0.06F}, {0.06F, kSpireTop + 2.6F, 0.06F});
  parts.box(gold, foot, {-0.75F, kSpireTop + 1.6F, -0.06F}, {0.75F, kSpireTop + 1.75F, 0.06F});
  const glm::mat4 porch = foot * wall_frame(0.75, w);
  parts.add(p.stone, make_arch(2.9F, 4.4F, 0.5F, 12), porch * placed({0, -0.2F, 0}));
  parts.add(p.door, make_arch(1.9F, 3.5F, 0.54F, 12), porch);
  parts.box(p.timber, porch, {-0.03F, 0, 0.5F}, {0.03F, 3.3F, 0.57F});
  for (const float s : {-1.0F, 1.0F}) {
    for (const float y : {0.7F, 2.1F}) {
      parts.box(p.timber, porch, {std::min(0.1F * s, 0.85F * s), y, 0.5F},
                {std::max(0.1F * s, 0.85F * s), y + 0.1F, 0.57F});
    }
  }
  for (int k = 0; k < 4; ++k) {
    const float out = 1 + 0.45F * static_cast<float>(k), y = -0.02F - 0.2F * static_cast<float>(k);
    parts.box(p.stone, porch, {-1.8F - out * 0.3F, -2, 0.01F}, {1.8F + out * 0.3F, y, out});
  }
}

}  // namespace

Building add_church(Scene& scene, const Paints& p, std::uint32_t white, std::uint32_t gold, float detail) {
  Parts parts;
  const HouseShape nave{.width = 9.5F, .length = 19, .eaves = 6.3F, .ridge = 12};
  add_walls(parts, p.wall, nave);
  add_roof(parts, p.roof, p.timber, nave, 0.8F * detail);
  parts.box(p.stone, glm::mat4(1), {-4.9F, -1, -9.65F}, {4.9F, 0.6F, 9.65F});
  add_nave(parts, p, nave);
  add_tower(parts, p, white, gold);
  return parts.take(scene, "church");
}

}  // namespace traces::village
