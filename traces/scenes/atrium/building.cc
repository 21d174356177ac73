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

constexpr float kOuterX = kHalfLength + kGallery, kOuterZ = kHalfWidth + kGallery;

/// Makes a strip of an arch between two points (radius, z) of its section.
Mesh make_arch_strip(const glm::vec2& from, const glm::vec2& to, std::uint32_t cells) {
  return make_surface("", cells, 1, [&](float s, float t) {
    const glm::vec2 ring = t < 0.5F ? from : to;
    const glm::vec2 p = ring.x * on_circle(s == 1 ? 0.5 : 0.5 * static_cast<double>(s));
    return glm::vec3(p, ring.y);
  });
}

/// Makes one bay of wall above the springing line (y = 0 here) with its round arch; its face is at z = kWall / 2.
Mesh make_arch_wall(float width, float radius, float height, const Detail& detail) {
  const std::uint32_t cells = detail.cells(16, 4);
  constexpr float kHalf = kWall / 2;
  Mesh mesh;
  mesh.name = "arch wall";
  for (const float side : {-1.0F, 1.0F}) {
    Mesh face = make_surface("", cells, 1, [&](float s, float t) {
      const glm::vec2 p = radius * on_circle(s == 1 ? 0.5 : 0.5 * static_cast<double>(s));
      return glm::vec3(-side * p.x, t < 0.5F ? p.y : height, side * kHalf);
    });
    append(mesh, face);
    for (const float end : {-1.0F, 1.0F}) {
      const float inner = end * radius, outer = end * width / 2;
      const float left = std::min(inner, outer), wide = width / 2 - radius;
      if (side > 0) append(mesh, make_quad("", {left, 0, kHalf}, {wide, 0, 0}, {0, height, 0}, 1));
      if (side < 0) append(mesh, make_quad("", {left + wide, 0, -kHalf}, {-wide, 0, 0}, {0, height, 0}, 1));
    }
  }
  append(mesh, make_arch_strip({radius, kHalf}, {radius, -kHalf}, cells));
  for (const float end : {-1.0F, 1.0F}) {  // undersides, above the columns
    const float left = end < 0 ? -width / 2 : radius;
    append(mesh, make_quad("", {left, 0, -kHalf}, {width / 2 - radius, 0, 0}, {0, 0, kWall}, 1));
  }
  project_uvs(mesh, 0.42F);
  return mesh;
}

/// Makes the moulding round the arch on both faces, and its keystones.
Mesh make_archivolt(float radius, const Detail& detail) {
  constexpr float z = kWall / 2;
  const glm::vec2 section[] = {{radius - 0.004F, z - 0.06F}, {radius - 0.004F, z + 0.06F}, {radius + 0.1F, z + 0.06F},
                               {radius + 0.12F, z + 0.035F}, {radius + 0.17F, z + 0.035F}, {radius + 0.19F, z - 0.01F}};
  const std::uint32_t cells = detail.cells(16, 4);
  Mesh mesh;
  mesh.name = "archivolt";
  const std::vector<glm::vec2> points = detail.profile(section);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Mesh strip = make_arch_strip(points[k + 1], points[k], cells);
    append(mesh, strip);
    append(mesh, transformed(strip, placed(glm::vec3(0), 0.5)));
  }
  const glm::vec2 key[] = {
      {-0.09F, radius - 0.03F}, {0.09F, radius - 0.03F}, {0.13F, radius + 0.3F}, {-0.13F, radius + 0.3F}};
  append(mesh, transformed(make_extrusion("", key, kWall + 0.18F), placed({0, 0, -kWall / 2 - 0.09F})));
  project_uvs(mesh, 0.6F);
  return mesh;
}

/// Makes a cornice along x, from -half to half, its back at z = 0.
Mesh make_cornice(float half, std::span<const glm::vec2> outline) {
  const glm::mat4 along{{0, 0, 1, 0}, {0, 1, 0, 0}, {-1, 0, 0, 0}, {half, 0, 0, 1}};
  Mesh mesh = transformed(make_extrusion("cornice", outline, 2 * half), along);
  project_uvs(mesh, 0.6F);
  return mesh;
}

void add_slabs(Scene& scene, std::uint32_t material, float low, float high, float rim) {
  // Four boards round the court; `rim` is how far they project into it.
  const float x = kHalfLength - rim, z = kHalfWidth - rim;
  const std::array<std::array<float, 4>, 4> areas = {
      {{-kOuterX, kOuterX, -kOuterZ, -z}, {-kOuterX, kOuterX, z, kOuterZ}, {-kOuterX, -x, -z, z}, {x, kOuterX, -z, z}}};
  for (const auto& [x0, x1, z0, z1] : areas) {
    Mesh slab = make_box("slab", {x0, low, z0}, {x1, high, z1});
    project_uvs(slab, 0.45F);
    add_object(scene, std::move(slab), material);
  }
}

void add_door(Scene& scene, const Materials& is, const Detail& detail, const glm::mat4& wall) {
  const glm::vec2 leaf[] = {{0, 0}, {0, 0.05F}, {0.09F, 0.05F}, {0.11F, 0.025F}, {0.14F, 0.025F}, {0.18F, 0.045F}};
  Mesh door;
  door.name = "door";
  for (const float x : {-0.62F, 0.0F}) {
    for (const auto& [low, high] : {std::pair{0.0F, 1.0F}, std::pair{1.0F, 2.3F}}) {
      append(door, transformed(make_panel("", 0.62F, high - low, detail.profile(leaf), detail.cells(1)),
                               wall * placed({x, low, 0})));
    }
  }
  project_uvs(door, 0.8F, true);
  add_object(scene, std::move(door), is.wood);
  Mesh frame;
  frame.name = "door frame";
  for (const float x : {-0.82F, 0.62F}) append(frame, make_box("", {x, 0, 0}, {x + 0.2F, 2.3F, 0.12F}));
  append(frame, make_box("", {-0.92F, 2.3F, 0}, {0.92F, 2.52F, 0.15F}));
  append(frame, make_box("", {-0.98F, 2.52F, 0}, {0.98F, 2.6F, 0.22F}));
  frame = transformed(std::move(frame), wall);
  project_uvs(frame, 0.6F);
  add_object(scene, std::move(frame), is.stone);
}

}  // namespace

void add_walls(Scene& scene, const Materials& is, const Detail& detail) {
  Mesh floor = make_quad("floor", {-kOuterX, 0, -kOuterZ}, {0, 0, 2 * kOuterZ}, {2 * kOuterX, 0, 0}, detail.cells(12));
  project_uvs(floor, 0.25F);
  add_object(scene, std::move(floor), is.floor);
  const auto add_outer = [&](const glm::vec3& origin, const glm::vec3& outward, float width) {
    Mesh wall = transformed(make_quad("outer wall", glm::vec3(0), {width, 0, 0}, {0, kTop, 0}, detail.cells(8)),
                            standing(origin, outward));
    project_uvs(wall, 0.7F);
    add_object(scene, std::move(wall), is.brick);
  };
  add_outer({-kOuterX, 0, -kOuterZ}, {0, 0, 1}, 2 * kOuterX);
  add_outer({kOuterX, 0, kOuterZ}, {0, 0, -1}, 2 * kOuterX);
  add_outer({kOuterX, 0, -kOuterZ}, {-1, 0, 0}, 2 * kOuterZ);
  add_outer({-kOuterX, 0, kOuterZ}, {1, 0, 0}, 2 * kOuterZ);
  add_slabs(scene, is.plaster, kUpper - 0.2F, kUpper - 0.001F, 0.25F);
  add_slabs(scene, is.stone, kUpper - 0.001F, kUpper, 0.4F);
  add_slabs(scene, is.wood, kTop, kTop + 0.25F, 0.7F);
  int count = 0;
  for_each_bay([&](const glm::vec3& middle, const glm::vec3& inward, float) {
    const glm::vec3 foot = middle - (kGallery - 0.001F) * inward;
    for (const float y : {0.0F, kUpper}) {
      if (count++ % 3 != 1) add_door(scene, is, detail, standing(foot + glm::vec3(0, y, 0), inward));
    }
    // Beams below both ceilings.
    for (const float y : {kUpper - 0.2F, kTop}) {
      Mesh beam = transformed(make_box("beam", {-0.1F, -0.2F, 0}, {0.1F, 0, kGallery - 0.2F}),
                              standing(foot + glm::vec3(0, y, 0), inward));
      project_uvs(beam, 0.8F);
      add_object(scene, std::move(beam), is.wood);
    }
  });
}

void add_arcades(Scene& scene, const Materials& is, const Detail& detail) {
  struct Kind {
    std::uint32_t wall, archivolt;
  };
  const auto make_kind = [&](float bay, float height) {
    const float radius = 0.5F * bay - 0.3F;
    return Kind{add_mesh(scene, make_arch_wall(bay, radius, height, detail), is.ashlar),
                add_mesh(scene, make_archivolt(radius, detail), is.light_stone)};
  };
  const Kind long_low = make_kind(kLongBay, kUpper - 0.2F - kSpring),
             short_low = make_kind(kShortBay, kUpper - 0.2F - kSpring);
  const Kind long_high = make_kind(kLongBay, kTop - kUpperSpring),
             short_high = make_kind(kShortBay, kTop - kUpperSpring);
  for_each_bay([&](const glm::vec3& middle, const glm::vec3& inward, float width) {
    const bool is_long = width > 2.7F;
    const Kind& low = is_long ? long_low : short_low;
    const Kind& high = is_long ? long_high : short_high;
    for (const auto& [kind, y] : {std::pair{low, kSpring}, std::pair{high, kUpperSpring}}) {
      const glm::mat4 at = standing(middle + glm::vec3(0, y, 0), inward);
      add_instance(scene, kind.wall, at);
      add_instance(scene, kind.archivolt, at);
    }
  });
  const glm::vec2 string_course[] = {{0, 0},         {0.04F, 0},    {0.06F, 0.05F}, {0.12F, 0.08F},
                                     {0.15F, 0.15F}, {0.15F, 0.2F}, {0, 0.2F}};
  const glm::vec2 crown[] = {{0, 0},         {0.06F, 0},     {0.1F, 0.08F},  {0.2F, 0.12F},
                             {0.26F, 0.24F}, {0.32F, 0.26F}, {0.32F, 0.34F}, {0, 0.34F}};
  Mesh dentils;
  dentils.name = "dentils";
  for (const auto& [outline, y] :
       {std::pair<std::span<const glm::vec2>, float>{string_course, kUpper - 0.21F}, {crown, kTop - 0.35F}}) {
    for (const float side : {-1.0F, 1.0F}) {
      const glm::mat4 long_side = standing({0, y, side * (kHalfWidth - kWall / 2)}, {0, 0, -side});
      const glm::mat4 short_side = standing({side * (kHalfLength - kWall / 2), y, 0}, {-side, 0, 0});
      add_object(scene, transformed(make_cornice(kHalfLength - kWall / 2, outline), long_side), is.light_stone);
      add_object(scene, transformed(make_cornice(kHalfWidth - kWall / 2, outline), short_side), is.light_stone);
      if (y < kTop - 1) continue;
      const Mesh dentil = make_box("", {-0.07F, -0.16F, 0}, {0.07F, 0, 0.1F});
      for (int k = -21; k <= 21; ++k)
        append(dentils, transformed(dentil, long_side * placed({0.4F * static_cast<float>(k), 0, 0})));
      for (int k = -8; k <= 8; ++k)
        append(dentils, transformed(dentil, short_side * placed({0.4F * static_cast<float>(k), 0, 0})));
    }
  }
  add_object(scene, std::move(dentils), is.light_stone);
}

}  // namespace traces::atrium
