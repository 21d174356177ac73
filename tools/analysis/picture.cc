#include "tools/analysis/picture.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "shader_kernels/programs/geometry_pass.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "tools/analysis/flip.h"

namespace tools {

float srgb_encoded(float linear) {
  const float x = std::clamp(linear, 0.0F, 1.0F);
  return x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1 / 2.4F) - 0.055F;
}

std::vector<std::uint8_t> to_rgb8(std::span<const float> linear) {
  std::vector<std::uint8_t> out(linear.size());
  std::ranges::transform(linear, out.begin(),
                         [](float x) { return static_cast<std::uint8_t>(std::lround(255 * srgb_encoded(x))); });
  return out;
}

std::vector<std::uint8_t> difference_rgb8(std::span<const float> a, std::span<const float> b) {
  assert(a.size() == b.size());
  std::vector<std::uint8_t> out(a.size());
  std::ranges::transform(a, b, out.begin(), [](float of_a, float of_b) {
    const float shown = kShownDifference * std::abs(srgb_encoded(of_a) - srgb_encoded(of_b));
    return static_cast<std::uint8_t>(std::lround(255 * std::min(shown, 1.0F)));
  });
  return out;
}

double mean_squared_error(std::span<const float> a, std::span<const float> b) {
  assert(a.size() == b.size() && !a.empty());
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = static_cast<double>(srgb_encoded(a[i])) - static_cast<double>(srgb_encoded(b[i]));
    squares += difference * difference;
  }
  return squares / static_cast<double>(a.size());
}

void PerceivedError::add(const PerceivedError& other) {
  flip += other.flip;
  frames += other.frames;
  flicker += other.flicker;
  changes += other.changes;
}

/// Returns FLIP error and flicker. A pixel is still if no channel of its reference changed by more than 1/255.
PerceivedError PictureComparison::perceive(std::span<const float> rgb, std::span<const float> reference,
                                           std::uint32_t width) {
  constexpr float kStill = 1.0F / 255;
  PerceivedError error{.flip = mean_flip(reference, rgb, width), .frames = 1};
  double changes = 0;
  std::size_t still = 0;
  for (std::size_t i = 0; i < previous_rgb_.size(); i += 3) {
    float moved = 0, change = 0;
    for (std::size_t c = i; c < i + 3; ++c) {
      moved = std::max(moved, std::abs(srgb_encoded(reference[c]) - srgb_encoded(previous_reference_[c])));
      change += std::abs(srgb_encoded(rgb[c]) - srgb_encoded(previous_rgb_[c])) / 3;
    }
    if (moved > kStill) continue;
    changes += static_cast<double>(change);
    still += 1;
  }
  if (still != 0) error.flicker = changes / static_cast<double>(still), error.changes = 1;
  previous_rgb_.assign(rgb.begin(), rgb.end());
  previous_reference_.assign(reference.begin(), reference.end());
  return error;
}

PictureError PictureComparison::compare_frame(std::span<const float> rgb, std::span<const float> reference,
                                              std::uint32_t width) {
  PictureError error{.squared = mean_squared_error(rgb, reference)};
  if (width != 0) error.perceived = perceive(rgb, reference, width);
  std::vector<float> differences(rgb.size());
  std::ranges::transform(rgb, reference, differences.begin(),
                         [](float a, float b) { return srgb_encoded(a) - srgb_encoded(b); });
  if (!previous_.empty()) {
    assert(previous_.size() == differences.size());
    double squares = 0;
    for (std::size_t i = 0; i < differences.size(); ++i) {
      const double change = static_cast<double>(differences[i]) - static_cast<double>(previous_[i]);
      squares += change * change;
    }
    error.change = squares / static_cast<double>(differences.size());
  }
  previous_ = std::move(differences);
  return error;
}

std::optional<double> psnr_db(double mean_squared_error) {
  if (mean_squared_error == 0) return {};
  return -10 * std::log10(mean_squared_error);
}

namespace {

using Colour = std::array<std::uint8_t, 3>;
using kernels::SampleMark;

constexpr Colour kYellow{255, 221, 0}, kBlue{20, 40, 200}, kGreen{0, 200, 60}, kGrey{96, 96, 96}, kWhite{255, 255, 255};
constexpr int kDarkened = 4;  // divisor that darkens a debug picture under its marked samples

struct Canvas {
  const RenderResult& frame;
  std::uint32_t width, height;  ///< size of the picture in samples
  std::uint32_t grid;           ///< samples per pixel along each axis

  /// Returns a picture with one pixel per sample, coloured by `colour(mark, x, y)`.
  template <class F>
  DebugPicture paint_samples(std::string name, F&& colour) const {
    DebugPicture picture{std::move(name), width, height, {}};
    picture.rgb.reserve(std::size_t{3} * width * height);
    for (std::uint32_t y = 0; y < height; ++y) {
      for (std::uint32_t x = 0; x < width; ++x) {
        const Colour c = colour(frame.marks[std::size_t{y} * width + x], x, y);
        picture.rgb.insert(picture.rgb.end(), c.begin(), c.end());
      }
    }
    return picture;
  }

  /// Returns the RGB values of the pixel of `picture` that contains the sample (x, y).
  const std::uint8_t* pixel_at(const std::vector<std::uint8_t>& picture, std::uint32_t x, std::uint32_t y) const {
    return &picture[3 * (std::size_t{y / grid} * (width / grid) + x / grid)];
  }

  /// Returns the frame's picture, darkened, in which the samples whose debug mark contains `bit` are white.
  DebugPicture marked_picture(std::string name, SampleMark bit) const {
    const std::vector<std::uint8_t> picture = to_rgb8(frame.rgb);
    return paint_samples(std::move(name), [&](SampleMark mark, std::uint32_t x, std::uint32_t y) -> Colour {
      if ((mark & bit) != 0) return kWhite;
      const std::uint8_t* at = pixel_at(picture, x, y);
      const auto grey = static_cast<std::uint8_t>((at[0] + 2 * at[1] + at[2]) / 4 / kDarkened);
      return {grey, grey, grey};
    });
  }
};

/// Returns a debug picture in which the colour of a sample shows its origin: interpolated, traced, post-correction or
/// reference.
DebugPicture similar_picture(const Canvas& canvas) {
  return canvas.paint_samples("similar", [](SampleMark mark, std::uint32_t, std::uint32_t) {
    if ((mark & kernels::kReferenceMark) != 0) return kGrey;
    if ((mark & kernels::kCorrectedMark) != 0) return kGreen;
    return (mark & kernels::kTracedMark) != 0 ? kBlue : kYellow;
  });
}

/// Returns a picture of the interpolated samples; all other samples are black.
DebugPicture interpolated_picture(const Canvas& canvas) {
  const std::vector<std::uint8_t> picture = to_rgb8(canvas.frame.rgb);
  return canvas.paint_samples("interpolated", [&](SampleMark mark, std::uint32_t x, std::uint32_t y) -> Colour {
    if ((mark & kernels::kTracedMark) != 0) return {0, 0, 0};
    const std::uint8_t* at = canvas.pixel_at(picture, x, y);
    return {at[0], at[1], at[2]};
  });
}

/// Returns a debug picture in which the colour of a tile shows its sampling rate. Tiles at the right and lower edges
/// may be smaller.
DebugPicture rates_picture(const Canvas& canvas) {
  const kernels::Sampling& s = canvas.frame.sampling;
  const std::uint32_t across = (canvas.width + s.tile_side - 1) / s.tile_side;
  return canvas.paint_samples("rates", [&](SampleMark, std::uint32_t x, std::uint32_t y) -> Colour {
    const std::size_t tile = std::size_t{y / s.tile_side} * across + x / s.tile_side;
    const int full = s.blocks[tile] > 2 ? 255 : 110;
    const float similar = s.similar[tile];
    return {static_cast<std::uint8_t>(static_cast<float>(full) * (1 - similar)),
            static_cast<std::uint8_t>(static_cast<float>(full) * similar), static_cast<std::uint8_t>(full / 4)};
  });
}

/// Returns a debug picture of the weight that the reconstruction filter keeps when it excludes samples of other
/// surfaces: white if all samples count, black if only the pixel's own samples do.
DebugPicture weights_picture(const Canvas& canvas) {
  return canvas.paint_samples("weights", [](SampleMark mark, std::uint32_t, std::uint32_t) -> Colour {
    const auto share = static_cast<std::uint8_t>(mark >> kernels::kWeightShift);
    return {share, share, share};
  });
}

/// Adds a debug picture for each kind of edge that limits the reconstruction filter somewhere in the frame.
void add_edges(std::vector<DebugPicture>& pictures, const Canvas& canvas) {
  constexpr auto kNames = names_of(kernels::FilterEdge{});
  SampleMark all = 0;
  for (const SampleMark mark : canvas.frame.marks) all |= mark;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto bit = static_cast<SampleMark>(1U << i);
    if ((all & bit) != 0) pictures.push_back(canvas.marked_picture("edges-" + std::string(kNames[i]), bit));
  }
}

template <class Name>
void add_marked_pictures(std::vector<DebugPicture>& pictures, const Canvas& canvas, std::string_view prefix,
                         std::span<const std::uint64_t> counts, const Name& names) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    pictures.push_back(
        canvas.marked_picture(std::string(prefix) + std::string(names[i]), static_cast<SampleMark>(1U << i)));
  }
}

/// Heat-map colours by count: 0 to 7, then 8 or more.
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

void paint_count(DebugPicture& picture, std::size_t pixel, std::uint32_t count) {
  const Colour& colour = kHeat.at(std::min<std::size_t>(count, kHeat.size() - 1));
  std::ranges::copy(colour, picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel));
}

}  // namespace

std::vector<DebugPicture> debug_pictures(const kernels::ProgramSpec& program, const RenderResult& frame,
                                         std::uint32_t width, std::uint32_t height) {
  std::vector<DebugPicture> pictures;
  if (frame.marks.empty()) return pictures;
  const auto grid =
      static_cast<std::uint32_t>(std::lround(std::sqrt(frame.marks.size() / (std::size_t{width} * height))));
  const Canvas canvas{frame, width * grid, height * grid, grid};
  using Kind = kernels::ProgramSpec::Kind;
  if (program.kind == Kind::kSupersample) {
    constexpr std::array<Colour, 5> kCounts{{{0, 0, 0}, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}, kWhite}};
    pictures.push_back(canvas.paint_samples("active", [&](SampleMark mark, std::uint32_t, std::uint32_t) {
      return kCounts.at(kernels::active_subpixel_count(mark));
    }));
    if (frame.sampling.propagated != 0)
      pictures.push_back(canvas.marked_picture("propagated", kernels::kCorrectedMark));
    add_marked_pictures(pictures, canvas, "differs-", frame.sampling.reasons, names_of(kernels::Attribute{}));
    return pictures;
  }
  if (program.kind == Kind::kReconstruct || program.kind == Kind::kSraa) {
    pictures.push_back(weights_picture(canvas));
    add_edges(pictures, canvas);
    return pictures;
  }
  pictures.push_back(similar_picture(canvas));
  pictures.push_back(interpolated_picture(canvas));
  add_marked_pictures(pictures, canvas, "check-", frame.sampling.failed, names_of(kernels::Check{}));
  if (frame.sampling.has_rates) pictures.push_back(rates_picture(canvas));
  return pictures;
}

std::vector<DebugPicture> raster_pictures(const traces::MemoryImage& image, const traces::Camera& camera,
                                          const kernels::RenderConfig& render) {
  const std::unique_ptr<traces::Rasteriser> rasteriser =
      kernels::make_rasteriser(image, camera, render.width, render.height, render.raster, render.tile);
  const kernels::CameraUniforms<float> at = kernels::camera_uniforms(camera, render.width, render.height);
  std::vector<DebugPicture> pictures = {empty_picture("overdraw", render), empty_picture("quads", render)};
  traces::Coverage found;
  std::vector<traces::Ray> rays(render.width);
  // The rasteriser receives two rows at a time, so that quads of 2 x 2 pixels are complete.
  for (std::uint32_t y0 = 0; y0 < render.height; y0 += 2) {
    const std::uint32_t rows = std::min(2U, render.height - y0);
    rays.resize(std::size_t{rows} * render.width);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto x = static_cast<float>(i % render.width) + 0.5F;
      const auto y = static_cast<float>(y0 + i / render.width) + 0.5F;
      const auto direction = at.corner + at.right * x + at.down * y;
      rays[i].direction = {direction.x, direction.y, direction.z};
    }
    rasteriser->rasterise_samples(rays, found, nullptr);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::size_t pixel = std::size_t{y0} * render.width + i;
      paint_count(pictures[0], pixel, found.layers[i]);
      paint_count(pictures[1], pixel, found.quads[i]);
    }
  }
  return pictures;
}

}  // namespace tools
