#include "traces/scenes/modelling/patterns.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>

#include "sim/hash.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces {
namespace {

float smooth_step(float t) { return t * t * (3 - 2 * t); }

float fraction_of(float x) { return x - std::floor(x); }

}  // namespace

float random_unit(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  return sim::hash_to_unit_float(sim::hash(a, b, c));
}

float random_between(float low, float high, std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  return low + (high - low) * random_unit(a, b, c);
}

float value_noise(float u, float v, std::uint32_t period, std::uint32_t seed) {
  const float x = fraction_of(u) * static_cast<float>(period), y = fraction_of(v) * static_cast<float>(period);
  const auto i = static_cast<std::uint32_t>(x) % period, j = static_cast<std::uint32_t>(y) % period;
  const auto at = [&](std::uint32_t a, std::uint32_t b) { return random_unit(seed, a % period, b % period); };
  const float s = smooth_step(fraction_of(x)), t = smooth_step(fraction_of(y));
  return glm::mix(glm::mix(at(i, j), at(i + 1, j), s), glm::mix(at(i, j + 1), at(i + 1, j + 1), s), t);
}

float fractal_noise(float u, float v, std::uint32_t period, std::uint32_t octaves, std::uint32_t seed) {
  float sum = 0, weight = 0.5F, total = 0;
  for (std::uint32_t k = 0; k < octaves; ++k) {
    sum += weight * value_noise(u, v, period << k, seed + k);
    total += weight;
    weight *= 0.5F;
  }
  return sum / total;
}

float fractal_noise(const glm::vec3& p, std::uint32_t octaves, std::uint32_t seed) {
  float sum = 0, weight = 0.5F, total = 0;
  glm::vec3 q = p;
  for (std::uint32_t k = 0; k < octaves; ++k) {
    const glm::vec3 cell = glm::floor(q);
    const glm::vec3 f = q - cell;
    const glm::vec3 s = f * f * (3.0F - 2.0F * f);
    const auto at = [&](int dx, int dy, int dz) {
      const auto key = [](float a, int d) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(a) + d); };
      return sim::hash_to_unit_float(sim::hash(seed + k, key(cell.x, dx), key(cell.y, dy), key(cell.z, dz)));
    };
    const auto row = [&](int dy, int dz) { return glm::mix(at(0, dy, dz), at(1, dy, dz), s.x); };
    sum += weight * glm::mix(glm::mix(row(0, 0), row(1, 0), s.y), glm::mix(row(0, 1), row(1, 1), s.y), s.z);
    total += weight;
    weight *= 0.5F;
    q *= 2.0F;
  }
  return sum / total;
}

Texture paint_texture(std::string name, std::uint32_t width, std::uint32_t height,
                      const std::function<glm::vec4(float u, float v)>& at) {
  Texture texture;
  texture.name = std::move(name);
  texture.width = width;
  texture.height = height;
  texture.texels.reserve(std::size_t{width} * height);
  const auto byte = [](float x) { return static_cast<std::uint32_t>(std::clamp(x, 0.0F, 1.0F) * 255 + 0.5F); };
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const glm::vec4 c = at((static_cast<float>(x) + 0.5F) / static_cast<float>(width),
                             (static_cast<float>(y) + 0.5F) / static_cast<float>(height));
      texture.texels.push_back(byte(c.x) | (byte(c.y) << 8) | (byte(c.z) << 16) | (byte(c.w) << 24));
    }
  }
  return texture;
}

Texture wood_texture(std::string name, const glm::vec3& light, const glm::vec3& dark, std::uint32_t seed,
                     std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [&](float u, float v) {
    const float bend = fractal_noise(u, v, 3, 4, seed);
    const float rings = 0.5F + 0.5F * sin_turns(static_cast<double>(10 * v + 2.5F * bend));
    const float grain = value_noise(u * 0.999F, v, 128, seed + 9) * 0.5F + value_noise(u, v, 4, seed + 10) * 0.5F;
    return glm::vec4(glm::mix(light, dark, std::clamp(0.55F * rings * bend + 0.45F * grain, 0.0F, 1.0F)), 1);
  });
}

Texture stone_texture(std::string name, const glm::vec3& light, const glm::vec3& dark, std::uint32_t seed,
                      std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [&](float u, float v) {
    const float cloud = fractal_noise(u, v, 6, 6, seed);
    const float speck = random_unit(seed, static_cast<std::uint64_t>(u * 4096), static_cast<std::uint64_t>(v * 4096));
    return glm::vec4(glm::mix(dark, light, std::clamp(1.6F * cloud - 0.3F + 0.15F * (speck - 0.5F), 0.0F, 1.0F)), 1);
  });
}

Texture brick_texture(std::string name, const glm::vec3& brick, const glm::vec3& mortar, std::uint32_t columns,
                      std::uint32_t rows, std::uint32_t seed, std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [&](float u, float v) {
    const float y = v * static_cast<float>(rows);
    const auto row = static_cast<std::uint32_t>(y);
    const float x = u * static_cast<float>(columns) + (row % 2 == 0 ? 0.0F : 0.5F);
    const std::uint32_t column = static_cast<std::uint32_t>(x) % columns;
    const float edge_x = std::min(fraction_of(x), 1 - fraction_of(x)),
                edge_y = std::min(fraction_of(y), 1 - fraction_of(y));
    const float rough = fractal_noise(u, v, 32, 3, seed);
    if (edge_x < 0.035F + 0.02F * rough || edge_y < 0.07F + 0.04F * rough) {
      return glm::vec4(mortar * (0.8F + 0.3F * rough), 1);
    }
    return glm::vec4(brick * (0.65F + 0.35F * random_unit(seed, row, column) + 0.3F * (rough - 0.5F)), 1);
  });
}

Texture tile_texture(std::string name, const glm::vec3& first, const glm::vec3& second, const glm::vec3& joint,
                     std::uint32_t tiles, std::uint32_t seed, std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [&](float u, float v) {
    const float x = u * static_cast<float>(tiles), y = v * static_cast<float>(tiles);
    const auto i = static_cast<std::uint32_t>(x), j = static_cast<std::uint32_t>(y);
    const float edge =
        std::min(std::min(fraction_of(x), 1 - fraction_of(x)), std::min(fraction_of(y), 1 - fraction_of(y)));
    if (edge < 0.03F) return glm::vec4(joint, 1);
    const float shade = 0.93F + 0.07F * random_unit(seed, i, j) + 0.12F * (fractal_noise(u, v, 8, 5, seed) - 0.5F);
    return glm::vec4((i + j) % 2 == 0 ? first * shade : second * shade, 1);
  });
}

Texture cloth_texture(std::string name, const glm::vec3& warp, const glm::vec3& weft, std::uint32_t threads,
                      std::uint32_t seed, std::uint32_t size) {
  return paint_texture(std::move(name), size, size, [&](float u, float v) {
    const float x = u * static_cast<float>(threads), y = v * static_cast<float>(threads);
    const bool over = (static_cast<std::uint32_t>(x) + static_cast<std::uint32_t>(y)) % 2 == 0;
    const float across = over ? fraction_of(x) : fraction_of(y);
    const float shade = 0.6F + 1.6F * across * (1 - across) + 0.2F * (fractal_noise(u, v, 16, 3, seed) - 0.5F);
    return glm::vec4((over ? warp : weft) * shade, 1);
  });
}

}  // namespace traces
