#include <algorithm>
#include <array>
#include <vector>

#include "traces/scenes/atrium/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::atrium {
namespace {

/// Makes a column: Attic base, slightly swelling shaft, bell with two rings of leaves, abacus. `radius`: at the foot.
Mesh make_column(float height, float radius, const Detail& detail) {
  const std::uint32_t round = detail.cells(18, 6);
  const float r = radius;
  Mesh mesh = make_box("column", {-1.45F * r, 0, -1.45F * r}, {1.45F * r, 0.45F * r, 1.45F * r});
  const glm::vec2 base[] = {{1.3F * r, 0.45F * r},  {1.42F * r, 0.58F * r}, {1.3F * r, 0.72F * r},
                            {1.12F * r, 0.8F * r},  {1.14F * r, 0.9F * r},  {1.24F * r, 0.98F * r},
                            {1.14F * r, 1.08F * r}, {1.02F * r, 1.12F * r}, {r, 1.2F * r}};
  append(mesh, make_lathe("", detail.profile(base), round));
  const float neck = height - 2.3F * r;
  const glm::vec2 shaft[] = {{r, 1.2F * r}, {0.99F * r, 0.4F * neck}, {0.93F * r, 0.75F * neck}, {0.85F * r, neck}};
  append(mesh, make_lathe("", smoothed(detail.profile(shaft), detail.cells(2)), round));
  const glm::vec2 bell[] = {{0.85F * r, neck},
                            {0.98F * r, neck + 0.05F * r},
                            {0.98F * r, neck + 0.15F * r},
                            {0.86F * r, neck + 0.2F * r},
                            {0.9F * r, neck + 1.0F * r},
                            {1.15F * r, neck + 1.7F * r},
                            {1.3F * r, neck + 1.85F * r}};
  append(mesh, make_lathe("", detail.profile(bell), round));
  for (int ring = 0; ring < 2; ++ring) {
    for (int k = 0; k < 8; ++k) {
      const glm::vec2 way = on_circle((k + 0.5 * ring) / 8.0);
      const float y = neck + (0.2F + 0.65F * static_cast<float>(ring)) * r;
      add_leaf(mesh, {0.88F * r * way.x, y, 0.88F * r * way.y},
               glm::normalize(glm::vec3(0.35F * way.x, 1, 0.35F * way.y)), 1.05F * r, 0.42F * r, 0.22F,
               detail.cells(4, 2));
    }
  }
  append(mesh, make_box("", {-1.4F * r, neck + 1.85F * r, -1.4F * r}, {1.4F * r, neck + 2.1F * r, 1.4F * r}));
  append(mesh, make_box("", {-1.5F * r, neck + 2.1F * r, -1.5F * r}, {1.5F * r, height, 1.5F * r}));
  project_uvs(mesh, 0.8F);
  return mesh;
}

/// Makes a pier for the corners, where two arcades meet.
Mesh make_pier(float height) {
  constexpr float a = 0.32F;
  Mesh mesh = make_box("pier", {-a, 0, -a}, {a, height, a});
  append(mesh, make_box("", {-a - 0.06F, 0, -a - 0.06F}, {a + 0.06F, 0.3F, a + 0.06F}));
  append(mesh, make_box("", {-a - 0.05F, height - 0.2F, -a - 0.05F}, {a + 0.05F, height, a + 0.05F}));
  project_uvs(mesh, 0.6F);
  return mesh;
}

}  // namespace

void add_columns(Scene& scene, const Materials& is, const Detail& detail) {
  const std::uint32_t low = add_mesh(scene, make_column(kSpring, 0.2F, detail), is.stone);
  const std::uint32_t high = add_mesh(scene, make_column(kUpperSpring - kUpper, 0.155F, detail), is.stone);
  const std::uint32_t low_pier = add_mesh(scene, make_pier(kUpper - 0.2F), is.ashlar);
  const std::uint32_t high_pier = add_mesh(scene, make_pier(kTop - kUpper), is.ashlar);
  for (const float side : {-1.0F, 1.0F}) {
    const auto add_pair = [&](const glm::vec3& at, bool is_pier) {
      add_instance(scene, is_pier ? low_pier : low, placed(at));
      add_instance(scene, is_pier ? high_pier : high, placed(at + glm::vec3(0, kUpper, 0)));
    };
    for (int k = 0; k <= kLongBays; ++k) {
      add_pair({kLongBay * static_cast<float>(k) - kHalfLength, 0, side * kHalfWidth}, k == 0 || k == kLongBays);
    }
    for (int k = 1; k < kShortBays; ++k)
      add_pair({side * kHalfLength, 0, kShortBay * static_cast<float>(k) - kHalfWidth}, false);
  }
}

void add_balustrades(Scene& scene, const Materials& is, const Detail& detail) {
  const glm::vec2 shape[] = {{0.06F, 0.12F},  {0.06F, 0.16F}, {0.035F, 0.2F}, {0.075F, 0.34F}, {0.05F, 0.52F},
                             {0.032F, 0.64F}, {0.04F, 0.72F}, {0.06F, 0.76F}, {0.06F, 0.8F}};
  const Mesh baluster = make_lathe("", detail.profile(shape), detail.cells(8, 4));
  const auto make_bay = [&](float bay) {
    const float half = bay / 2 - 0.23F;
    Mesh mesh = make_box("balustrade", {-half, 0, -0.1F}, {half, 0.12F, 0.1F});
    append(mesh, make_box("", {-half, 0.8F, -0.09F}, {half, 0.86F, 0.09F}));
    append(mesh, make_box("", {-half, 0.86F, -0.12F}, {half, 0.94F, 0.12F}));
    const std::uint32_t count = std::min(detail.cells(bay > 2.7F ? 9 : 7, 4), bay > 2.7F ? 9U : 7U);
    for (std::uint32_t k = 0; k < count; ++k) {
      const float x = 2 * half * ((static_cast<float>(k) + 0.5F) / static_cast<float>(count) - 0.5F);
      append(mesh, transformed(baluster, placed({x, 0, 0})));
    }
    project_uvs(mesh, 0.8F);
    return add_mesh(scene, std::move(mesh), is.light_stone);
  };
  const std::uint32_t long_bay = make_bay(kLongBay), short_bay = make_bay(kShortBay);
  for_each_bay([&](const glm::vec3& middle, const glm::vec3& inward, float width) {
    add_instance(scene, width > 2.7F ? long_bay : short_bay, standing(middle + glm::vec3(0, kUpper, 0), inward));
  });
}

}  // namespace traces::atrium
