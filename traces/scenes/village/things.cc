#include "traces/scenes/village/things.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/plants.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::village {

Mesh make_stone_wall(float length, float detail, std::uint32_t seed) {
  Mesh mesh;
  mesh.name = "stone wall";
  const std::uint32_t cells = std::max(static_cast<std::uint32_t>(3 * detail), 2U);
  constexpr int kCourses = 4;
  for (int course = 0; course < kCourses; ++course) {
    const float y = 0.25F * static_cast<float>(course) - 0.06F;
    float x = -length / 2 - random_unit(seed, static_cast<std::uint64_t>(course)) * 0.2F;
    for (std::uint32_t k = 0; x < length / 2; ++k) {
      const auto key = static_cast<std::uint64_t>(course) * 64 + k;
      const float width = random_between(0.32F, 0.62F, seed, key, 1);
      Mesh stone = make_rock("", {width * 0.62F, 0.17F, random_between(0.2F, 0.27F, seed, key, 2)}, cells, 0.3F,
                             seed + static_cast<std::uint32_t>(key));
      scale_uvs(stone, {0.2F, 0.2F});
      for (glm::vec2& uv : stone.uvs) uv += glm::vec2(random_unit(seed, key, 3), random_unit(seed, key, 4));
      append_mesh(mesh,
                  transform_mesh(stone, placement_at({x + width / 2, y, 0.04F * (random_unit(seed, key, 5) - 0.5F)})));
      x += width;
    }
  }
  return mesh;
}

Mesh make_fence(float length) {
  Mesh mesh;
  mesh.name = "fence";
  const float w = length / 2;
  for (int k = 0; k < 3; ++k) {
    const float x = -w + w * static_cast<float>(k);
    append_mesh(mesh, make_box("", {x - 0.06F, -0.4F, -0.06F}, {x + 0.06F, 1.15F, 0.06F}));
  }
  for (const float y : {0.3F, 0.62F, 0.94F}) append_mesh(mesh, make_box("", {-w, y, 0.04F}, {w, y + 0.09F, 0.09F}));
  return mesh;
}

Building add_fountain(Scene& scene, std::uint32_t stone, std::uint32_t water, float detail) {
  Parts parts;
  const auto round = std::max(static_cast<std::uint32_t>(48 * detail), 12U);
  const glm::vec2 basin[] = {{2.9F, -0.3F}, {2.9F, 0.14F}, {2.6F, 0.2F},   {2.45F, 0.3F}, {2.45F, 0.7F},
                             {2.6F, 0.76F}, {2.6F, 0.88F}, {2.25F, 0.88F}, {2.2F, 0.4F},  {0, 0.4F}};
  Mesh bowl = make_lathe("", basin, round);
  scale_uvs(bowl, {8, 2});
  parts.add_piece(stone, bowl);
  const glm::vec2 coarse[] = {{0.55F, 0.35F}, {0.55F, 0.75F}, {0.3F, 0.95F},  {0.24F, 1.6F},
                              {0.34F, 1.85F}, {0.9F, 2.05F},  {1.05F, 2.2F},  {0.98F, 2.2F},
                              {0.3F, 2.05F},  {0.16F, 2.5F},  {0.26F, 2.75F}, {0, 3}};
  Mesh column = make_lathe("", catmull_rom(std::span<const glm::vec2>(coarse), 3), round);
  scale_uvs(column, {3, 4});
  parts.add_piece(stone, column);
  Mesh surface = make_surface(
      "", round, 10,
      [](float s, float t) {
        const float r = 2.23F * (1 - t);
        const glm::vec2 way = circle_point(static_cast<double>(s)) * r;
        return glm::vec3(way.x, 0.7F + 0.012F * sin_turns(static_cast<double>(r) * 2.2), -way.y);
      },
      true);
  parts.add_piece(water, surface);
  for (int k = 0; k < 6; ++k) {  // jets from the upper bowl
    std::vector<glm::vec3> jet;
    for (int i = 0; i <= 6; ++i) {
      const float t = static_cast<float>(i) / 6;
      const glm::vec2 way = circle_point(k / 6.0) * (0.95F + 0.6F * t);
      jet.emplace_back(way.x, 2.2F + 0.25F * t - 1.75F * t * t, way.y);
    }
    const float radius[] = {0.028F};
    parts.add_piece(water, make_tube("", jet, radius, 6));
  }
  return parts.add_meshes_to_scene(scene, "fountain");
}

Building add_mill(Scene& scene, const HouseMaterials& p, std::uint32_t cap, float detail) {
  Parts parts;
  const auto round = std::max(static_cast<std::uint32_t>(40 * detail), 12U);
  const glm::vec2 tower[] = {{3.9F, -1.5F}, {3.9F, 0.3F}, {3.7F, 0.35F}, {3.3F, 4}, {2.9F, 8}, {2.7F, 10.4F}};
  Mesh walls = make_lathe("", tower, round);
  scale_uvs(walls, {22, 12});
  parts.add_piece(p.wall, walls);
  const glm::vec2 hood[] = {{2.55F, 10.2F}, {3.05F, 10.3F}, {3.0F, 11}, {2.5F, 12.3F}, {1.3F, 13.5F}, {0, 13.9F}};
  Mesh roof = make_lathe("", catmull_rom(std::span<const glm::vec2>(hood), 3), round);
  scale_uvs(roof, {10, 5});
  parts.add_piece(cap, roof);
  parts.add_piece(
      p.timber,
      make_extrusion("", std::vector<glm::vec2>{{-0.3F, 11.3F}, {0.3F, 11.3F}, {0.3F, 11.9F}, {-0.3F, 11.9F}}, 3.5F));
  parts.add_piece(p.stone, make_arch(1.6F, 2.7F, 0.6F, 8), placement_at({0, 0, 3.2F}));
  parts.add_piece(p.door, make_arch(1.2F, 2.4F, 0.64F, 8), placement_at({0, 0, 3.2F}));
  for (const double turns : {0.1, 0.4, 0.75, 0.9}) {
    for (const float y : {4.2F, 7.6F}) {
      const glm::mat4 at = wall_frame(turns, 3.3F - 0.1F * (y - 4), 0, y);
      parts.add_box(p.timber, at, {-0.5F, -0.1F, -0.4F}, {0.5F, 1.1F, 0.04F});
      parts.add_panel(p.glass, at, {-0.4F, 0, 0.05F}, {0.8F, 0, 0}, {0, 1, 0});
    }
  }
  return parts.add_meshes_to_scene(scene, "mill");
}

Building add_sails(Scene& scene, std::uint32_t timber, std::uint32_t cloth) {
  Parts parts;
  parts.add_box(timber, glm::mat4(1), {-0.35F, -0.35F, -0.5F}, {0.35F, 0.35F, 0.35F});
  for (int k = 0; k < 4; ++k) {
    const glm::vec2 round = circle_point(k / 4.0);
    const glm::mat4 at(glm::vec4(round.x, round.y, 0, 0), glm::vec4(-round.y, round.x, 0, 0), glm::vec4(0, 0, 1, 0),
                       glm::vec4(0, 0, 0, 1));
    parts.add_box(timber, at, {0, -0.11F, -0.1F}, {7.6F, 0.11F, 0.1F});
    for (const float y : {0.75F, 1.5F}) parts.add_box(timber, at, {1.5F, y, -0.03F}, {7.5F, y + 0.06F, 0.03F});
    for (int i = 0; i <= 12; ++i) {
      const float x = 1.5F + 0.49F * static_cast<float>(i);
      parts.add_box(timber, at, {x, -0.35F, -0.04F}, {x + 0.06F, 1.56F, 0.02F});
    }
    Mesh sail = make_surface("", 16, 6, [](float s, float t) {
      return glm::vec3(1.9F + 5.4F * s, 0.12F + 1.3F * t, 0.06F + 0.5F * s * (1 - s) * t * (1 - t));
    });
    scale_uvs(sail, {4, 1});
    parts.add_piece(cloth, sail, at);
  }
  return parts.add_meshes_to_scene(scene, "sails");
}

Building add_cart(Scene& scene, std::uint32_t timber, std::uint32_t hay, std::uint32_t iron) {
  Parts parts;
  const glm::mat4 one(1);
  parts.add_box(timber, one, {-1.5F, 0.72F, -0.7F}, {1.5F, 0.8F, 0.7F});
  for (const float s : {-1.0F, 1.0F}) {
    for (int k = 0; k < 3; ++k) {
      const float y = 0.82F + 0.19F * static_cast<float>(k);
      parts.add_box(timber, one, {-1.5F, y, s * 0.7F - 0.03F}, {1.5F, y + 0.15F, s * 0.7F + 0.03F});
    }
    for (const float x : {-1.4F, 0.0F, 1.4F}) {
      parts.add_box(timber, one, {x - 0.05F, 0.7F, s * 0.74F - 0.04F}, {x + 0.05F, 1.5F, s * 0.74F + 0.04F});
    }
    parts.add_box(timber, one, {1.5F, 0.68F, s * 0.45F - 0.04F}, {3.4F, 0.77F, s * 0.45F + 0.04F});
  }
  parts.add_box(timber, one, {-1.53F, 0.8F, -0.7F}, {-1.47F, 1.35F, 0.7F});
  const glm::vec3 axle[] = {{0, kWheelRadius, -0.95F}, {0, kWheelRadius, 0.95F}};
  const float radius[] = {0.06F};
  parts.add_piece(iron, make_tube("", axle, radius, 8));
  parts.add_piece(hay, make_rock("", {1.5F, 0.75F, 0.78F}, 16, 0.35F, 77), placement_at({0, 0.78F, 0}));
  return parts.add_meshes_to_scene(scene, "cart");
}

Mesh make_wheel() {
  Mesh mesh;
  mesh.name = "wheel";
  const glm::mat4 upright(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0), glm::vec4(0, 0, 0, 1));
  append_mesh(mesh, transform_mesh(make_torus("", kWheelRadius - 0.05F, 0.05F, 32, 6), upright));
  append_mesh(mesh, transform_mesh(make_cylinder("", 0.12F, 0.22F, 12), placement_at({0, 0, -0.11F}) * upright));
  for (int k = 0; k < 10; ++k) {
    const glm::vec2 round = circle_point(k / 10.0);
    const glm::vec3 spoke[] = {{0.1F * round.x, 0.1F * round.y, 0},
                               {(kWheelRadius - 0.06F) * round.x, (kWheelRadius - 0.06F) * round.y, 0}};
    const float radius[] = {0.03F};
    append_mesh(mesh, make_tube("", spoke, radius, 5));
  }
  return mesh;
}

}  // namespace traces::village
