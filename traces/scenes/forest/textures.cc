#include "traces/scenes/forest/textures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::forest {
namespace {

std::uint32_t packed(const glm::vec3& c) {
  const auto byte = [](float x) { return static_cast<std::uint32_t>(std::clamp(x, 0.0F, 1.0F) * 255 + 0.5F); };
  return byte(c.x) | (byte(c.y) << 8) | (byte(c.z) << 16) | 0xff000000U;
}

/// Returns the distance, in cells, to the nearest point of a repeating jittered grid; v cells are as long as u cells.
float spots(float u, float v, std::uint32_t columns, std::uint32_t rows, std::uint32_t seed, float& size) {
  const glm::vec2 p(u * static_cast<float>(columns), v * static_cast<float>(rows));
  const glm::vec2 cell = glm::floor(p);
  float nearest = 9;
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      const glm::vec2 c = cell + glm::vec2(i, j);
      const auto a = static_cast<std::uint32_t>(static_cast<int>(c.x) + static_cast<int>(columns)) % columns;
      const auto b = static_cast<std::uint32_t>(static_cast<int>(c.y) + static_cast<int>(rows)) % rows;
      const glm::vec2 middle = c + 0.2F + 0.6F * glm::vec2(random(seed, a, b), random(seed + 1, a, b));
      const float away = glm::distance(p, middle);
      if (away < nearest) {
        nearest = away;
        size = random(seed + 2, a, b);
      }
    }
  }
  return nearest;
}

}  // namespace

Texture litter_texture(std::string name, std::uint32_t leaves, std::uint32_t seed) {
  constexpr int kSize = 1024;
  Texture texture = paint_texture(std::move(name), kSize, kSize, [seed](float u, float v) {
    const float crumbs = noise(u, v, 200, seed), patch = noise(u, v, 12, seed + 1);
    return glm::vec4(glm::vec3(0.27F, 0.20F, 0.14F) * (0.35F + 0.9F * crumbs * patch + 0.3F * crumbs), 1);
  });
  constexpr glm::vec3 kHues[] = {{0.63F, 0.38F, 0.16F}, {0.75F, 0.55F, 0.24F}, {0.47F, 0.27F, 0.14F},
                                 {0.36F, 0.22F, 0.14F}, {0.70F, 0.34F, 0.13F}, {0.58F, 0.50F, 0.26F},
                                 {0.45F, 0.47F, 0.20F}};
  for (std::uint32_t k = 0; k < leaves; ++k) {
    const float length = random_between(26, 58, seed, k, 1), width = length * random_between(0.4F, 0.62F, seed, k, 2);
    const glm::vec2 way = on_circle(static_cast<double>(random(seed, k, 3)));
    const glm::vec2 middle = glm::vec2(random(seed, k, 4), random(seed, k, 5)) * static_cast<float>(kSize);
    const glm::vec3 hue = kHues[static_cast<std::size_t>(random(seed, k, 6) * 6.999F)] *
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
        texture.texels[std::size_t{y} * kSize + x] = packed(hue * shade);
      }
    }
  }
  return texture;
}

Texture mossy_texture(std::string name, const glm::vec3& rock, std::uint32_t seed) {
  Texture texture = paint_texture(std::move(name), 512, 512, [&](float u, float v) {
    const float grain = fractal(u, v, 24, 4, seed), crack = std::abs(noise(u, v, 9, seed + 5) - 0.5F);
    glm::vec3 colour = rock * (0.35F + 1.2F * grain) * (crack < 0.03F ? 0.45F : 1.0F);
    const float moss = v + 0.9F * (fractal(u, v, 7, 3, seed + 7) - 0.5F);
    if (moss > 0.52F) {
      const float tips = noise(u, v, 150, seed + 8);
      colour = glm::mix(glm::vec3(0.16F, 0.24F, 0.05F), glm::vec3(0.55F, 0.66F, 0.20F), tips * (0.4F + 0.8F * grain));
    } else if (noise(u, v, 60, seed + 9) > 0.83F) {
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
    const float away = spots(u, v, 14, 5, seed, size) + 0.16F * (noise(u, v, 60, seed + 3) - 0.5F);
    const glm::vec3 skin = colour * (0.75F + 0.4F * fractal(u, v, 20, 3, seed + 4));
    const float edge = 0.17F + 0.2F * size;
    if (away > edge) return glm::vec4(away < edge + 0.06F ? skin * 0.6F : skin, 1);
    return glm::vec4(glm::vec3(0.96F, 0.93F, 0.84F) * (0.75F + 0.3F * noise(u, v, 90, seed + 6)), 1);
  });
  texture.wrap_v = Texture::Wrap::kClamp;
  return texture;
}

Texture gills_texture(std::string name) {
  return paint_texture(std::move(name), 512, 64, [](float u, float v) {
    const float gill = 0.5F + 0.5F * cos_turns(static_cast<double>(64 * u));
    return glm::vec4(glm::vec3(0.93F, 0.87F, 0.74F) * (0.45F + 0.55F * gill) * (0.9F + 0.2F * noise(u, v, 30, 3)), 1);
  });
}

Texture fur_texture(std::string name) {
  return paint_texture(std::move(name), 512, 512, [](float u, float v) {
    const float top = 0.5F - 0.5F * sin_turns(static_cast<double>(u));  // 1 on the back, 0 under the belly
    const float hair = noise(u * 0.999F, v, 256, 5) * 0.6F + noise(u, v, 40, 6) * 0.4F;
    glm::vec3 colour = glm::mix(glm::vec3(0.62F, 0.36F, 0.17F), glm::vec3(0.46F, 0.24F, 0.11F), top);
    colour = glm::mix(glm::vec3(0.90F, 0.82F, 0.68F), colour, std::clamp(6 * top - 0.9F, 0.0F, 1.0F));
    colour *= 0.62F + 0.6F * hair;
    float size = 0;
    const float away = spots(u, v, 16, 16, 9, size);
    if (top > 0.45F && top < 0.97F && away < 0.16F + 0.1F * size) colour = glm::vec3(0.95F, 0.90F, 0.80F);
    if (top > 0.985F) colour *= 0.35F;
    return glm::vec4(colour, 1);
  });
}

Texture deep_forest_texture(std::string name) {
  return paint_texture(std::move(name), 1024, 512, [](float u, float v) {
    const float leaves = noise(u, v, 160, 71) * 0.6F + noise(u, v, 44, 72) * 0.4F;
    glm::vec3 colour = glm::mix(glm::vec3(0.62F, 0.72F, 0.62F), glm::vec3(0.78F, 0.84F, 0.74F), noise(u, v, 7, 73));
    for (std::uint32_t layer = 0; layer < 3; ++layer) {  // from far to near
      const std::uint32_t columns = 34 - 8 * layer;
      const float near = static_cast<float>(layer), haze = 0.72F - 0.24F * near;
      const float x = u * static_cast<float>(columns) + 0.08F * noise(u, v, 6, 74 + layer);
      const std::uint32_t column = static_cast<std::uint32_t>(x) % columns;
      const float away = std::abs(x - std::floor(x) - random_between(0.3F, 0.7F, 75 + layer, column));
      const float half = random_between(0.05F, 0.16F, 78 + layer, column);
      if (away < half) {
        const float shade = (0.6F + 0.8F * noise(u, v, 90, 79)) * (1.15F - away / half * 0.4F);
        colour = glm::mix(glm::vec3(0.33F, 0.28F, 0.22F) * shade, glm::vec3(0.66F, 0.74F, 0.66F), haze);
      }
      const float crown = 0.30F + 0.12F * near - v + 0.5F * (noise(u, v, 12 + 4 * layer, 82 + layer) - 0.5F);
      const float shrub = v - 0.80F + 0.05F * near + 0.3F * (noise(u, v, 16 + 6 * layer, 86 + layer) - 0.5F);
      if (std::max(crown, shrub) > 0.22F * (leaves - 0.3F) + 0.05F * (2 - near)) {
        const glm::vec3 green = glm::mix(glm::vec3(0.10F, 0.19F, 0.06F), glm::vec3(0.50F, 0.60F, 0.24F), leaves);
        colour = glm::mix(green, glm::vec3(0.66F, 0.74F, 0.66F), haze * 0.85F);
      }
    }
    return glm::vec4(colour, 1);
  });
}

}  // namespace traces::forest
