#include "traces/scenes/village/landscape.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/plants.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::village {
namespace {

float step_between(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3 - 2 * t);
}

float smooth_bump(const glm::vec2& p, const glm::vec2& middle, float height, float radius) {
  const float d = glm::distance(p, middle) / radius;
  return height / ((1 + d * d) * (1 + d * d));
}

void set_planar_uvs(Mesh& mesh, float texture_size) {
  mesh.uvs.clear();
  for (const glm::vec3& p : mesh.positions) mesh.uvs.push_back(glm::vec2(p.x, p.z) / texture_size);
}

}  // namespace

float street_x(float z) { return 7 * sin_turns(static_cast<double>(z) / 150 + 0.04); }

float ground_height(float x, float z) {
  const glm::vec2 p(x, z);
  const float r = glm::length(p * glm::vec2(1.25F, 0.9F));
  const float rolling = 9 * (fractal_noise(glm::vec3(p / 75.0F, 3), 2, 11) - 0.5F) * step_between(38, 110, r);
  const float hills = (20 + 95 * fractal_noise(glm::vec3(p / 260.0F, 9), 3, 5)) * step_between(150, 620, r);
  return rolling + hills + smooth_bump(p, kMill, 17, 42) + smooth_bump(p, kChurch, 3.2F, 26);
}

Mesh make_land(std::string name, float from, float to, std::uint32_t round, std::uint32_t rings, float texture_size) {
  Mesh mesh = make_surface(
      std::move(name), round, rings,
      [&](float s, float t) {
        const glm::vec2 way = circle_point(static_cast<double>(s));
        const float r = from + (to - from) * t * (0.55F + 0.45F * t);
        return point_on_ground(r * way.x, r * way.y);
      },
      true);
  set_planar_uvs(mesh, texture_size);
  return mesh;
}

Mesh make_field(std::string name, const glm::vec2& middle, const glm::vec2& size, double turns, float above, float cell,
                float texture_size) {
  const glm::vec2 round = circle_point(turns);
  const auto cells = [cell](float length) { return std::max(static_cast<std::uint32_t>(length / cell), 4U); };
  Mesh mesh = make_surface(std::move(name), cells(size.x), cells(size.y), [&](float s, float t) {
    const glm::vec2 p = size * (glm::vec2(s, 1 - t) - 0.5F);
    return point_on_ground(middle.x + p.x * round.x - p.y * round.y, middle.y + p.x * round.y + p.y * round.x, above);
  });
  scale_uvs(mesh, size / texture_size);
  return mesh;
}

Mesh make_street(std::string name, float width, float cell, float texture_size) {
  const float length = kStreetStart - kStreetEnd;
  const auto rows = static_cast<std::uint32_t>(length / cell);
  Mesh mesh = make_surface(std::move(name), 6, rows, [&](float s, float t) {
    const float z = kStreetStart - t * length;
    const float edge = 0.35F * (value_noise(0.5F, z / 200 + 1, 150, 3) - 0.5F);
    const float x = street_x(z) + (s - 0.5F) * (width + edge);
    return point_on_ground(x, z, 0.03F + 0.25F * s * (1 - s));
  });
  scale_uvs(mesh, glm::vec2(width, length) / texture_size);
  return mesh;
}

Mesh make_square(std::string name, float radius, std::uint32_t round, float texture_size) {
  Mesh mesh = make_surface(
      std::move(name), round, std::max(round / 5, 3U),
      [&](float s, float t) {
        const glm::vec2 way = circle_point(static_cast<double>(s)) * (radius * (1 - t));
        return point_on_ground(kSquare.x + way.x, kSquare.y - way.y, 0.05F + 0.1F * t);
      },
      true);
  set_planar_uvs(mesh, texture_size);
  return mesh;
}

Texture countryside_texture(std::string name, std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [](float u, float v) {
    // Each point belongs to the field with the nearest centre. A hedge grows where two centres are about equally near.
    constexpr float kFields = 13;
    const float warp = 0.5F * value_noise(u, v, 20, 8);
    const glm::vec2 p(u * kFields + warp, v * kFields + 0.6F * value_noise(u, v, 17, 9));
    const glm::vec2 cell = glm::floor(p);
    float nearest = 9, second = 9;
    std::uint64_t which = 0;
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const glm::vec2 c = cell + glm::vec2(i, j);
        const auto a = static_cast<std::uint64_t>(static_cast<int>(c.x) + 64);
        const auto b = static_cast<std::uint64_t>(static_cast<int>(c.y) + 64);
        const glm::vec2 d = glm::abs(c + 0.2F + 0.6F * glm::vec2(random_unit(a, b, 1), random_unit(a, b, 2)) - p);
        const float away = d.x + d.y;
        if (away < nearest) {
          second = nearest;
          nearest = away;
          which = a * 131 + b;
        } else {
          second = std::min(second, away);
        }
      }
    }
    constexpr glm::vec3 kCrops[] = {{0.47F, 0.53F, 0.25F}, {0.42F, 0.50F, 0.24F}, {0.74F, 0.66F, 0.36F},
                                    {0.52F, 0.56F, 0.30F}, {0.55F, 0.46F, 0.33F}, {0.38F, 0.49F, 0.22F}};
    const float centre = glm::length(glm::vec2(u, v) - 0.5F);
    const float grain = 0.82F + 0.36F * value_noise(u, v, 190, 4);
    glm::vec3 colour = kCrops[which % std::size(kCrops)] * grain;
    const bool wood = value_noise(u, v, 14, 21) > 0.66F;
    if (wood || second - nearest < 0.07F)
      colour = glm::vec3(0.22F, 0.32F, 0.16F) * (0.6F + 0.8F * value_noise(u, v, 230, 5));
    const float near = 1 - step_between(0.19F, 0.25F, centre);
    colour = glm::mix(colour, glm::vec3(0.45F, 0.53F, 0.24F) * grain, near);
    return glm::vec4(glm::mix(colour, glm::vec3(0.60F, 0.68F, 0.70F), 0.42F * step_between(0.2F, 0.5F, centre)), 1);
  });
}

Texture haze_texture(std::string name, std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [](float u, float v) {
    const float centre = glm::length(glm::vec2(u, v) - 0.5F);
    const float woods = fractal_noise(u, v, 34, 4, 31);
    const glm::vec3 colour = glm::mix(glm::vec3(0.30F, 0.40F, 0.26F), glm::vec3(0.52F, 0.58F, 0.36F),
                                      std::clamp(5 * (woods - 0.45F), 0.0F, 1.0F));
    return glm::vec4(glm::mix(colour, glm::vec3(0.60F, 0.69F, 0.76F), 0.42F + 0.4F * step_between(0.2F, 0.5F, centre)),
                     1);
  });
}

Texture grass_texture(std::string name) {
  return paint_texture(std::move(name), 1024, 1024, [](float u, float v) {
    const float meadow = fractal_noise(u, v, 5, 3, 41);
    const float blades = value_noise(u, v, 340, 43);
    const float tuft = value_noise(u, v, 90, 44);
    glm::vec3 colour = glm::mix(glm::vec3(0.33F, 0.43F, 0.15F), glm::vec3(0.56F, 0.62F, 0.28F), meadow);
    colour *= 0.62F + 0.45F * blades + 0.25F * tuft;
    if (random_unit(static_cast<std::uint64_t>(u * 600), static_cast<std::uint64_t>(v * 600), 46) > 0.9985F) {
      colour = tuft > 0.5F ? glm::vec3(0.95F, 0.9F, 0.55F) : glm::vec3(0.95F);
    }
    return glm::vec4(colour, 1);
  });
}

Texture cobble_texture(std::string name, std::uint32_t stones) {
  return paint_texture(std::move(name), 512, 512, [stones](float u, float v) {
    const float n = static_cast<float>(stones);
    const float y = v * n;
    const auto row = static_cast<std::uint32_t>(y);
    const float x = u * n + (row % 2 == 0 ? 0.0F : 0.5F);
    const std::uint32_t column = static_cast<std::uint32_t>(x) % stones;
    const glm::vec2 in(x - std::floor(x) - 0.5F, y - std::floor(y) - 0.5F);
    const float away = glm::length(in * glm::vec2(1, 1.1F)) + 0.16F * (value_noise(u, v, 4 * stones, 51) - 0.5F);
    const float shade = 0.7F + 0.4F * random_unit(row, column, 52);
    const glm::vec3 stone =
        glm::mix(glm::vec3(0.62F, 0.58F, 0.53F), glm::vec3(0.66F, 0.56F, 0.46F), random_unit(row, column, 53));
    const glm::vec3 earth = glm::vec3(0.38F, 0.33F, 0.26F) * (0.7F + 0.6F * value_noise(u, v, 120, 54));
    return glm::vec4(glm::mix(stone * shade * (1.1F - 0.5F * away), earth, step_between(0.42F, 0.52F, away)), 1);
  });
}

Texture crop_texture(std::string name, const glm::vec3& crop, const glm::vec3& soil, std::uint32_t rows,
                     std::uint32_t seed) {
  return paint_texture(std::move(name), 512, 512, [&](float u, float v) {
    const float sway = 0.12F * (value_noise(u, v, 6, seed) - 0.5F);
    const float wave = 0.5F + 0.5F * cos_turns(static_cast<double>((u + sway / 8) * static_cast<float>(rows)));
    const float plants = value_noise(u, v, 150, seed + 1);
    const float there = std::clamp(1.8F * wave - 0.5F + (plants - 0.5F), 0.0F, 1.0F);
    return glm::vec4(glm::mix(soil, crop, there) * (0.7F + 0.45F * value_noise(u, v, 210, seed + 2)), 1);
  });
}

namespace {

enum Kind : std::uint32_t { kOak, kPoplar, kApple, kSpruce, kBirch, kMaple, kBush, kRoses, kKinds };

struct Species {
  const char* name;
  TreeShape shape;  ///< shape of the tree; a bush if the height is 0
  LeafShape leaf;
  glm::vec3 dark, light;
  float weight;  ///< fraction of all leaves that the plant gets
};

const Species kSpecies[kKinds] = {
    {"oak",
     {.height = 10.5F,
      .girth = 0.42F,
      .bare = 0.26F,
      .reach = 5,
      .rise = 0.45F,
      .crooked = 0.24F,
      .branches = 13,
      .twigs = 7,
      .seed = 3},
     {.length = 0.58F, .width = 0.42F, .scatter = 0.55F},
     {0.20F, 0.30F, 0.08F},
     {0.46F, 0.56F, 0.20F},
     1.5F},
    {"poplar",
     {.height = 14,
      .girth = 0.28F,
      .bare = 0.1F,
      .reach = 2.3F,
      .rise = 2.1F,
      .crooked = 0.1F,
      .branches = 17,
      .twigs = 5,
      .seed = 5},
     {.length = 0.46F, .width = 0.36F, .scatter = 0.45F},
     {0.24F, 0.36F, 0.12F},
     {0.52F, 0.62F, 0.26F},
     1},
    {"apple tree",
     {.height = 4.8F,
      .girth = 0.2F,
      .bare = 0.28F,
      .reach = 2.5F,
      .rise = 0.5F,
      .crooked = 0.3F,
      .branches = 9,
      .twigs = 6,
      .seed = 7},
     {.length = 0.34F, .width = 0.25F, .scatter = 0.34F},
     {0.26F, 0.38F, 0.14F},
     {0.55F, 0.66F, 0.28F},
     0.7F},
    {"spruce",
     {.height = 13,
      .girth = 0.3F,
      .bare = 0.07F,
      .reach = 3.2F,
      .rise = -0.22F,
      .taper = 1,
      .crooked = 0.07F,
      .branches = 30,
      .twigs = 2,
      .seed = 9},
     {.length = 0.66F, .width = 0.17F, .scatter = 0.14F, .along = 0.75F},
     {0.09F, 0.20F, 0.11F},
     {0.26F, 0.40F, 0.22F},
     1.2F},
    {"birch",
     {.height = 9.5F,
      .girth = 0.17F,
      .bare = 0.25F,
      .reach = 2.7F,
      .rise = 0.9F,
      .crooked = 0.16F,
      .branches = 13,
      .twigs = 5,
      .seed = 11},
     {.length = 0.36F, .width = 0.28F, .scatter = 0.45F},
     {0.40F, 0.50F, 0.16F},
     {0.68F, 0.72F, 0.30F},
     0.9F},
    {"maple",
     {.height = 8.5F,
      .girth = 0.3F,
      .bare = 0.28F,
      .reach = 3.7F,
      .rise = 0.55F,
      .crooked = 0.2F,
      .branches = 12,
      .twigs = 6,
      .seed = 13},
     {.length = 0.5F, .width = 0.44F, .scatter = 0.5F},
     {0.52F, 0.26F, 0.08F},
     {0.86F, 0.58F, 0.18F},
     1.1F},
    {"bush",
     {.height = 0},
     {.length = 0.2F, .width = 0.13F, .scatter = 0.16F},
     {0.18F, 0.30F, 0.09F},
     {0.42F, 0.54F, 0.20F},
     0.28F},
    {"roses",
     {.height = 0},
     {.length = 0.14F, .width = 0.11F, .scatter = 0.12F},
     {0.20F, 0.36F, 0.13F},
     {0.46F, 0.58F, 0.24F},
     0.22F},
};

struct Planted {
  Kind kind;
  glm::mat4 at;
};

/// Returns the places of all plants.
std::vector<Planted> plant_places() {
  std::vector<Planted> all;
  const auto put = [&all](Kind kind, float x, float z, float size = 1) {
    const auto key = all.size();
    const float grown = size * random_between(0.88F, 1.14F, 17, key);
    all.push_back({kind, placement_at(point_on_ground(x, z), static_cast<double>(random_unit(18, key)),
                                      glm::vec3(grown, grown * random_between(0.92F, 1.1F, 19, key), grown))});
  };
  put(kOak, 8.2F, -14.5F, 0.95F);
  put(kBirch, -10, -17);
  put(kMaple, -13, 7.5F, 0.9F);
  put(kMaple, 16, 6);
  for (int k = 0; k < 4; ++k) {  // an orchard
    for (int i = 0; i < 3; ++i) {
      put(kApple, -24 - 6.0F * static_cast<float>(i) + random_unit(1, static_cast<std::uint64_t>(k)),
          52 + 6.5F * static_cast<float>(k) + random_unit(2, static_cast<std::uint64_t>(i)));
    }
  }
  for (int k = 0; k < 5; ++k) put(kPoplar, 37.5F, 54 - 9.0F * static_cast<float>(k));
  put(kBirch, street_x(64) + 7, 65);
  put(kBirch, street_x(36) - 8, 36);
  put(kMaple, street_x(50) - 15, 49.5F);
  put(kOak, street_x(23) + 17, 24);
  put(kOak, street_x(82) - 9.5F, 84, 0.9F);
  put(kBirch, -20, 22);
  put(kBirch, street_x(-17) + 11, -19.5F);
  const glm::vec2 yard[] = {{-14, 12}, {13, 13}, {13.5F, -2}, {-13, -4}, {9, -14}, {-10, -16}, {0, -21}};
  for (const glm::vec2& p : yard) put(p.y > 0 ? kOak : kSpruce, kChurch.x + p.x, kChurch.y + p.y);
  const glm::vec2 hill[] = {{14, 4}, {18, -6}, {-14, 6}, {-10, -15}, {6, -17}, {22, 12}};
  for (const glm::vec2& p : hill) put(kSpruce, kMill.x + p.x, kMill.y + p.y);
  const glm::vec2 apart[] = {{33, -62}, {44, -70}, {24, -74},  {84, 5},    {-92, 12},
                             {-88, 74}, {82, -66}, {-40, -44}, {-36, -90}, {88, 62}};
  for (std::size_t k = 0; k < std::size(apart); ++k) {
    put(k % 3 == 2 ? kMaple : (k % 3 == 1 ? kBirch : kOak), apart[k].x, apart[k].y, 1.1F);
  }
  for (const float side : {-1.0F, 1.0F}) {  // front gardens
    for (int k = 0; k < 11; ++k) {
      const float z = 77 - 5.6F * static_cast<float>(k);
      put(k % 3 == 1 ? kRoses : kBush, street_x(z) + side * 5, z + 2 * random_unit(4, static_cast<std::uint64_t>(k)));
    }
  }
  for (int k = 0; k < 14; ++k)
    put(kBush, -45 + 0.5F * random_unit(5, static_cast<std::uint64_t>(k)), 12 - 4.0F * static_cast<float>(k), 1.3F);
  for (int k = 0; k < 12; ++k)
    put(kBush, 20 + 1.2F * static_cast<float>(k), 70.5F + random_unit(6, static_cast<std::uint64_t>(k)), 1.1F);
  for (int k = 0; k < 4; ++k) put(kRoses, kSquare.x - 7.2F, kSquare.y - 4 + 3.0F * static_cast<float>(k), 0.8F);
  return all;
}

/// Adds woods on the hills, which are only seen from afar: rounded crowns on stems.
void add_far_trees(Scene& scene, std::uint32_t leaves, std::uint32_t bark, float detail) {
  const auto cells = std::max(static_cast<std::uint32_t>(7 * detail), 4U);
  Mesh crown = make_rock("far tree", {2.8F, 3.6F, 2.8F}, cells, 0.45F, 3);
  for (glm::vec3& p : crown.positions) p.y += 1.2F;
  const std::uint32_t mesh = add_mesh(scene, std::move(crown), leaves);
  const std::uint32_t trunk = add_mesh(scene, make_cone("far stem", 0.3F, 0.2F, 2.5F, 5), bark);
  const auto count = std::max(static_cast<std::uint32_t>(150 * detail), 60U);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint64_t grove = k / 10;
    const float way = random_unit(61, grove), out = random_between(150, 330, 62, grove);
    const glm::vec2 round{2 * way - 1, random_unit(63, grove) < 0.5F ? -1.0F : 1.0F};
    const glm::vec2 middle = glm::normalize(random_unit(64, grove) < 0.5F ? round : glm::vec2(round.y, round.x)) * out;
    const glm::vec2 p = middle + 42.0F * (glm::vec2(random_unit(65, k), random_unit(66, k)) - 0.5F);
    const float size = random_between(0.9F, 1.7F, 67, k);
    const glm::mat4 at =
        placement_at(point_on_ground(p.x, p.y, -0.3F), static_cast<double>(random_unit(68, k)), glm::vec3(size));
    add_instance(scene, mesh, at);
    add_instance(scene, trunk, at);
  }
}

void add_blossoms(Scene& scene, const std::vector<Planted>& plants) {
  const std::uint32_t petals = add_material(scene, make_paint("rose petals", {0.75F, 0.08F, 0.12F}));
  const std::vector<Twig> stems = dome_twigs({0.82F, 1.04F, 0.82F}, 26, 7);
  const LeafShape petal{.length = 0.15F, .width = 0.15F, .scatter = 0.1F};
  const std::uint32_t blossom =
      add_mesh(scene, make_leaves("rose blossoms", stems, 60, petal, glm::vec3(0), 5), petals);
  for (const Planted& plant : plants) {
    if (plant.kind == kRoses) add_instance(scene, blossom, plant.at);
  }
}

/// Adds the leaves of all plants, with all triangles that remain.
void add_leaves(Scene& scene, std::uint32_t triangles, float detail, const std::vector<Planted>& plants,
                const std::vector<std::vector<Twig>>& twigs, const std::vector<std::uint32_t>& materials) {
  float weight = 0;
  for (std::uint32_t k = 0; k < kKinds; ++k) {
    for (const Planted& plant : plants) weight += plant.kind == k ? kSpecies[k].weight : 0;
  }
  const auto used = static_cast<float>(count_triangles(scene));
  const float left = std::max(static_cast<float>(triangles) - used, 0.02F * static_cast<float>(triangles));
  for (std::uint32_t k = 0; k < kKinds; ++k) {
    const Species& kind = kSpecies[k];
    const auto count = std::max(static_cast<std::uint32_t>(left / 2 * kind.weight / weight), 24U);
    LeafShape leaf = kind.leaf;
    // With fewer leaves each is larger, so that the crown remains equally dense.
    const float grown = std::min(1 / std::min(detail, 2.0F), 2.6F);
    leaf.length *= grown;
    leaf.width *= grown;
    const glm::vec3 centre(0, 0.55F * kind.shape.height, 0);
    const std::uint32_t mesh = add_mesh(
        scene, make_leaves(std::string(kind.name) + " leaves", twigs[k], count, leaf, centre, 200 + k), materials[k]);
    for (const Planted& plant : plants) {
      if (plant.kind == k) add_instance(scene, mesh, plant.at);
    }
  }
}

}  // namespace

void add_garden(Scene& scene, std::uint32_t triangles, float detail) {
  const std::uint32_t bark =
      add_textured(scene, bark_texture("bark", {0.27F, 0.21F, 0.16F}, {0.55F, 0.47F, 0.38F}, 9, 81, 256));
  const std::uint32_t white_bark =
      add_textured(scene, bark_texture("birch bark", {0.35F, 0.33F, 0.30F}, {0.97F, 0.95F, 0.90F}, 3, 82, 256));
  const std::vector<Planted> plants = plant_places();
  std::vector<std::vector<Twig>> twigs;
  std::vector<std::uint32_t> leaf_material;
  for (std::uint32_t k = 0; k < kKinds; ++k) {
    const Species& kind = kSpecies[k];
    leaf_material.push_back(
        add_textured(scene, foliage_texture(std::string(kind.name) + " leaves", kind.dark, kind.light, 90 + k)));
    if (kind.shape.height > 0) {
      TreeShape shape = kind.shape;
      shape.branches =
          std::max(static_cast<std::uint32_t>(static_cast<float>(shape.branches) * std::min(detail, 1.5F)), 6U);
      shape.twigs = std::max(static_cast<std::uint32_t>(static_cast<float>(shape.twigs) * std::min(detail, 1.5F)), 2U);
      shape.sides = std::max(static_cast<std::uint32_t>(8 * std::min(detail, 2.0F)), 4U);
      Tree tree = make_tree(kind.name, shape);
      const std::uint32_t mesh = add_mesh(scene, std::move(tree.wood), k == kBirch ? white_bark : bark);
      for (const Planted& plant : plants) {
        if (plant.kind == k) add_instance(scene, mesh, plant.at);
      }
      twigs.push_back(std::move(tree.twigs));
    } else {
      twigs.push_back(dome_twigs(k == kBush ? glm::vec3(1.05F, 1.25F, 1.05F) : glm::vec3(0.8F, 1, 0.8F), 60, k));
    }
  }
  add_far_trees(scene, leaf_material[kOak], bark, detail);
  add_blossoms(scene, plants);
  add_leaves(scene, triangles, detail, plants, twigs, leaf_material);
}

}  // namespace traces::village
