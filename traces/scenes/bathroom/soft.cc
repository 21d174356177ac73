#include <array>
#include <cmath>

#include "traces/scenes/bathroom/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::bathroom {
namespace {

/// Makes a towel over a rail along x at the origin, with soft waves: `front` is its length on the side of +z, `back` on
/// the other side. It is two sheets joined at the hems.
Mesh make_towel(const Detail& detail, float width, float front, float back, float radius, std::uint32_t seed) {
  constexpr float kThick = 0.007F, kQuarter = 1.5708F;
  const float over = 2 * kQuarter * radius, length = front + over + back;
  const auto on_sheet = [=](float s, float t, float lift) {
    const float at = t * length;
    const float r = radius + lift;
    glm::vec2 p;  // (z, y)
    float down = 0;
    if (at < front) {
      down = front - at;
      p = {r, -down};
    } else if (at < front + over) {
      const glm::vec2 round = on_circle(static_cast<double>((at - front) / over) * 0.5);
      p = r * round;
    } else {
      down = at - front - over;
      p = {-r, -down};
    }
    const float loose = down / (down + 0.15F);
    const float wave = 0.016F * sin_turns(static_cast<double>(2.3F * s + 0.1F * static_cast<float>(seed))) +
                       0.012F * (noise(s * 0.99F, down, 4, seed) - 0.5F);
    const float narrow = 1 - 0.05F * loose * noise(0.3F, down, 3, seed + 1);
    return glm::vec3((s - 0.5F) * width * narrow, p.y + 0.006F * loose * wave / 0.016F,
                     p.x + (p.x > 0 ? std::max(wave, -0.2F * radius) : -std::max(wave, -0.2F * radius)) * loose);
  };
  const std::uint32_t columns = detail.cells(34, 8), rows = detail.cells(64, 16);
  Mesh mesh = make_surface("towel", columns, rows, [&](float s, float t) {
    const float hem = std::min(1.0F, 20 * std::min(std::min(s, 1 - s), std::min(t, 1 - t)));
    return on_sheet(s, t, kThick * hem);
  });
  append(mesh, make_surface("", columns, rows, [&](float s, float t) { return on_sheet(1 - s, t, 0); }));
  // Fringes along the front hem.
  const std::uint32_t threads = detail.pieces(static_cast<std::uint32_t>(170 * width), 10);
  for (std::uint32_t k = 0; k < threads; ++k) {
    const float s = (static_cast<float>(k) + 0.5F) / static_cast<float>(threads);
    const glm::vec3 top = on_sheet(s, 0, 0.002F);
    const auto stray = [&](std::uint32_t what) { return 0.008F * (random(seed, k, what) - 0.5F); };
    const glm::vec3 path[] = {top, top + glm::vec3(stray(0), -0.018F, stray(1)),
                              top + glm::vec3(stray(2), -0.04F, stray(3))};
    append(mesh, make_tube("", path, std::array{0.0012F, 0.0011F, 0.0F}, 3));
  }
  return mesh;
}

}  // namespace

void add_towels(Scene& scene, const Materials& is, const Detail& detail) {
  constexpr float back = -kHalfWidth + 0.075F;
  add_object(scene, transformed(make_towel(detail, 0.42F, 0.62F, 0.45F, 0.012F, 3), placed({-0.73F, 1.52F, back})),
             is.towel);
  add_object(scene, transformed(make_towel(detail, 0.3F, 0.44F, 0.32F, 0.012F, 7), placed({-0.3F, 1.52F, back})),
             is.striped);
  const float y = 0.4F + 0.058F * 17;
  add_object(
      scene,
      transformed(make_towel(detail, 0.38F, 0.5F, 0.4F, 0.012F, 12), placed({kHalfLength - 0.075F, y, -0.54F}, -0.25)),
      is.striped);
}

/// Adds a mat of tufts on the floor at the tub.
void add_mat(Scene& scene, const Materials& is, const Detail& detail) {
  constexpr float kLength = 0.8F, kDepth = 0.5F, kLow = 0.012F;
  Mesh mat = make_rounded_box("bath mat", {-kLength / 2, 0.004F, -kDepth / 2}, {kLength / 2, kLow, kDepth / 2}, 0.0035F,
                              detail.cells(2));
  const std::uint32_t columns = detail.cells(104, 16), rows = detail.cells(64, 10);
  const float thick = 0.45F * kLength / static_cast<float>(columns);
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const auto stray = [&](std::uint32_t what) { return random(i, j, what) - 0.5F; };
      const glm::vec3 root(
          kLength * ((static_cast<float>(i) + 0.5F + 0.6F * stray(0)) / static_cast<float>(columns) - 0.5F),
          kLow - 0.001F, kDepth * ((static_cast<float>(j) + 0.5F + 0.6F * stray(1)) / static_cast<float>(rows) - 0.5F));
      const glm::vec3 tip = root + glm::vec3(0.014F * stray(2), 0.022F + 0.008F * stray(3), 0.014F * stray(4));
      append(mat, make_tube("", std::array{root, tip}, std::array{thick, 0.0F}, 3));
    }
  }
  add_object(scene, transformed(std::move(mat), placed({-0.72F, 0, -0.35F}, 0.015)), is.mat);
}

}  // namespace traces::bathroom
