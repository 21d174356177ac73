#pragma once
#include <vector>

#include "shader_kernels/programs/wavefront/render_config.h"
#include "tools/analysis/debug_pictures.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/scene.h"

namespace tools {

/// Pictures of what a rasteriser has to do for a frame of one sample a pixel:
///   `overdraw` (triangles that cover a pixel's centre: black none, blue one, over green and yellow to red, eight or
///   more) `quads` (quads of triangles, of 2 x 2 pixels, that a pixel lies in: likewise; those that cover others of the
///   four
///     alone are in it)
std::vector<DebugPicture> raster_pictures(const traces::MemoryImage& image, const traces::Camera& camera,
                                          const kernels::RenderConfig& render);

}  // namespace tools
