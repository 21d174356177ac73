#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "shader_kernels/programs/program_spec.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "tools/run/frame/front_end.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/scene.h"

namespace tools {

/// A picture of how an adaptive frame came about: 8-bit RGB, a pixel to a sample.
struct DebugPicture {
  std::string name;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Pictures of a frame whose marks have been kept; none for programs that mark nothing. Failed checks lie in white over
/// the darkened picture.
///   multirate, undersample: `similar` (yellow: interpolated, blue: traced; green: by post-correction; grey:
///     references), `interpolated` (the picture where it is interpolated, black elsewhere), `check-NAME` (samples that
///     failed it), and with rate control `rates` (a tile's blocks: dark 2, bright 4; the more green, the more similar
///     it was)
///   supersample: `active` (active sub-pixels of a pixel: black, red, green, blue, white for 0 to 4), `differs-NAME`
///     (pixels with an active sub-pixel where that attribute disagreed), `propagated` (pixels that rounds have
///     corrected)
///   reconstruct: `weights` (what is left of the weights of the shaded samples around a pixel, from black to white),
///     `edges-NAME` (pixels some of whose samples that filter parts from a shaded one)
std::vector<DebugPicture> debug_pictures(const kernels::ProgramSpec& program, const FrontEnd::Result& frame,
                                         std::uint32_t width, std::uint32_t height);

/// Pictures of what a rasteriser has to do for a frame of one sample a pixel:
///   `overdraw` (triangles that cover a pixel's centre: black none, blue one, over green and yellow to red, eight or
///   more) `quads` (quads of triangles, of 2 x 2 pixels, that a pixel lies in: likewise; those that cover others of the
///   four
///     alone are in it)
std::vector<DebugPicture> raster_pictures(const traces::MemoryImage& image, const traces::Camera& camera,
                                          const kernels::RenderConfig& render);

}  // namespace tools
