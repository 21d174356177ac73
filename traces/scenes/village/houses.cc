#include "traces/scenes/village/houses.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::village {
namespace {

constexpr float kBelow = 1;     // depth of the foundations
constexpr float kEave = 0.55F;  // overhang of the roof
constexpr float kThick = 0.16F;

void add_window(Parts& parts, const HouseMaterials& p, const glm::mat4& at, float width, float height, bool shutters) {
  const float w = width / 2, h = height;
  parts.add_panel(p.glass, at, {-w, 0, 0.015F}, {width, 0, 0}, {0, h, 0});
  for (const float s : {-1.0F, 1.0F}) {
    parts.add_box(p.timber, at, {std::min(s * w, s * (w + 0.09F)), -0.02F, -0.02F},
                  {std::max(s * w, s * (w + 0.09F)), h + 0.09F, 0.07F});
  }
  parts.add_box(p.timber, at, {-w, h, -0.02F}, {w, h + 0.09F, 0.07F});
  parts.add_box(p.timber, at, {-0.025F, 0, 0}, {0.025F, h, 0.045F});
  parts.add_box(p.timber, at, {-w, 0.62F * h, 0}, {w, 0.62F * h + 0.05F, 0.045F});
  parts.add_box(p.stone, at, {-w - 0.16F, -0.1F, -0.02F}, {w + 0.16F, -0.02F, 0.16F});
  if (!shutters) return;
  for (const float s : {-1.0F, 1.0F}) {
    const float a = s * (w + 0.1F), b = s * (2 * w + 0.06F);
    parts.add_box(p.shutter, at, {std::min(a, b), -0.02F, 0.01F}, {std::max(a, b), h + 0.06F, 0.05F});
    for (const float y : {0.12F, 0.8F}) {
      parts.add_box(p.shutter, at, {std::min(a, b) + 0.02F, y * h, 0.05F},
                    {std::max(a, b) - 0.02F, y * h + 0.07F, 0.075F});
    }
  }
}

void add_door(Parts& parts, const HouseMaterials& p, const glm::mat4& at, float width, float height) {
  const float w = width / 2;
  for (int k = 0; k < 5; ++k) {
    const float x = -w + width * static_cast<float>(k) / 5;
    parts.add_box(p.door, at, {x + 0.008F, 0, 0.0F}, {x + width / 5 - 0.008F, height, 0.05F});
  }
  for (const float s : {-1.0F, 1.0F}) {
    parts.add_box(p.timber, at, {s * (w + 0.07F) - 0.07F, -0.1F, -0.02F},
                  {s * (w + 0.07F) + 0.07F, height + 0.14F, 0.1F});
  }
  parts.add_box(p.timber, at, {-w, height, -0.02F}, {w, height + 0.14F, 0.1F});
  parts.add_box(p.stone, at, {-w - 0.3F, -kBelow, 0}, {w + 0.3F, -0.02F, 0.75F});
  parts.add_box(p.stone, at, {-w - 0.5F, -kBelow, 0.75F}, {w + 0.5F, -0.2F, 1.15F});
  parts.add_piece(p.shutter, make_sphere("", {0.36F * width, 0.48F * height, 0.09F}, 0.05F, 3), at);
}

/// Adds posts, rails and braces of timber to a wall from y = 0 to `height`.
void add_timber(Parts& parts, std::uint32_t timber, const glm::mat4& at, float length, float height,
                std::uint32_t storeys) {
  const float w = length / 2, storey = height / static_cast<float>(storeys);
  for (std::uint32_t k = 0; k <= storeys; ++k) {
    const float y = storey * static_cast<float>(k);
    parts.add_box(timber, at, {-w, y - 0.09F, -0.02F}, {w, y + 0.09F, 0.06F});
  }
  const auto bays = static_cast<std::uint32_t>(length / 2.1F) + 1;
  for (std::uint32_t k = 0; k <= bays; ++k) {
    const float x = -w + 0.09F + (length - 0.18F) * static_cast<float>(k) / static_cast<float>(bays);
    parts.add_box(timber, at, {x - 0.09F, 0, -0.02F}, {x + 0.09F, height, 0.05F});
  }
  const float bay = (length - 0.18F) / static_cast<float>(bays);
  for (std::uint32_t k = 0; k < storeys; ++k) {
    for (const float s : {-1.0F, 1.0F}) {
      // A brace from the corner's foot to the next post's head.
      const glm::vec3 foot(s * (w - 0.1F), storey * static_cast<float>(k) + 0.1F, 0);
      const glm::vec3 way(-s * bay * 0.92F, storey - 0.2F, 0);
      const glm::vec3 side = glm::normalize(glm::vec3(-way.y, way.x, 0)) * 0.075F;
      const glm::mat4 along(glm::vec4(side, 0), glm::vec4(way, 0), glm::vec4(0, 0, s * glm::length(side), 0),
                            glm::vec4(foot, 1));
      parts.add_piece(timber, transform_mesh(make_box("", {-1, 0, -0.2F}, {1, 1, 0.6F}), along), at);
    }
  }
}

void add_chimney(Parts& parts, const HouseMaterials& p, const HouseShape& s) {
  const glm::mat4 at = placement_at({s.width * 0.12F, 0, s.chimney * s.length});
  const float top = s.ridge + 1.15F;
  parts.add_box(p.stone, at, {-0.42F, s.eaves, -0.35F}, {0.42F, top, 0.35F});
  parts.add_box(p.stone, at, {-0.5F, top - 0.25F, -0.43F}, {0.5F, top - 0.1F, 0.43F});
  for (const float x : {-0.2F, 0.2F}) {
    parts.add_piece(p.roof, transform_mesh(make_cone("", 0.13F, 0.1F, 0.45F, 10), placement_at({x, top, 0})), at);
  }
}

void add_dormer(Parts& parts, const HouseMaterials& p, const HouseShape& s, double turns, float aside) {
  const float slope = (s.ridge - s.eaves) / (s.width / 2);
  const float floor = s.eaves + 0.25F * (s.ridge - s.eaves);
  const float out = s.width / 2 - (floor - s.eaves) / slope;
  const glm::mat4 at = wall_frame(turns, out, aside, floor);
  const float w = 0.75F, h = 1.05F, deep = h / slope + 0.6F, peak = 0.65F;
  parts.add_box(p.wall, at, {-w, -0.1F, -deep}, {w, h, 0});
  add_window(parts, p, at * placement_at({0, 0.2F, 0}), 0.8F, 0.75F, false);
  const glm::vec2 gable[] = {{-w - 0.2F, h - 0.13F}, {w + 0.2F, h - 0.13F}, {0, h + peak}};
  parts.add_piece(p.roof, transform_mesh(make_extrusion("", gable, deep + 0.9F), placement_at({0, 0, -deep - 0.7F})),
                  at);
}

}  // namespace

glm::mat4 wall_frame(double turns, float out, float aside, float up) {
  return placement_at({0, up, 0}, turns) * placement_at({out, 0, 0}, 0.25) * placement_at({aside, 0, 0});
}

void Parts::add_piece(std::uint32_t material, const Mesh& piece, const glm::mat4& at) {
  auto found = std::ranges::find(meshes_, material, &std::pair<std::uint32_t, Mesh>::first);
  if (found == meshes_.end()) found = meshes_.insert(meshes_.end(), {material, Mesh{}});
  append_mesh(found->second, transform_mesh(piece, at));
}

void Parts::add_box(std::uint32_t material, const glm::mat4& at, const glm::vec3& lower, const glm::vec3& upper) {
  Mesh mesh = make_box("", lower, upper);
  // On every vertical face, v is the height.
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p = mesh.positions[i], n = glm::abs(mesh.normals[i]);
    mesh.uvs[i] = n.y > 0.5F ? glm::vec2(p.x, p.z) : glm::vec2(n.x > 0.5F ? p.z : p.x, -p.y);
  }
  add_piece(material, mesh, at);
}

void Parts::add_panel(std::uint32_t material, const glm::mat4& at, const glm::vec3& corner, const glm::vec3& u,
                      const glm::vec3& v) {
  Mesh mesh = make_quad("", corner, u, v, 1);
  scale_uvs(mesh, {glm::length(u), -glm::length(v)});
  add_piece(material, mesh, at);
}

Building Parts::add_meshes_to_scene(Scene& scene, const std::string& name) const {
  Building building;
  for (const auto& [material, mesh] : meshes_) {
    Mesh named = mesh;
    named.name = name + ": " + scene.materials[material].name;
    building.push_back(add_mesh(scene, std::move(named), material));
  }
  return building;
}

void add_walls(Parts& parts, std::uint32_t wall, const HouseShape& s) {
  const float w = s.width / 2, l = s.length / 2;
  for (const double turns : {0.0, 0.5}) {
    parts.add_panel(wall, wall_frame(turns, w), {-l, -kBelow, 0}, {s.length, 0, 0}, {0, s.eaves + kBelow, 0});
    const glm::mat4 gable = wall_frame(turns + 0.25, l);
    parts.add_panel(wall, gable, {-w, -kBelow, 0}, {s.width, 0, 0}, {0, s.eaves + kBelow, 0});
    Mesh top;
    top.positions = {{-w, s.eaves, 0}, {w, s.eaves, 0}, {0, s.ridge, 0}};
    top.normals.assign(3, {0, 0, 1});
    top.uvs = {{-w, -s.eaves}, {w, -s.eaves}, {0, -s.ridge}};
    top.triangles = {{0, 1, 2}};
    parts.add_piece(wall, top, gable);
  }
}

void add_roof(Parts& parts, std::uint32_t roof, std::uint32_t timber, const HouseShape& s, float detail) {
  const float slope = (s.ridge - s.eaves) / (s.width / 2);
  const float run = s.width / 2 + kEave, rise = run * slope, reach = s.length + 2 * 0.45F;
  const float pitch = std::sqrt(run * run + rise * rise);
  const auto tiles = std::max(static_cast<std::uint32_t>(detail * reach / 0.42F), 6U);
  const auto courses = std::max(static_cast<std::uint32_t>(detail * pitch / 0.52F), 4U);
  const glm::vec3 normal = glm::normalize(glm::vec3(0, run, rise));
  for (const double turns : {0.0, 0.5}) {
    const glm::mat4 at = wall_frame(turns, 0);
    Mesh top = make_surface("", 2 * tiles, 2 * courses, [&](float u, float v) {
      const auto row = static_cast<std::uint32_t>(v * static_cast<float>(2 * courses) + 0.5F);
      const auto column = static_cast<std::uint32_t>(u * static_cast<float>(2 * tiles) + 0.5F);
      const float up = static_cast<float>((row + 1) / 2) / static_cast<float>(courses) - (row % 2 == 1 ? 0.003F : 0);
      const float lift = (row % 2 == 0 ? 0.07F : 0.0F) + (column % 2 == 0 ? 0.0F : 0.05F);
      return glm::vec3((u - 0.5F) * reach, s.ridge - rise + rise * up, run * (1 - up)) + normal * (kThick + lift);
    });
    scale_uvs(top, {reach, -pitch});
    parts.add_piece(roof, top, at);
    const glm::vec3 along(0, rise, -run);
    parts.add_panel(timber, at, {reach / 2, s.ridge - rise, run}, {-reach, 0, 0}, along);
    parts.add_panel(timber, at, glm::vec3(-reach / 2, s.ridge - rise, run), {reach, 0, 0}, normal * (kThick + 0.07F));
    for (const float side : {-1.0F, 1.0F}) {
      const glm::vec3 foot(side * reach / 2, s.ridge - rise, run);
      const glm::mat4 board(glm::vec4(1, 0, 0, 0), glm::vec4(normal, 0), glm::vec4(-along, 0), glm::vec4(foot, 1));
      parts.add_piece(timber, transform_mesh(make_box("", {-0.05F, -0.06F, -1}, {0.05F, kThick + 0.13F, 0.01F}), board),
                      at);
    }
  }
  const glm::vec3 ends[] = {{0, s.ridge + kThick * 1.2F, -reach / 2}, {0, s.ridge + kThick * 1.2F, reach / 2}};
  const float radius[] = {0.15F};
  Mesh ridge = make_tube("", ends, radius, 8);
  scale_uvs(ridge, {0.5F, reach});
  parts.add_piece(roof, ridge);
}

Mesh make_arch(float width, float height, float depth, std::uint32_t steps) {
  std::vector<glm::vec2> outline{{-width / 2, 0}, {width / 2, 0}};
  for (std::uint32_t k = 0; k <= steps; ++k) {
    const glm::vec2 round = circle_point(0.5 * k / steps);
    outline.emplace_back(width / 2 * round.x, height - width / 2 + width / 2 * round.y * 1.25F);
  }
  return make_extrusion("", outline, depth);
}

Building add_house(Scene& scene, const std::string& name, const HouseShape& s, const HouseMaterials& p, float detail) {
  Parts parts;
  add_walls(parts, p.wall, s);
  add_roof(parts, p.roof, p.timber, s, detail);
  parts.add_box(p.stone, glm::mat4(1), {-s.width / 2 - 0.06F, -kBelow, -s.length / 2 - 0.06F},
                {s.width / 2 + 0.06F, 0.35F, s.length / 2 + 0.06F});
  const float storey = s.eaves / static_cast<float>(s.storeys);
  for (std::uint32_t side = 0; side < 4; ++side) {
    const bool gable = side % 2 == 1;
    const float length = gable ? s.width : s.length, out = gable ? s.length / 2 : s.width / 2;
    const double turns = side / 4.0;
    if (s.timbered) add_timber(parts, p.timber, wall_frame(turns, out), length, s.eaves, s.storeys);
    const auto count = s.barn ? 1U : static_cast<std::uint32_t>(length / 2.6F);
    for (std::uint32_t level = 0; level < s.storeys + (gable && !s.barn ? 1U : 0U); ++level) {
      const std::uint32_t here = level == s.storeys ? 1 : count;
      for (std::uint32_t k = 0; k < here; ++k) {
        const float x = length * ((static_cast<float>(k) + 0.5F) / static_cast<float>(here) - 0.5F);
        if (side == 0 && level == 0 && k == here / 2) {
          add_door(parts, p, wall_frame(turns, out, x, 0.1F), s.barn ? 3.2F : 1.05F, s.barn ? 3 : 2.1F);
          continue;
        }
        const float y = storey * static_cast<float>(level) + (level == s.storeys ? 0.35F : 0.36F * storey);
        add_window(parts, p, wall_frame(turns, out, x, y), 0.95F, std::min(1.25F, 0.5F * storey), s.shutters);
      }
    }
  }
  for (std::uint32_t k = 0; k < s.dormers; ++k) {
    const float x = s.length * ((static_cast<float>(k) + 0.5F) / static_cast<float>(s.dormers) - 0.5F);
    for (const double turns : {0.0, 0.5}) add_dormer(parts, p, s, turns, x);
  }
  if (!s.barn) add_chimney(parts, p, s);
  return parts.add_meshes_to_scene(scene, name);
}

namespace {

constexpr float kTower = 5.4F, kTowerTop = 17.5F, kSpireTop = 30;
constexpr float kTowerZ = 11;  // the front of the nave is at 9.5

void add_arch_window(Parts& parts, const HouseMaterials& p, const glm::mat4& at, float width, float height) {
  const glm::mat4 back = at * placement_at({0, 0, -0.04F});
  parts.add_piece(p.stone, make_arch(width + 0.36F, height + 0.2F, 0.12F, 10), back);
  parts.add_piece(p.glass, make_arch(width, height, 0.14F, 10), back);
  parts.add_box(p.timber, at, {-0.03F, 0, 0.05F}, {0.03F, height - 0.1F, 0.13F});
  for (const float y : {0.3F, 0.6F}) {
    parts.add_box(p.timber, at, {-width / 2, y * height - 0.03F, 0.05F}, {width / 2, y * height + 0.03F, 0.13F});
  }
  parts.add_box(p.stone, at, {-width / 2 - 0.3F, -0.16F, -0.1F}, {width / 2 + 0.3F, 0, 0.25F});
}

void add_nave(Parts& parts, const HouseMaterials& p, const HouseShape& nave) {
  for (const double turns : {0.0, 0.5}) {
    for (int k = 0; k < 5; ++k) {
      const float x = 3.7F * static_cast<float>(k - 2);
      if (k < 4) add_arch_window(parts, p, wall_frame(turns, nave.width / 2, x + 1.85F, 1.5F), 1.3F, 3.9F);
      const glm::mat4 at = wall_frame(turns, nave.width / 2, x);
      parts.add_box(p.stone, at, {-0.35F, -1, -0.1F}, {0.35F, 2.6F, 0.95F});
      parts.add_box(p.stone, at, {-0.3F, 2.6F, -0.1F}, {0.3F, nave.eaves - 0.6F, 0.5F});
    }
  }
  const glm::vec2 apse[] = {{3.3F, -1}, {3.3F, 4.9F}, {3.55F, 4.9F}, {3.55F, 5.1F}, {0, 7.6F}};
  Mesh round = make_lathe("", std::span(apse).first(3), 32);
  scale_uvs(round, {20, 4});
  parts.add_piece(p.wall, round, placement_at({0, 0, -nave.length / 2}));
  Mesh cone = make_lathe("", std::span(apse).subspan(2), 32);
  scale_uvs(cone, {20, 4});
  parts.add_piece(p.roof, cone, placement_at({0, 0, -nave.length / 2}));
  for (const double turns : {0.15, 0.25, 0.35}) {
    add_arch_window(parts, p, placement_at({0, 0, -nave.length / 2}) * wall_frame(turns, 3.3F, 0, 1.6F), 0.8F, 2.5F);
  }
}

void add_clock(Parts& parts, const glm::mat4& at, std::uint32_t white, std::uint32_t gold, std::uint32_t dark) {
  const glm::mat4 face =
      at * glm::mat4(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0), glm::vec4(0, 0, 0, 1));
  parts.add_piece(gold, make_cylinder("", 1.15F, 0.1F, 40), face);
  parts.add_piece(white, make_cylinder("", 1.02F, 0.13F, 40), face);
  for (int k = 0; k < 12; ++k) {
    const glm::vec2 round = circle_point(k / 12.0) * 0.86F;
    parts.add_piece(
        dark,
        transform_mesh(make_box("", {-0.05F, -0.09F, 0}, {0.05F, 0.09F, 0.16F}), placement_at({round.x, round.y, 0})),
        at);
  }
  parts.add_box(dark, at, {-0.04F, -0.15F, 0}, {0.04F, 0.8F, 0.18F});
  parts.add_box(dark, at, {-0.55F, -0.05F, 0}, {0.15F, 0.05F, 0.2F});
}

void add_tower(Parts& parts, const HouseMaterials& p, std::uint32_t white, std::uint32_t gold) {
  const float w = kTower / 2;
  const glm::mat4 foot = placement_at({0, 0, kTowerZ});
  for (int side = 0; side < 4; ++side) {
    const glm::mat4 at = foot * wall_frame(side / 4.0, w);
    parts.add_panel(p.wall, at, {-w, -1, 0}, {kTower, 0, 0}, {0, kTowerTop + 1, 0});
    for (int k = 0; k < 22; ++k) {  // corner stones, alternately long and short
      const float y = 0.8F * static_cast<float>(k) - 0.4F;
      const float reach = (k + side) % 2 == 0 ? 0.75F : 0.45F;
      parts.add_box(p.stone, at, {-w - 0.05F, y, -0.2F}, {-w + reach, y + 0.74F, 0.05F});
      parts.add_box(p.stone, at, {w - (1.2F - reach), y, -0.2F}, {w + 0.04F, y + 0.74F, 0.045F});
    }
    for (const float x : {-0.95F, 0.95F}) {
      const glm::mat4 opening = at * placement_at({x, 12.9F, -0.03F});
      parts.add_piece(p.stone, make_arch(1.5F, 3.6F, 0.1F, 8), opening * placement_at({0, -0.15F, 0}));
      parts.add_piece(p.timber, make_arch(1.15F, 3.3F, 0.12F, 8), opening);
      for (int k = 0; k < 9; ++k) {
        const float y = 0.1F + 0.3F * static_cast<float>(k);
        parts.add_box(p.door, opening, {-0.52F, y, 0.1F}, {0.52F, y + 0.1F, 0.22F});
      }
    }
    for (const float y : {6.2F, 12.3F, kTowerTop - 0.35F}) {
      parts.add_box(p.stone, at, {-w - 0.15F, y, -0.2F}, {w + 0.15F, y + 0.35F, 0.16F});
    }
    add_clock(parts, at * placement_at({0, 10.2F, 0}), white, gold, p.timber);
    if (side % 2 == 0) add_arch_window(parts, p, at * placement_at({0, 3, 0}), 0.7F, 2);
    // The eight sides of the spire. The transition from square to octagon is simplified to two slopes.
    for (int part = 0; part < 2; ++part) {
      const float low = part == 0 ? w + 0.35F : w * 0.62F, high = part == 0 ? w * 0.62F : 0.12F;
      const float from = part == 0 ? kTowerTop : kTowerTop + 2.6F, to = part == 0 ? kTowerTop + 2.6F : kSpireTop;
      Mesh slope = make_surface("", 1, part == 0 ? 3 : 8, [&](float s, float t) {
        const float out = low + (high - low) * t;
        return glm::vec3((2 * s - 1) * out, from + (to - from) * t, out);
      });
      for (std::size_t i = 0; i < slope.uvs.size(); ++i) slope.uvs[i] = {slope.positions[i].x, -slope.positions[i].y};
      parts.add_piece(p.roof, slope, foot * placement_at({0, 0, 0}, side / 4.0));
    }
  }
  parts.add_box(p.stone, foot, {-w - 0.3F, kTowerTop - 0.05F, -w - 0.3F}, {w + 0.3F, kTowerTop, w + 0.3F});
  parts.add_piece(gold, make_sphere("", {0, kSpireTop + 0.2F, 0}, 0.32F, 6), foot);
  parts.add_box(gold, foot, {-0.06F, kSpireTop, -0.06F}, {0.06F, kSpireTop + 2.6F, 0.06F});
  parts.add_box(gold, foot, {-0.75F, kSpireTop + 1.6F, -0.06F}, {0.75F, kSpireTop + 1.75F, 0.06F});
  const glm::mat4 porch = foot * wall_frame(0.75, w);
  parts.add_piece(p.stone, make_arch(2.9F, 4.4F, 0.5F, 12), porch * placement_at({0, -0.2F, 0}));
  parts.add_piece(p.door, make_arch(1.9F, 3.5F, 0.54F, 12), porch);
  parts.add_box(p.timber, porch, {-0.03F, 0, 0.5F}, {0.03F, 3.3F, 0.57F});
  for (const float s : {-1.0F, 1.0F}) {
    for (const float y : {0.7F, 2.1F}) {
      parts.add_box(p.timber, porch, {std::min(0.1F * s, 0.85F * s), y, 0.5F},
                    {std::max(0.1F * s, 0.85F * s), y + 0.1F, 0.57F});
    }
  }
  for (int k = 0; k < 4; ++k) {
    const float out = 1 + 0.45F * static_cast<float>(k), y = -0.02F - 0.2F * static_cast<float>(k);
    parts.add_box(p.stone, porch, {-1.8F - out * 0.3F, -2, 0.01F}, {1.8F + out * 0.3F, y, out});
  }
}

}  // namespace

Building add_church(Scene& scene, const HouseMaterials& p, std::uint32_t white, std::uint32_t gold, float detail) {
  Parts parts;
  const HouseShape nave{.width = 9.5F, .length = 19, .eaves = 6.3F, .ridge = 12};
  add_walls(parts, p.wall, nave);
  add_roof(parts, p.roof, p.timber, nave, 0.8F * detail);
  parts.add_box(p.stone, glm::mat4(1), {-4.9F, -1, -9.65F}, {4.9F, 0.6F, 9.65F});
  add_nave(parts, p, nave);
  add_tower(parts, p, white, gold);
  return parts.add_meshes_to_scene(scene, "church");
}

}  // namespace traces::village
