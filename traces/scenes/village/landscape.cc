#include "traces/scenes/village/landscape.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::village {
namespace {

float step_between(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3 - 2 * t);
}

float bump(const glm::vec2& p, const glm::vec2& middle, float height, float radius) {
  const float d = glm::distance(p, middle) / radius;
  return height / ((1 + d * d) * (1 + d * d));
}

void planar_uvs(Mesh& mesh, float texture_size) {
  mesh.uvs.clear();
  for (const glm::vec3& p : mesh.positions) mesh.uvs.push_back(glm::vec2(p.x, p.z) / texture_size);
}

}  // namespace

float street_x(float z) { return 7 * sin_turns(static_cast<double>(z) / 150 + 0.04); }

float ground(float x, float z) {
  const glm::vec2 p(x, z);
  const float r = glm::length(p * glm::vec2(1.25F, 0.9F));
  const float rolling = 9 * (fractal(glm::vec3(p / 75.0F, 3), 2, 11) - 0.5F) * step_between(38, 110, r);
  const float hills = (20 + 95 * fractal(glm::vec3(p / 260.0F, 9), 3, 5)) * step_between(150, 620, r);
  return rolling + hills + bump(p, kMill, 17, 42) + bump(p, kChurch, 3.2F, 26);
}

Mesh make_land(std::string name, float from, float to, std::uint32_t round, std::uint32_t rings, float texture_size) {
  Mesh mesh = make_surface(
      std::move(name), round, rings,
      [&](float s, float t) {
        const glm::vec2 way = on_circle(static_cast<double>(s));
        const float r = from + (to - from) * t * (0.55F + 0.45F * t);
        return on_ground(r * way.x, r * way.y);
      },
      true);
  planar_uvs(mesh, texture_size);
  return mesh;
}

Mesh make_field(std::string name, const glm::vec2& middle, const glm::vec2& size, double turns, float above, float cell,
                float texture_size) {
  const glm::vec2 round = on_circle(turns);
  const auto cells = [cell](float length) { return std::max(static_cast<std::uint32_t>(length / cell), 4U); };
  Mesh mesh = make_surface(std::move(name), cells(size.x), cells(size.y), [&](float s, float t) {
    const glm::vec2 p = size * (glm::vec2(s, 1 - t) - 0.5F);
    return on_ground(middle.x + p.x * round.x - p.y * round.y, middle.y + p.x * round.y + p.y * round.x, above);
  });
  scale_uvs(mesh, size / texture_size);
  return mesh;
}

Mesh make_street(std::string name, float width, float cell, float texture_size) {
  const float length = kStreetStart - kStreetEnd;
  const auto rows = static_cast<std::uint32_t>(length / cell);
  Mesh mesh = make_surface(std::move(name), 6, rows, [&](float s, float t) {
    const float z = kStreetStart - t * length;
    const float edge = 0.35F * (noise(0.5F, z / 200 + 1, 150, 3) - 0.5F);
    const float x = street_x(z) + (s - 0.5F) * (width + edge);
    return on_ground(x, z, 0.03F + 0.25F * s * (1 - s));
  });
  scale_uvs(mesh, glm::vec2(width, length) / texture_size);
  return mesh;
}

Mesh make_square(std::string name, float radius, std::uint32_t round, float texture_size) {
  Mesh mesh = make_surface(
      std::move(name), round, std::max(round / 5, 3U),
      [&](float s, float t) {
        const glm::vec2 way = on_circle(static_cast<double>(s)) * (radius * (1 - t));
        return on_ground(kSquare.x + way.x, kSquare.y - way.y, 0.05F + 0.1F * t);
      },
      true);
  planar_uvs(mesh, texture_size);
  return mesh;
}

Texture countryside_texture(std::string name, std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [](float u, float v) {
    // Each point belongs to the nearest of a grid of shifted centres; where two are equally near, a hedge grows.
    constexpr float kFields = 13;
    const float warp = 0.5F * noise(u, v, 20, 8);
    const glm::vec2 p(u * kFields + warp, v * kFields + 0.6F * noise(u, v, 17, 9));
    const glm::vec2 cell = glm::floor(p);
    float nearest = 9, second = 9;
    std::uint64_t which = 0;
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const glm::vec2 c = cell + glm::vec2(i, j);
        const auto a = static_cast<std::uint64_t>(static_cast<int>(c.x) + 64);
        const auto b = static_cast<std::uint64_t>(static_cast<int>(c.y) + 64);
        const glm::vec2 d = glm::abs(c + 0.2F + 0.6F * glm::vec2(random(a, b, 1), random(a, b, 2)) - p);
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
    const float grain = 0.82F + 0.36F * noise(u, v, 190, 4);
    glm::vec3 colour = kCrops[which % std::size(kCrops)] * grain;
    const bool wood = noise(u, v, 14, 21) > 0.66F;
    if (wood || second - nearest < 0.07F) colour = glm::vec3(0.22F, 0.32F, 0.16F) * (0.6F + 0.8F * noise(u, v, 230, 5));
    const float near = 1 - step_between(0.19F, 0.25F, centre);
    colour = glm::mix(colour, glm::vec3(0.45F, 0.53F, 0.24F) * grain, near);
    return glm::vec4(glm::mix(colour, glm::vec3(0.60F, 0.68F, 0.70F), 0.42F * step_between(0.2F, 0.5F, centre)), 1);
  });
}

Texture haze_texture(std::string name, std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [](float u, float v) {
    const float centre = glm::length(glm::vec2(u, v) - 0.5F);
    const float woods = fractal(u, v, 34, 4, 31);
    const glm::vec3 colour = glm::mix(glm::vec3(0.30F, 0.40F, 0.26F), glm::vec3(0.52F, 0.58F, 0.36F),
                                      std::clamp(5 * (woods - 0.45F), 0.0F, 1.0F));
    return glm::vec4(glm::mix(colour, glm::vec3(0.60F, 0.69F, 0.76F), 0.42F + 0.4F * step_between(0.2F, 0.5F, centre)),
                     1);
  });
}

Texture grass_texture(std::string name) {
  return paint_texture(std::move(name), 1024, 1024, [](float u, float v) {
    const float meadow = fractal(u, v, 5, 3, 41);
    const float blades = noise(u, v, 340, 43);
    const float tuft = noise(u, v, 90, 44);
    glm::vec3 colour = glm::mix(glm::vec3(0.33F, 0.43F, 0.15F), glm::vec3(0.56F, 0.62F, 0.28F), meadow);
    colour *= 0.62F + 0.45F * blades + 0.25F * tuft;
    if (random(static_cast<std::uint64_t>(u * 600), static_cast<std::uint64_t>(v * 600), 46) > 0.9985F) {
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
    const float away = glm::length(in * glm::vec2(1, 1.1F)) + 0.16F * (noise(u, v, 4 * stones, 51) - 0.5F);
    const float shade = 0.7F + 0.4F * random(row, column, 52);
    const glm::vec3 stone =
        glm::mix(glm::vec3(0.62F, 0.58F, 0.53F), glm::vec3(0.66F, 0.56F, 0.46F), random(row, column, 53));
    const glm::vec3 earth = glm::vec3(0.38F, 0.33F, 0.26F) * (0.7F + 0.6F * noise(u, v, 120, 54));
    return glm::vec4(glm::mix(stone * shade * (1.1F - 0.5F * away), earth, step_between(0.42F, 0.52F, away)), 1);
  });
}

Texture crop_texture(std::string name, const glm::vec3& crop, const glm::vec3& soil, std::uint32_t rows,
                     std::uint32_t seed) {
  return paint_texture(std::move(name), 512, 512, [&](float u, float v) {
    const float sway = 0.12F * (noise(u, v, 6, seed) - 0.5F);
    const float wave = 0.5F + 0.5F * cos_turns(static_cast<double>((u + sway / 8) * static_cast<float>(rows)));
    const float plants = noise(u, v, 150, seed + 1);
    const float there = std::clamp(1.8F * wave - 0.5F + (plants - 0.5F), 0.0F, 1.0F);
    return glm::vec4(glm::mix(soil, crop, there) * (0.7F + 0.45F * noise(u, v, 210, seed + 2)), 1);
  });
}

}  // namespace traces::village
