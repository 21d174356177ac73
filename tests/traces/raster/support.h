#pragma once
#include <string>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "traces/accel/build.h"
#include "traces/accel/memory_image.h"
#include "traces/raster/rasteriser.h"
#include "traces/ray.h"
#include "traces/scene/scene.h"

namespace traces {

/// Returns a camera at the origin that looks along -z. Its picture is one unit high at distance 1.
inline PictureCamera straight_ahead(std::uint32_t width, std::uint32_t height) {
  const float pixel = 1.0F / static_cast<float>(height);
  return {glm::vec3(0),
          glm::vec3(-0.5F * pixel * static_cast<float>(width), 0.5F, -1),
          glm::vec3(pixel, 0, 0),
          glm::vec3(0, -pixel, 0),
          width,
          height};
}

/// Returns a scene's camera with the resolution of a picture.
inline PictureCamera picture_of(const Camera& camera, std::uint32_t width, std::uint32_t height) {
  const glm::vec3 right = glm::normalize(glm::vec3(camera.to_world[0]));
  const glm::vec3 up = glm::normalize(glm::vec3(camera.to_world[1]));
  const glm::vec3 back = glm::normalize(glm::vec3(camera.to_world[2]));
  const float half_height = glm::tan(0.5F * camera.vertical_fov);
  const float pixel = 2 * half_height / static_cast<float>(height);
  const glm::vec3 corner = up * half_height - right * (0.5F * pixel * static_cast<float>(width)) - back;
  return {glm::vec3(camera.to_world[3]), corner, right * pixel, -up * pixel, width, height};
}

inline Ray ray_through(const PictureCamera& camera, float x, float y) {
  return {camera.origin, 0, glm::normalize(camera.corner + camera.right * x + camera.down * y)};
}

/// Returns the rays of a box of pixels, row by row. Each pixel has grid x grid rays, through centres of equal cells.
inline std::vector<Ray> rays_of(const PictureCamera& camera, std::uint32_t x0, std::uint32_t y0, std::uint32_t width,
                                std::uint32_t height, std::uint32_t grid = 1) {
  std::vector<Ray> rays;
  const float cell = 1.0F / static_cast<float>(grid);
  for (std::uint32_t y = y0; y < y0 + height; ++y) {
    for (std::uint32_t x = x0; x < x0 + width; ++x) {
      for (std::uint32_t s = 0; s < grid * grid; ++s) {
        rays.push_back(ray_through(camera, static_cast<float>(x) + (static_cast<float>(s % grid) + 0.5F) * cell,
                                   static_cast<float>(y) + (static_cast<float>(s / grid) + 0.5F) * cell));
      }
    }
  }
  return rays;
}

/// Returns a memory image with only triangles and no tree. Triangles may be invalid.
inline MemoryImage image_of(const std::vector<std::array<glm::vec3, 3>>& triangles) {
  MemoryImage image;
  for (const auto& t : triangles) {
    image.triangles.push_back({t[0], t[1], t[2], 0, 0, static_cast<std::uint32_t>(image.triangles.size())});
  }
  image.lower = glm::vec3(-1, -1, -2);
  image.upper = glm::vec3(1, 1, 0);
  return image;
}

}  // namespace traces
