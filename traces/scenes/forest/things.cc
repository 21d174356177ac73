#include "traces/scenes/forest/things.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/plants.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::forest {
namespace {

struct Joint {
  glm::vec3 at;
  float radius;
};

/// Makes a smooth limb of an animal through joints.
Mesh make_limb(std::span<const Joint> joints, std::uint32_t steps, std::uint32_t sides) {
  std::vector<glm::vec3> path, radii;
  for (const Joint& j : joints) {
    path.push_back(j.at);
    radii.emplace_back(j.radius, 0, 0);
  }
  path = catmull_rom(std::span<const glm::vec3>(path), steps);
  radii = catmull_rom(std::span<const glm::vec3>(radii), steps);
  std::vector<float> thick;
  for (const glm::vec3& r : radii) thick.push_back(std::max(r.x, 0.0F));
  return make_tube("", path, thick, sides);
}

Mesh mirrored_in_z(const Mesh& mesh) { return transform_mesh(mesh, placement_at(glm::vec3(0), 0, {1, 1, -1})); }

}  // namespace

Mesh make_fern(std::uint32_t fronds, std::uint32_t pairs, float reach, std::uint64_t seed) {
  Mesh mesh;
  mesh.name = "fern";
  for (std::uint32_t f = 0; f < fronds; ++f) {
    const glm::vec2 round =
        circle_point(static_cast<double>(f) / fronds + static_cast<double>(0.08F * random_unit(seed, f, 1)));
    const float r = reach * random_between(0.75F, 1.1F, seed, f, 2), h = r * random_between(0.6F, 1.0F, seed, f, 3);
    const glm::vec3 out(round.x, 0, round.y);
    const auto at = [&](float t) {
      return out * (r * t * (0.55F + 0.45F * t)) + glm::vec3(0, h * t * (2 - 1.55F * t), 0);
    };
    std::vector<glm::vec3> spine;
    for (int k = 0; k <= 5; ++k) spine.push_back(at(static_cast<float>(k) / 5));
    const float radii[] = {0.012F * reach, 0.01F * reach, 0.008F * reach, 0.006F * reach, 0.004F * reach, 0};
    append_mesh(mesh, make_tube("", spine, radii, 3));
    for (std::uint32_t k = 0; k < pairs; ++k) {
      const float t = 0.12F + 0.87F * static_cast<float>(k) / static_cast<float>(pairs);
      const glm::vec3 foot = at(t), along = glm::normalize(at(t + 0.02F) - at(t - 0.02F));
      const glm::vec3 side = glm::normalize(glm::cross(along, glm::vec3(0, 1, 0) + 1e-3F * out));
      const glm::vec3 up = glm::normalize(glm::cross(side, along));
      const float length = r * 0.34F * std::sqrt(std::max(1.02F - t, 0.02F)) * std::min(1.0F, 0.35F + 3.5F * t);
      for (const float s : {-1.0F, 1.0F}) {
        const glm::vec3 leaf = glm::normalize(side * s + along * 0.55F - up * 0.22F) * length;
        const glm::vec3 wide = glm::normalize(glm::cross(up, leaf)) * (0.62F * r / static_cast<float>(pairs));
        add_leaf(mesh, foot, leaf, wide, up, {random_unit(seed, f, k + 9), random_unit(seed, f, k + 90)}, 0.09F);
      }
    }
  }
  return mesh;
}

Pieces make_mushroom(float height, float bell, std::uint32_t round, std::uint32_t cap, std::uint32_t gills,
                     std::uint32_t stem) {
  const float r = height * (0.55F - 0.15F * bell), top = height * (1 + 0.25F * bell), rim = height * 0.72F;
  const std::uint32_t steps = std::max(round / 8, 2U);
  const glm::vec2 foot[] = {{0.15F * height, -0.05F},
                            {0.14F * height, 0.1F * height},
                            {0.095F * height, 0.45F * height},
                            {0.085F * height, 0.8F * height}};
  const glm::vec2 skirt[] = {
      {0.19F * height, 0.56F * height}, {0.16F * height, 0.62F * height}, {0.08F * height, 0.68F * height}};
  const glm::vec2 under[] = {
      {0.08F * height, rim + 0.08F * height}, {0.5F * r, rim + 0.05F * height}, {0.97F * r, rim}};
  const glm::vec2 over[] = {{0.97F * r, rim},
                            {r, rim + 0.04F * height},
                            {0.8F * r, rim + 0.6F * (top - rim)},
                            {0.42F * r, rim + 0.92F * (top - rim)},
                            {0, top}};
  const auto lathe = [&](std::span<const glm::vec2> line, std::uint32_t fine) {
    return make_lathe("", catmull_rom(line, fine), round);
  };
  Mesh stalk = lathe(foot, steps);
  append_mesh(stalk, lathe(skirt, std::max(steps / 2, 1U)));
  // The profile of the underside runs from the inside outwards, so that it faces down.
  Pieces pieces;
  pieces.emplace_back(std::move(stalk), stem);
  pieces.emplace_back(lathe(under, std::max(steps / 2, 1U)), gills);
  pieces.emplace_back(lathe(over, steps), cap);
  pieces[0].first.name = "mushroom stem";
  pieces[1].first.name = "mushroom gills";
  pieces[2].first.name = "mushroom cap";
  return pieces;
}

Pieces make_deer(std::uint32_t sides, std::uint32_t fur, std::uint32_t horn, std::uint32_t dark) {
  const std::uint32_t steps = std::max(sides / 4, 2U), thin = std::max(sides * 2 / 3, 5U);
  const Joint body[] = {{{-0.66F, 0.96F, 0}, 0.03F}, {{-0.62F, 0.98F, 0}, 0.16F}, {{-0.48F, 0.99F, 0}, 0.235F},
                        {{-0.2F, 0.97F, 0}, 0.225F}, {{0.1F, 0.94F, 0}, 0.24F},   {{0.36F, 0.97F, 0}, 0.25F},
                        {{0.52F, 1.06F, 0}, 0.19F},  {{0.64F, 1.22F, 0}, 0.125F}, {{0.73F, 1.42F, 0}, 0.095F},
                        {{0.79F, 1.56F, 0}, 0.085F}};
  const Joint head[] = {{{0.74F, 1.62F, 0}, 0.02F},  {{0.76F, 1.62F, 0}, 0.075F}, {{0.84F, 1.61F, 0}, 0.1F},
                        {{0.95F, 1.56F, 0}, 0.078F}, {{1.06F, 1.50F, 0}, 0.055F}, {{1.12F, 1.475F, 0}, 0.045F},
                        {{1.14F, 1.465F, 0}, 0.01F}};
  const Joint fore[] = {{{0.40F, 0.98F, 0.1F}, 0.13F},  {{0.43F, 0.74F, 0.13F}, 0.085F},
                        {{0.44F, 0.52F, 0.12F}, 0.05F}, {{0.42F, 0.46F, 0.12F}, 0.046F},
                        {{0.43F, 0.2F, 0.12F}, 0.026F}, {{0.435F, 0.1F, 0.12F}, 0.03F}};
  const Joint hind[] = {{{-0.46F, 1.0F, 0.08F}, 0.17F},  {{-0.40F, 0.78F, 0.13F}, 0.125F},
                        {{-0.45F, 0.6F, 0.13F}, 0.065F}, {{-0.56F, 0.46F, 0.13F}, 0.042F},
                        {{-0.53F, 0.2F, 0.13F}, 0.027F}, {{-0.52F, 0.1F, 0.13F}, 0.031F}};
  Mesh skin = transform_mesh(make_limb(body, steps, sides), placement_at(glm::vec3(0), 0, {1, 1, 0.8F}));
  append_mesh(skin, transform_mesh(make_limb(head, steps, sides), placement_at(glm::vec3(0), 0, {1, 1, 0.8F})));
  Mesh hooves;
  for (const auto& [leg, step] :
       {std::pair(std::span<const Joint>(fore), 0.05F), {std::span<const Joint>(hind), -0.06F}}) {
    Mesh limb = make_limb(leg, steps, thin);
    append_mesh(skin, limb);
    append_mesh(skin, transform_mesh(mirrored_in_z(limb), placement_at({step, 0, 0})));
    for (const float s : {1.0F, -1.0F}) {
      const glm::vec3 foot = leg.back().at;
      append_mesh(hooves, transform_mesh(make_cone("", 0.05F, 0.032F, 0.13F, thin),
                                         placement_at({foot.x + 0.012F + (s < 0 ? step : 0.0F), -0.02F, s * foot.z})));
    }
  }
  const Joint tail[] = {{{-0.64F, 1.07F, 0}, 0.05F}, {{-0.72F, 1.0F, 0}, 0.04F}, {{-0.74F, 0.88F, 0}, 0}};
  append_mesh(skin, make_limb(tail, 3, thin));
  Mesh antlers;
  const Joint beam[] = {{{0.80F, 1.68F, 0.05F}, 0.022F},
                        {{0.74F, 1.82F, 0.16F}, 0.02F},
                        {{0.72F, 2.0F, 0.28F}, 0.017F},
                        {{0.82F, 2.18F, 0.31F}, 0.012F},
                        {{0.93F, 2.27F, 0.24F}, 0}};
  const Joint brow[] = {{{0.785F, 1.72F, 0.08F}, 0.015F}, {{0.9F, 1.78F, 0.12F}, 0.011F}, {{0.99F, 1.87F, 0.13F}, 0}};
  const Joint second[] = {{{0.725F, 1.92F, 0.23F}, 0.014F}, {{0.84F, 1.98F, 0.29F}, 0.01F}, {{0.91F, 2.07F, 0.3F}, 0}};
  const Joint back[] = {{{0.745F, 2.06F, 0.295F}, 0.013F}, {{0.68F, 2.16F, 0.33F}, 0.009F}, {{0.66F, 2.26F, 0.34F}, 0}};
  for (const std::span<const Joint> part : {std::span<const Joint>(beam), {brow}, {second}, {back}}) {
    const Mesh tine = make_limb(part, steps, std::max(thin / 2, 4U));
    append_mesh(antlers, tine);
    append_mesh(antlers, mirrored_in_z(tine));
  }
  Mesh ears;
  for (const float s : {1.0F, -1.0F}) {
    const Joint ear[] = {{{0.76F, 1.66F, s * 0.06F}, 0.025F},
                         {{0.72F, 1.70F, s * 0.14F}, 0.045F},
                         {{0.69F, 1.74F, s * 0.22F}, 0.03F},
                         {{0.68F, 1.76F, s * 0.26F}, 0}};
    append_mesh(skin, make_limb(ear, steps, thin));
    append_mesh(hooves, make_sphere("", {0.90F, 1.625F, s * 0.068F}, 0.02F, 3));
  }
  append_mesh(hooves, make_sphere("", {1.135F, 1.478F, 0}, 0.026F, 4));
  skin.name = "deer";
  antlers.name = "antlers";
  hooves.name = "hooves and eyes";
  return {{std::move(skin), fur}, {std::move(antlers), horn}, {std::move(hooves), dark}};
}

Pieces make_bench(std::uint32_t wood, std::uint32_t dark) {
  Mesh planks, frame;
  planks.name = "bench planks";
  frame.name = "bench frame";
  for (int k = 0; k < 3; ++k) {
    const float z = -0.21F + 0.15F * static_cast<float>(k), y = 0.52F + 0.15F * static_cast<float>(k);
    append_mesh(planks, make_rounded_box("", {-0.85F, 0.42F, z}, {0.85F, 0.46F, z + 0.13F}, 0.012F, 2));
    if (k < 2)
      append_mesh(planks, make_rounded_box("", {-0.85F, y + 0.1F, -0.29F}, {0.85F, y + 0.22F, -0.25F}, 0.012F, 2));
  }
  for (glm::vec2& uv : planks.uvs) uv = {uv.x, 2 * uv.y};
  for (const float x : {-0.65F, 0.65F}) {
    append_mesh(frame, make_box("", {x - 0.04F, -0.1F, -0.25F}, {x + 0.04F, 0.95F, -0.18F}));
    append_mesh(frame, make_box("", {x - 0.04F, -0.1F, 0.14F}, {x + 0.04F, 0.42F, 0.22F}));
    append_mesh(frame, make_box("", {x - 0.035F, 0.33F, -0.2F}, {x + 0.035F, 0.419F, 0.21F}));
  }
  return {{std::move(planks), wood}, {std::move(frame), dark}};
}

Pieces make_lantern(std::uint32_t iron, std::uint32_t flame) {
  Mesh frame, light;
  frame.name = "lantern";
  light.name = "flame";
  append_mesh(frame, make_cylinder("", 0.09F, 0.025F, 24));
  append_mesh(frame, transform_mesh(make_cone("", 0.1F, 0.03F, 0.07F, 24), placement_at({0, 0.24F, 0})));
  append_mesh(frame, transform_mesh(make_cylinder("", 0.03F, 0.03F, 12), placement_at({0, 0.31F, 0})));
  for (int k = 0; k < 4; ++k) {
    const glm::vec2 round = circle_point(k / 4.0 + 0.125) * 0.08F;
    append_mesh(frame, transform_mesh(make_cylinder("", 0.006F, 0.23F, 6), placement_at({round.x, 0.02F, round.y})));
  }
  const glm::mat4 upright(glm::vec4(1, 0, 0, 0), glm::vec4(0, 0, 1, 0), glm::vec4(0, -1, 0, 0),
                          glm::vec4(0, 0.35F, 0, 1));
  append_mesh(frame, transform_mesh(make_torus("", 0.05F, 0.006F, 24, 6), upright));
  append_mesh(light,
              transform_mesh(make_sphere("", {0, 0, 0}, 0.045F, 6), placement_at({0, 0.12F, 0}, 0, {1, 1.6F, 1})));
  return {{std::move(frame), iron}, {std::move(light), flame}};
}

Mesh make_log(float length, float radius, std::uint32_t sides, std::uint32_t seed) {
  std::vector<glm::vec3> path;
  std::vector<float> radii;
  for (int k = 0; k <= 14; ++k) {
    const float t = static_cast<float>(k) / 14;
    path.emplace_back((t - 0.5F) * length, radius * 0.75F + 0.05F * value_noise(t, 0.5F, 6, seed),
                      0.12F * value_noise(t, 0.2F, 5, seed + 1));
    radii.push_back(radius * (1.1F - 0.3F * t) * (0.9F + 0.22F * value_noise(t, 0.7F, 9, seed + 2)));
  }
  Mesh mesh = make_tube("log", path, radii, sides);
  for (glm::vec2& uv : mesh.uvs) uv = {uv.x * 2, uv.y * length};
  for (int k = 0; k < 3; ++k) {
    const float x = length * (0.28F * static_cast<float>(k) - 0.3F);
    const glm::vec2 round = circle_point(0.12 + 0.13 * k);
    const glm::vec3 stub[] = {{x, radius * 0.75F, 0},
                              {x + 0.12F, radius * (0.75F + 1.7F * round.y), 1.7F * radius * round.x}};
    const float thin[] = {0.28F * radius, 0.17F * radius};
    append_mesh(mesh, make_tube("", stub, thin, std::max(sides / 2, 5U)));
  }
  return mesh;
}

Mesh make_roots(float radius, std::uint32_t sides, std::uint64_t seed) {
  Mesh mesh;
  mesh.name = "roots";
  for (std::uint32_t k = 0; k < 6; ++k) {
    const glm::vec2 round = circle_point(k / 6.0 + static_cast<double>(0.1F * random_unit(seed, k)));
    const glm::vec3 out(round.x, 0, round.y), aside(-round.y * 0.4F * radius, 0, round.x * 0.4F * radius);
    const float reach = random_between(2.2F, 3.4F, seed, k, 1), bend = 2 * random_unit(seed, k, 2) - 1;
    const Joint joints[] = {
        {out * (0.45F * radius) + glm::vec3(0, 1.9F * radius, 0), 0.30F * radius},
        {out * (1.0F * radius) + glm::vec3(0, 0.75F * radius, 0), 0.33F * radius},
        {out * (1.65F * radius) + aside * bend + glm::vec3(0, 0.12F * radius, 0), 0.24F * radius},
        {out * (reach * radius) + aside * (2.5F * bend) - glm::vec3(0, 0.25F * radius, 0), 0.06F * radius}};
    Mesh root = make_limb(joints, 2, sides);
    scale_uvs(root, {0.7F, 1.2F});
    append_mesh(mesh, root);
  }
  return mesh;
}

Mesh make_litter(float radius, std::uint32_t leaves, std::uint64_t seed) {
  Mesh mesh;
  mesh.name = "fallen leaves";
  for (std::uint32_t k = 0; k < leaves; ++k) {
    const glm::vec2 position =
        circle_point(static_cast<double>(random_unit(seed, k, 1))) * (radius * std::sqrt(random_unit(seed, k, 2)));
    const glm::vec2 way = circle_point(static_cast<double>(random_unit(seed, k, 3)));
    const float size = random_between(0.07F, 0.13F, seed, k, 4), tilt = 0.5F * (random_unit(seed, k, 5) - 0.35F);
    const glm::vec3 length = glm::vec3(way.x, tilt, way.y) * size;
    const glm::vec3 wide = glm::vec3(-way.y, 0.7F * (random_unit(seed, k, 6) - 0.5F), way.x) * (0.3F * size);
    add_leaf(mesh, {position.x, 0.025F + 0.02F * random_unit(seed, k, 7), position.y}, length, wide, {0, 1, 0},
             {random_unit(seed, k, 8), random_unit(seed, k, 9)}, 0.05F);
  }
  return mesh;
}

namespace {

std::uint32_t pack_colour(const glm::vec3& c) {
  const auto byte = [](float x) { return static_cast<std::uint32_t>(std::clamp(x, 0.0F, 1.0F) * 255 + 0.5F); };
  return byte(c.x) | (byte(c.y) << 8) | (byte(c.z) << 16) | 0xff000000U;
}

/// Returns the distance, in cells, to the nearest point of a repeating jittered grid. A cell is as long in v as in u.
/// Sets `size` to a random number of that point.
float spot_distance(float u, float v, std::uint32_t columns, std::uint32_t rows, std::uint32_t seed, float& size) {
  const glm::vec2 p(u * static_cast<float>(columns), v * static_cast<float>(rows));
  const glm::vec2 cell = glm::floor(p);
  float nearest = 9;
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      const glm::vec2 c = cell + glm::vec2(i, j);
      const auto a = static_cast<std::uint32_t>(static_cast<int>(c.x) + static_cast<int>(columns)) % columns;
      const auto b = static_cast<std::uint32_t>(static_cast<int>(c.y) + static_cast<int>(rows)) % rows;
      const glm::vec2 middle = c + 0.2F + 0.6F * glm::vec2(random_unit(seed, a, b), random_unit(seed + 1, a, b));
      const float away = glm::distance(p, middle);
      if (away < nearest) {
        nearest = away;
        size = random_unit(seed + 2, a, b);
      }
    }
  }
  return nearest;
}

}  // namespace

Texture litter_texture(std::string name, std::uint32_t leaves, std::uint32_t seed) {
  constexpr int kSize = 1024;
  Texture texture = paint_texture(std::move(name), kSize, kSize, [seed](float u, float v) {
    const float crumbs = value_noise(u, v, 200, seed), patch = value_noise(u, v, 12, seed + 1);
    return glm::vec4(glm::vec3(0.27F, 0.20F, 0.14F) * (0.35F + 0.9F * crumbs * patch + 0.3F * crumbs), 1);
  });
  constexpr glm::vec3 kHues[] = {{0.63F, 0.38F, 0.16F}, {0.75F, 0.55F, 0.24F}, {0.47F, 0.27F, 0.14F},
                                 {0.36F, 0.22F, 0.14F}, {0.70F, 0.34F, 0.13F}, {0.58F, 0.50F, 0.26F},
                                 {0.45F, 0.47F, 0.20F}};
  for (std::uint32_t k = 0; k < leaves; ++k) {
    const float length = random_between(26, 58, seed, k, 1), width = length * random_between(0.4F, 0.62F, seed, k, 2);
    const glm::vec2 way = circle_point(static_cast<double>(random_unit(seed, k, 3)));
    const glm::vec2 middle = glm::vec2(random_unit(seed, k, 4), random_unit(seed, k, 5)) * static_cast<float>(kSize);
    const glm::vec3 hue = kHues[static_cast<std::size_t>(random_unit(seed, k, 6) * 6.999F)] *
                          (0.7F + 0.65F * static_cast<float>(k) / static_cast<float>(leaves));
    const int reach = static_cast<int>(length * 0.6F) + 2;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const glm::vec2 d(dx, dy);
        const float s = glm::dot(d, way) / length + 0.5F, t = (d.y * way.x - d.x * way.y) / width * 2;
        if (s < 0 || s > 1) continue;
        const float half = 4 * s * (1 - s) * (1.25F - 0.5F * s) * (0.9F + 0.1F * sin_turns(static_cast<double>(9 * s)));
        if (std::abs(t) > half + 0.08F) continue;
        const bool edge = std::abs(t) > half;
        const float rib = sin_turns(static_cast<double>(8 * (s - 0.35F * std::abs(t))));
        float shade = edge ? 0.25F : (std::abs(t) < 0.07F ? 1.3F : 0.9F + 0.16F * (rib > 0.7F ? 1.0F : 0.0F));
        shade *= t > 0 ? 1.05F : 0.85F;
        const auto x = static_cast<std::uint32_t>(static_cast<int>(middle.x) + dx + kSize) % kSize;
        const auto y = static_cast<std::uint32_t>(static_cast<int>(middle.y) + dy + kSize) % kSize;
        texture.texels[std::size_t{y} * kSize + x] = pack_colour(hue * shade);
      }
    }
  }
  return texture;
}

Texture mossy_texture(std::string name, const glm::vec3& rock, std::uint32_t seed) {
  Texture texture = paint_texture(std::move(name), 512, 512, [&](float u, float v) {
    const float grain = fractal_noise(u, v, 24, 4, seed), crack = std::abs(value_noise(u, v, 9, seed + 5) - 0.5F);
    glm::vec3 colour = rock * (0.35F + 1.2F * grain) * (crack < 0.03F ? 0.45F : 1.0F);
    const float moss = v + 0.9F * (fractal_noise(u, v, 7, 3, seed + 7) - 0.5F);
    if (moss > 0.52F) {
      const float tips = value_noise(u, v, 150, seed + 8);
      colour = glm::mix(glm::vec3(0.16F, 0.24F, 0.05F), glm::vec3(0.55F, 0.66F, 0.20F), tips * (0.4F + 0.8F * grain));
    } else if (value_noise(u, v, 60, seed + 9) > 0.83F) {
      colour = glm::vec3(0.78F, 0.80F, 0.70F);  // lichen
    }
    return glm::vec4(colour, 1);
  });
  texture.wrap_v = Texture::Wrap::kClamp;
  return texture;
}

Texture cap_texture(std::string name, const glm::vec3& colour, std::uint32_t seed) {
  Texture texture = paint_texture(std::move(name), 512, 256, [&](float u, float v) {
    float size = 0;
    const float away = spot_distance(u, v, 14, 5, seed, size) + 0.16F * (value_noise(u, v, 60, seed + 3) - 0.5F);
    const glm::vec3 skin = colour * (0.75F + 0.4F * fractal_noise(u, v, 20, 3, seed + 4));
    const float edge = 0.17F + 0.2F * size;
    if (away > edge) return glm::vec4(away < edge + 0.06F ? skin * 0.6F : skin, 1);
    return glm::vec4(glm::vec3(0.96F, 0.93F, 0.84F) * (0.75F + 0.3F * value_noise(u, v, 90, seed + 6)), 1);
  });
  texture.wrap_v = Texture::Wrap::kClamp;
  return texture;
}

Texture gills_texture(std::string name) {
  return paint_texture(std::move(name), 512, 64, [](float u, float v) {
    const float gill = 0.5F + 0.5F * cos_turns(static_cast<double>(64 * u));
    return glm::vec4(glm::vec3(0.93F, 0.87F, 0.74F) * (0.45F + 0.55F * gill) * (0.9F + 0.2F * value_noise(u, v, 30, 3)),
                     1);
  });
}

Texture fur_texture(std::string name) {
  return paint_texture(std::move(name), 512, 512, [](float u, float v) {
    const float top = 0.5F - 0.5F * sin_turns(static_cast<double>(u));  // 1 on the back, 0 under the belly
    const float hair = value_noise(u * 0.999F, v, 256, 5) * 0.6F + value_noise(u, v, 40, 6) * 0.4F;
    glm::vec3 colour = glm::mix(glm::vec3(0.62F, 0.36F, 0.17F), glm::vec3(0.46F, 0.24F, 0.11F), top);
    colour = glm::mix(glm::vec3(0.90F, 0.82F, 0.68F), colour, std::clamp(6 * top - 0.9F, 0.0F, 1.0F));
    colour *= 0.62F + 0.6F * hair;
    float size = 0;
    const float away = spot_distance(u, v, 16, 16, 9, size);
    if (top > 0.45F && top < 0.97F && away < 0.16F + 0.1F * size) colour = glm::vec3(0.95F, 0.90F, 0.80F);
    if (top > 0.985F) colour *= 0.35F;
    return glm::vec4(colour, 1);
  });
}

Texture deep_forest_texture(std::string name) {
  return paint_texture(std::move(name), 1024, 512, [](float u, float v) {
    const float leaves = value_noise(u, v, 160, 71) * 0.6F + value_noise(u, v, 44, 72) * 0.4F;
    glm::vec3 colour =
        glm::mix(glm::vec3(0.62F, 0.72F, 0.62F), glm::vec3(0.78F, 0.84F, 0.74F), value_noise(u, v, 7, 73));
    for (std::uint32_t layer = 0; layer < 3; ++layer) {  // from far to near
      const std::uint32_t columns = 34 - 8 * layer;
      const float near = static_cast<float>(layer), haze = 0.72F - 0.24F * near;
      const float x = u * static_cast<float>(columns) + 0.08F * value_noise(u, v, 6, 74 + layer);
      const std::uint32_t column = static_cast<std::uint32_t>(x) % columns;
      const float away = std::abs(x - std::floor(x) - random_between(0.3F, 0.7F, 75 + layer, column));
      const float half = random_between(0.05F, 0.16F, 78 + layer, column);
      if (away < half) {
        const float shade = (0.6F + 0.8F * value_noise(u, v, 90, 79)) * (1.15F - away / half * 0.4F);
        colour = glm::mix(glm::vec3(0.33F, 0.28F, 0.22F) * shade, glm::vec3(0.66F, 0.74F, 0.66F), haze);
      }
      const float crown = 0.30F + 0.12F * near - v + 0.5F * (value_noise(u, v, 12 + 4 * layer, 82 + layer) - 0.5F);
      const float shrub = v - 0.80F + 0.05F * near + 0.3F * (value_noise(u, v, 16 + 6 * layer, 86 + layer) - 0.5F);
      if (std::max(crown, shrub) > 0.22F * (leaves - 0.3F) + 0.05F * (2 - near)) {
        const glm::vec3 green = glm::mix(glm::vec3(0.10F, 0.19F, 0.06F), glm::vec3(0.50F, 0.60F, 0.24F), leaves);
        colour = glm::mix(green, glm::vec3(0.66F, 0.74F, 0.66F), haze * 0.85F);
      }
    }
    return glm::vec4(colour, 1);
  });
}

}  // namespace traces::forest
