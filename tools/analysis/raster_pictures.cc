#include "tools/analysis/raster_pictures.h"

#include <algorithm>
#include <array>
#include <memory>

#include "shader_kernels/programs/geometry_pass.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"

namespace tools {
namespace {

using Colour = std::array<std::uint8_t, 3>;

/// From none to eight or more.
constexpr std::array<Colour, 9> kHeat{{{0, 0, 0},
                                       {20, 40, 200},
                                       {0, 130, 200},
                                       {0, 180, 120},
                                       {0, 200, 60},
                                       {170, 210, 0},
                                       {255, 221, 0},
                                       {255, 130, 0},
                                       {220, 0, 0}}};

DebugPicture empty_picture(const char* name, const kernels::RenderConfig& render) {
  return {name, render.width, render.height, std::vector<std::uint8_t>(std::size_t{3} * render.width * render.height)};
}

void paint(DebugPicture& picture, std::size_t pixel, std::uint32_t count) {
  const Colour& colour = kHeat.at(std::min<std::size_t>(count, kHeat.size() - 1));
  std::ranges::copy(colour, picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel));
}

}  // namespace

std::vector<DebugPicture> raster_pictures(const traces::MemoryImage& image, const traces::Camera& camera,
                                          const kernels::RenderConfig& render) {
  const std::unique_ptr<traces::Rasteriser> rasteriser =
      kernels::make_rasteriser(image, camera, render.width, render.height, render.raster, render.tile);
  const kernels::CameraUniforms<float> at = kernels::camera_uniforms(camera, render.width, render.height);
  std::vector<DebugPicture> pictures = {empty_picture("overdraw", render), empty_picture("quads", render)};
  traces::Coverage found;
  std::vector<traces::Ray> rays(render.width);
  // Two rows at a time, so that no quad is cut.
  for (std::uint32_t y0 = 0; y0 < render.height; y0 += 2) {
    const std::uint32_t rows = std::min(2U, render.height - y0);
    rays.resize(std::size_t{rows} * render.width);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto x = static_cast<float>(i % render.width) + 0.5F;
      const auto y = static_cast<float>(y0 + i / render.width) + 0.5F;
      const auto direction = at.corner + at.right * x + at.down * y;
      rays[i].direction = {direction.x, direction.y, direction.z};
    }
    rasteriser->cover(rays, found, nullptr);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::size_t pixel = std::size_t{y0} * render.width + i;
      paint(pictures[0], pixel, found.layers[i]);
      paint(pictures[1], pixel, found.quads[i]);
    }
  }
  return pictures;
}

}  // namespace tools
