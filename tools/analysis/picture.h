#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shader_kernels/programs/program_spec.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "tools/run/frame/front_end.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/scene.h"

namespace tools {

/// Encodes linear light in [0, 1] (clamped) as sRGB in [0, 1].
float srgb_encoded(float linear);

/// Encodes linear RGB as sRGB with 8 bits per channel.
std::vector<std::uint8_t> to_rgb8(std::span<const float> linear);

/// Returns kShownDifference times the absolute difference of two linear pictures' sRGB values, 8 bits per channel.
std::vector<std::uint8_t> difference_rgb8(std::span<const float> a, std::span<const float> b);
inline constexpr float kShownDifference = 8;

/// Returns the mean squared error over R, G, B of two linear pictures' unquantised sRGB values.
double mean_squared_error(std::span<const float> a, std::span<const float> b);

/// Returns the peak signal-to-noise ratio in dB, peak 1; nullopt for identical pictures.
std::optional<double> psnr_db(double mean_squared_error);

/// Errors as viewers perceive them; sums over frames.
struct PerceivedError {
  double flip = 0;            ///< mean FLIP error (mean_flip())
  std::uint32_t frames = 0;   ///< frames that `flip` sums; 0: not computed
  double flicker = 0;         ///< mean change of still pixels since the previous frame, sRGB
  std::uint32_t changes = 0;  ///< frames that `flicker` sums
  void add(const PerceivedError& other);
};

/// Error of a frame's picture against its reference picture, on unquantised sRGB values.
struct PictureError {
  double squared = 0;  ///< mean squared error
  /// Mean squared change of the picture's error since the previous frame; none in the first frame.
  std::optional<double> change = {};
  PerceivedError perceived = {};
};

/// Compares the pictures of consecutive frames with their reference pictures.
class PictureComparison {
 public:
  /// Returns the error of the next frame. Both pictures are linear; all frames have equal sizes. The perceived error is
  /// computed if the pictures' `width` is given.
  PictureError compare_frame(std::span<const float> rgb, std::span<const float> reference, std::uint32_t width = 0);

 private:
  PerceivedError perceive(std::span<const float> rgb, std::span<const float> reference, std::uint32_t width);

  std::vector<float> previous_;                           ///< differences of the previous frame; empty before the first
  std::vector<float> previous_rgb_, previous_reference_;  ///< of the previous frame, if perceived errors are computed
};

/// Debug picture of a frame with adaptive sampling: 8-bit RGB, one pixel per sample.
struct DebugPicture {
  std::string name;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Returns the debug pictures of a frame that was rendered with adaptive sampling; other programs have none.
/// - multirate, undersample: `similar` (interpolated samples yellow, traced blue, post-corrected green, references
///   grey), `interpolated` (all other samples black), `check-NAME` (samples that failed this check white over the
///   darkened picture); with rate control also `rates` (tiles: dark for blocks of 2, bright for 4; greener for more
///   similar samples)
/// - supersample: `active` (0 to 4 active sub-pixels: black, red, green, blue, white), `differs-NAME` (pixels with an
///   active sub-pixel whose attribute differed), `propagated` (pixels corrected by propagation rounds)
/// - reconstruct: `weights` (remaining filter weight around a pixel, from black to white), `edges-NAME` (pixels whose
///   filter has an edge)
std::vector<DebugPicture> debug_pictures(const kernels::ProgramSpec& program, const RenderResult& frame,
                                         std::uint32_t width, std::uint32_t height);

/// Returns pictures of the rasteriser's work for one sample per pixel:
///   `overdraw`: triangles that cover the pixel's centre (black 0, blue 1, green, yellow, red 8 or more)
///   `quads`: quads of 2 x 2 pixels that include the pixel, on the same scale; partially covered quads count
std::vector<DebugPicture> raster_pictures(const traces::MemoryImage& image, const traces::Camera& camera,
                                          const kernels::RenderConfig& render);

/// Returns the mean FLIP error (Andersson et al. 2020, LDR) of a picture, from 0 (equal) to 1. Both pictures are linear
/// RGB, clamped to [0, 1], with `width` pixels per row, seen at 67 pixels per degree.
double mean_flip(std::span<const float> reference, std::span<const float> test, std::uint32_t width);

}  // namespace tools
