#include "traces/scenes/modelling/plants.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces {
namespace {

constexpr double kGolden = 0.38196601125;  // turns between one branch and the next

glm::vec3 any_direction(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  const float y = random_between(-1, 1, a, b, c);
  const glm::vec2 round = circle_point(static_cast<double>(random_unit(b, c, a + 77)));
  const float r = std::sqrt(std::max(1 - y * y, 0.0F));
  return {r * round.x, y, r * round.y};
}

glm::vec3 any_perpendicular(const glm::vec3& along) {
  return glm::normalize(glm::cross(along, std::abs(along.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
}

struct Wood {
  std::vector<glm::vec3> path;
  std::vector<float> radii;

  glm::vec3 at(float share) const {
    const float x = share * static_cast<float>(path.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(x), path.size() - 2);
    return glm::mix(path[k], path[k + 1], x - static_cast<float>(k));
  }
  float radius_at(float share) const { return radii[0] * (1 - share) + radii.back() * share; }
};

/// Makes a branch from `foot` to `foot + along`. Each point strays from the straight line by up to half of `crooked`
/// times the length; the tip rises by `lift` times the length.
Wood grow_branch(const glm::vec3& foot, const glm::vec3& along, float radius, float crooked, float lift,
                 std::uint32_t steps, std::uint64_t seed) {
  Wood wood;
  const float length = glm::length(along);
  for (std::uint32_t k = 0; k <= steps; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(steps);
    const glm::vec3 stray = k == 0 ? glm::vec3(0) : any_direction(seed, k, 5) * (crooked * length * 0.5F * t);
    wood.path.push_back(foot + along * t + glm::vec3(0, lift * length * t * t, 0) + stray);
    wood.radii.push_back(k == steps ? 0 : radius * (1 - 0.9F * t));
  }
  return wood;
}

void add_wood(Mesh& mesh, const Wood& wood, std::uint32_t sides, float bark) {
  Mesh tube = make_tube("", wood.path, wood.radii, sides);
  float length = 0;
  for (std::size_t k = 1; k < wood.path.size(); ++k) length += glm::distance(wood.path[k], wood.path[k - 1]);
  scale_uvs(tube, {1, std::max(length / bark, 0.1F)});
  append_mesh(mesh, tube);
}

/// Returns the length of a branch at height `share` of the crown, from 0 (lowest branch) to 1.
float branch_length(const TreeShape& s, float share) {
  const float round = 0.45F + 2.2F * share * (1 - share);
  return s.reach * glm::mix(round, 1.02F - 0.93F * share, s.taper);
}

}  // namespace

Tree make_tree(std::string name, const TreeShape& s, float bark) {
  Tree tree;
  tree.wood.name = std::move(name);
  Wood trunk = grow_branch(glm::vec3(0, -0.3F, 0), {0, s.height + 0.3F, 0}, s.girth, s.crooked * 0.4F, 0, 9, s.seed);
  trunk.radii[0] = s.girth * 1.45F;
  trunk.radii[1] = s.girth * 0.95F;
  add_wood(tree.wood, trunk, s.sides, bark);
  trunk.radii[0] = s.girth;
  for (std::uint32_t b = 0; b < s.branches; ++b) {
    const float share = (static_cast<float>(b) + 0.5F) / static_cast<float>(s.branches);
    const float at = s.bare + (1 - s.bare) * 0.97F * share;
    const glm::vec2 round = circle_point(kGolden * b + static_cast<double>(0.1F * random_unit(s.seed, b, 1)));
    const float rise = s.rise + (1 - s.taper) * 0.9F * share * share + 0.15F * (random_unit(s.seed, b, 2) - 0.5F);
    const glm::vec3 way = glm::normalize(glm::vec3(round.x, rise, round.y));
    const float length = branch_length(s, share) * random_between(0.85F, 1.1F, s.seed, b, 3);
    const float radius = std::min(trunk.radius_at(at) * 0.6F, 0.028F * length + 0.01F);
    const Wood branch = grow_branch(trunk.at(at), way * length, radius, s.crooked, 0.12F, 4, s.seed * 131 + b);
    add_wood(tree.wood, branch, std::max(s.sides * 5 / 8, 3U), bark);
    for (std::uint32_t k = 0; k < s.twigs; ++k) {
      const float from = 0.3F + 0.68F * (static_cast<float>(k) + 0.5F) / static_cast<float>(s.twigs);
      const glm::vec3 stray = any_direction(s.seed + 9, b, k);
      const glm::vec3 heading =
          glm::normalize(way * 0.75F + glm::vec3(stray.x, stray.y * (1 - s.taper) * 0.8F, stray.z) * 0.9F);
      const float reach = length * (1.05F - 0.75F * from) * random_between(0.5F, 0.8F, s.seed, b, k + 40);
      const Wood twig = grow_branch(branch.at(from), heading * reach, branch.radius_at(from) * 0.5F, s.crooked, 0.08F,
                                    2, s.seed * 977 + b * 64 + k);
      add_wood(tree.wood, twig, 3, bark);
      tree.twigs.push_back({twig.path.front(), twig.path.back()});
    }
    tree.twigs.push_back({branch.at(0.55F), branch.path.back()});
  }
  tree.twigs.push_back({trunk.at(0.88F), trunk.path.back()});
  return tree;
}

void add_leaf(Mesh& mesh, const glm::vec3& foot, const glm::vec3& length, const glm::vec3& half_width,
              const glm::vec3& normal, const glm::vec2& uv, float uv_size) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const glm::vec3 middle = foot + 0.45F * length;
  const glm::vec3 face = glm::cross(half_width, length);
  const bool up = glm::dot(face, normal) >= 0;
  const glm::vec3 right = up ? half_width : -half_width;
  const glm::vec3 lift = glm::normalize(up ? face : -face) * (0.25F * glm::length(half_width));
  mesh.positions.insert(mesh.positions.end(), {foot, middle + right + lift, foot + length, middle - right + lift});
  const glm::vec3 shown = glm::normalize(glm::normalize(up ? face : -face) + 0.6F * normal);
  mesh.normals.insert(mesh.normals.end(), 4, shown);
  mesh.uvs.insert(mesh.uvs.end(), {uv, uv + glm::vec2(uv_size, uv_size), uv + glm::vec2(0, 2 * uv_size),
                                   uv + glm::vec2(-uv_size, uv_size)});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

Mesh make_leaves(std::string name, std::span<const Twig> twigs, std::uint32_t count, const LeafShape& shape,
                 const glm::vec3& centre, std::uint64_t seed) {
  Mesh mesh;
  mesh.name = std::move(name);
  mesh.positions.reserve(std::size_t{count} * 4);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Twig& twig = twigs[i % twigs.size()];
    const glm::vec3 stem = glm::normalize(twig.tip - twig.foot);
    const glm::vec3 stray = any_direction(seed, i, 1);
    const glm::vec3 foot = glm::mix(twig.foot, twig.tip, 0.1F + 0.9F * random_unit(seed, i, 2)) +
                           stray * (shape.scatter * random_unit(seed, i, 3));
    const glm::vec3 outward = glm::normalize(foot - centre + glm::vec3(0, 1e-3F, 0));
    const glm::vec3 along = glm::normalize(stem * shape.along + any_direction(seed, i, 4) * (1 - shape.along * 0.6F) +
                                           outward * 0.35F + glm::vec3(0, -0.15F, 0));
    const glm::vec3 side = glm::normalize(
        glm::cross(along, glm::normalize(outward + glm::vec3(0, 0.5F, 0) + 0.8F * any_direction(seed, i, 5))) +
        1e-3F * any_perpendicular(along));
    const float size = random_between(0.7F, 1.25F, seed, i, 6);
    add_leaf(mesh, foot, along * (shape.length * size), side * (0.5F * shape.width * size), outward,
             {random_unit(seed, i, 7), random_unit(seed, i, 8)}, 0.06F);
  }
  return mesh;
}

std::vector<Twig> dome_twigs(const glm::vec3& radii, std::uint32_t count, std::uint64_t seed) {
  std::vector<Twig> twigs;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float y = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
    const glm::vec2 round = circle_point(kGolden * i);
    const float r = std::sqrt(1 - y * y);
    const glm::vec3 tip = glm::vec3(r * round.x, y, r * round.y) * radii * random_between(0.8F, 1.1F, seed, i);
    twigs.push_back({tip * 0.45F, tip});
  }
  return twigs;
}

Mesh make_grass(std::string name, std::uint32_t blades, std::uint32_t segments, float radius, float height, float width,
                std::uint64_t seed) {
  Mesh mesh;
  mesh.name = std::move(name);
  for (std::uint32_t i = 0; i < blades; ++i) {
    const glm::vec2 root =
        circle_point(static_cast<double>(random_unit(seed, i, 1))) * (radius * std::sqrt(random_unit(seed, i, 2)));
    const glm::vec2 lean =
        circle_point(static_cast<double>(random_unit(seed, i, 3))) * random_between(0.1F, 0.6F, seed, i, 4);
    const float tall = height * random_between(0.5F, 1, seed, i, 5);
    const glm::vec2 turn = circle_point(static_cast<double>(random_unit(seed, i, 6)));
    const glm::vec3 side(turn.x * width * 0.5F, 0, turn.y * width * 0.5F);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const glm::vec2 uv(random_unit(seed, i, 7), random_unit(seed, i, 8));
    for (std::uint32_t k = 0; k <= segments; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(segments);
      const glm::vec3 spine(root.x + lean.x * tall * t * t, tall * t * (1 - 0.25F * t) - 0.02F,
                            root.y + lean.y * tall * t * t);
      const glm::vec3 normal =
          glm::normalize(glm::cross(side, glm::vec3(2 * lean.x * t, 1 - 0.5F * t, 2 * lean.y * t)));
      for (const float s : {-1.0F, 1.0F}) {
        if (k == segments && s > 0) break;
        mesh.positions.push_back(k == segments ? spine : spine + side * (s * (1 - t)));
        mesh.normals.push_back(normal);
        mesh.uvs.push_back(uv + glm::vec2(0.02F * s, 0.1F * t));
      }
      if (k == segments) {
        mesh.triangles.push_back({first + 2 * k - 2, first + 2 * k - 1, first + 2 * k});
      } else if (k > 0) {
        mesh.triangles.push_back({first + 2 * k - 2, first + 2 * k - 1, first + 2 * k + 1});
        mesh.triangles.push_back({first + 2 * k - 2, first + 2 * k + 1, first + 2 * k});
      }
    }
  }
  return mesh;
}

Mesh make_rock(std::string name, const glm::vec3& radii, std::uint32_t cells, float rough, std::uint32_t seed) {
  Mesh mesh = make_surface(
      std::move(name), 2 * cells, cells,
      [&](float s, float t) {
        const glm::vec2 round = circle_point(-static_cast<double>(s));
        const float y = -cos_turns(static_cast<double>(t) / 2);
        const float r = t <= 0 || t >= 1 ? 0.0F : sin_turns(static_cast<double>(t) / 2);
        const glm::vec3 way(r * round.x, y, r * round.y);
        const float push = 1 + rough * (2 * fractal_noise(way * 1.6F + 40.0F, 4, seed) - 1);
        return way * radii * push + glm::vec3(0, 0.6F * radii.y, 0);
      },
      true);
  scale_uvs(mesh, {3, 1.5F});
  return mesh;
}

Texture foliage_texture(std::string name, const glm::vec3& dark, const glm::vec3& light, std::uint32_t seed,
                        std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [&](float u, float v) {
    const float patch = fractal_noise(u, v, 9, 3, seed);
    const float vein = std::abs(value_noise(u, v, 40, seed + 7) - 0.5F) * 2;
    return glm::vec4(glm::mix(dark, light, std::clamp(2.2F * patch - 0.75F + 0.25F * vein, 0.0F, 1.0F)), 1);
  });
}

Texture bark_texture(std::string name, const glm::vec3& dark, const glm::vec3& light, std::uint32_t furrows,
                     std::uint32_t seed, std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [&](float u, float v) {
    const float bend = 0.9F * fractal_noise(u, v, 5, 4, seed) / static_cast<float>(furrows) * 6;
    const float x = (u + bend) * static_cast<float>(furrows);
    const float ridge = 0.5F + 0.5F * cos_turns(static_cast<double>(x));
    const float crack = value_noise(u, v, 11, seed + 3) * value_noise(u, v, 37, seed + 4);
    const float grain = fractal_noise(u, v, 48, 3, seed + 5);
    return glm::vec4(glm::mix(dark, light, std::clamp(0.75F * ridge * (0.4F + grain) + 0.5F * crack, 0.0F, 1.0F)), 1);
  });
}

}  // namespace traces
