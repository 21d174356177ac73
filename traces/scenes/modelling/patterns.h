#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "traces/scene/scene.h"

namespace traces {

/// Makes a texture from a function of (u, v) in [0, 1) x [0, 1), v downwards. Colours are sRGB, 0 to 1; w is alpha.
Texture paint_texture(std::string name, std::uint32_t width, std::uint32_t height,
                      const std::function<glm::vec4(float u, float v)>& at);

/// Returns value noise from 0 to 1 that repeats every `period` lattice cells; u = 1 is `period` cells.
float value_noise(float u, float v, std::uint32_t period, std::uint32_t seed);
/// Returns fractal noise, 0 to 1: a sum of octaves of value noise, each twice as fine and half as strong.
float fractal_noise(float u, float v, std::uint32_t period, std::uint32_t octaves, std::uint32_t seed);
/// Returns fractal noise at a point of space, 0 to 1, without repetition.
float fractal_noise(const glm::vec3& p, std::uint32_t octaves, std::uint32_t seed);

// Textures of common materials. All can be tiled; colours are 0 to 1.
Texture wood_texture(std::string name, const glm::vec3& light, const glm::vec3& dark, std::uint32_t seed,
                     std::uint32_t size = 512);
Texture stone_texture(std::string name, const glm::vec3& light, const glm::vec3& dark, std::uint32_t seed,
                      std::uint32_t size = 512);
Texture brick_texture(std::string name, const glm::vec3& brick, const glm::vec3& mortar, std::uint32_t columns,
                      std::uint32_t rows, std::uint32_t seed, std::uint32_t size = 512);
Texture tile_texture(std::string name, const glm::vec3& first, const glm::vec3& second, const glm::vec3& joint,
                     std::uint32_t tiles, std::uint32_t seed, std::uint32_t size = 512);
Texture cloth_texture(std::string name, const glm::vec3& warp, const glm::vec3& weft, std::uint32_t threads,
                      std::uint32_t seed, std::uint32_t size = 512);

/// Returns a random number in [0, 1) (random_between: in [low, high)). The number is a hash of the keys.
float random_unit(std::uint64_t key1, std::uint64_t key2 = 0, std::uint64_t key3 = 0);
float random_between(float low, float high, std::uint64_t key1, std::uint64_t key2 = 0, std::uint64_t key3 = 0);

}  // namespace traces
