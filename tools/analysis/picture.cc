#include "tools/analysis/picture.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "shader_kernels/programs/geometry_pass.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"

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

namespace {

using Triple = std::array<double, 3>;
using Plane = std::vector<float>;
using Planes = std::array<Plane, 3>;

constexpr double kPixelsPerDegree = 67;
constexpr double kColourExponent = 0.7, kColourLimit = 0.4, kColourShare = 0.95;
constexpr double kFeatureExponent = 0.5, kFeatureWidth = 0.082;
/// White point D65.
constexpr Triple kWhitePoint{0.950428545, 1, 1.088900371};

/// Linear sRGB to XYZ, divided by the white point.
Triple to_xyz(const Triple& rgb) {
  const auto [r, g, b] = rgb;
  return {(10135552.0 * r + 8788810.0 * g + 4435075.0 * b) / 24577794.0 / kWhitePoint[0],
          (2613072.0 * r + 8788810.0 * g + 887015.0 * b) / 12288897.0 / kWhitePoint[1],
          (1425312.0 * r + 8788810.0 * g + 70074185.0 * b) / 73733382.0 / kWhitePoint[2]};
}

Triple to_opponent(const Triple& xyz) { return {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])}; }

/// Returns linear sRGB, clamped to [0, 1], of a colour in the opponent space YCxCz.
Triple rgb_of_opponent(const Triple& c) {
  const double y = (c[0] + 16) / 116;
  const double x = (c[1] / 500 + y) * kWhitePoint[0], z = (y - c[2] / 200) * kWhitePoint[2];
  const auto clamped = [](double v) { return std::clamp(v, 0.0, 1.0); };
  return {clamped(3.241003275 * x - 1.537398934 * y - 0.498615861 * z),
          clamped(-0.969224334 * x + 1.875930071 * y + 0.041554224 * z),
          clamped(0.055639423 * x - 0.204011202 * y + 1.057148933 * z)};
}

/// Returns L*a*b* with the Hunt effect: dark colours are less colourful.
Triple to_hunt_lab(const Triple& rgb) {
  const Triple xyz = to_xyz(rgb);
  const auto curve = [](double t) {
    constexpr double kDelta = 6.0 / 29;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
  };
  const double x = curve(xyz[0]), y = curve(xyz[1]), z = curve(xyz[2]);
  const double lightness = 116 * y - 16;
  return {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)};
}

double hyab_distance(const Triple& a, const Triple& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// A symmetric range of weights around a pixel.
using Kernel = std::vector<double>;

Kernel sampled_kernel(int radius, auto&& weight) {
  Kernel kernel;
  for (int i = -radius; i <= radius; ++i) kernel.push_back(weight(static_cast<double>(i)));
  return kernel;
}

/// Divides positive weights by their sum, and negative weights by the absolute value of theirs.
Kernel normalised(Kernel kernel) {
  double positive = 0, negative = 0;
  for (const double w : kernel) (w > 0 ? positive : negative) += w;
  for (double& w : kernel) w /= w > 0 ? positive : -negative;
  return kernel;
}

/// Filters a picture along x, or y. Pixels outside the picture are those at its edge.
Plane filter(const Plane& from, std::size_t width, const Kernel& kernel, bool along_y) {
  const std::size_t height = from.size() / width;
  const auto radius = static_cast<std::ptrdiff_t>(kernel.size() / 2);
  const auto last = static_cast<std::ptrdiff_t>(along_y ? height : width) - 1;
  Plane to(from.size());
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const auto at = static_cast<std::ptrdiff_t>(along_y ? y : x);
      double sum = 0;
      for (std::ptrdiff_t i = -radius; i <= radius; ++i) {
        const auto n = static_cast<std::size_t>(std::clamp(at + i, std::ptrdiff_t{0}, last));
        const std::size_t index = along_y ? n * width + x : y * width + n;
        sum += kernel[static_cast<std::size_t>(i + radius)] * static_cast<double>(from[index]);
      }
      to[y * width + x] = static_cast<float>(sum);
    }
  }
  return to;
}

/// One Gaussian of a contrast sensitivity function: amplitude and width, in the paper's units.
struct Gaussian {
  double amplitude, width;
};

/// Filters a plane with a sum of Gaussians whose weights add up to 1.
Plane filter_contrast(const Plane& from, std::size_t width, std::initializer_list<Gaussian> gaussians) {
  constexpr double kPi = std::numbers::pi, kWidest = 0.04;
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(kWidest / (2 * kPi * kPi)) * kPixelsPerDegree));
  std::vector<double> volumes;
  std::vector<Plane> parts;
  double all = 0;
  for (const Gaussian& g : gaussians) {
    Kernel kernel = sampled_kernel(radius, [&](double i) {
      const double degrees = i / kPixelsPerDegree;
      return std::exp(-kPi * kPi * degrees * degrees / g.width);
    });
    double sum = 0;
    for (const double w : kernel) sum += w;
    volumes.push_back(g.amplitude * std::sqrt(kPi / g.width) * sum * sum);
    all += volumes.back();
    kernel = normalised(std::move(kernel));
    parts.push_back(filter(filter(from, width, kernel, false), width, kernel, true));
  }
  Plane to(from.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += static_cast<float>(volumes[p] / all) * parts[p][i];
  }
  return to;
}

/// What FLIP compares of a picture.
struct Perceived {
  std::vector<Triple> colours;        ///< filtered colours, Hunt-adjusted L*a*b*
  std::vector<double> edges, points;  ///< magnitudes of edges and points
};

std::vector<double> feature_magnitudes(const Plane& lightness, std::size_t width, const Kernel& feature,
                                       const Kernel& smooth) {
  const Plane x = filter(filter(lightness, width, feature, false), width, smooth, true);
  const Plane y = filter(filter(lightness, width, feature, true), width, smooth, false);
  std::vector<double> magnitudes(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) magnitudes[i] = std::hypot(x[i], y[i]);
  return magnitudes;
}

Perceived perceive_picture(std::span<const float> rgb, std::size_t width) {
  Planes planes;
  Plane lightness;
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    const auto channel = [&](std::size_t c) { return std::clamp(static_cast<double>(rgb[i + c]), 0.0, 1.0); };
    const Triple opponent = to_opponent(to_xyz({channel(0), channel(1), channel(2)}));
    for (std::size_t c = 0; c < 3; ++c) planes[c].push_back(static_cast<float>(opponent[c]));
    lightness.push_back(static_cast<float>((opponent[0] + 16) / 116));
  }
  planes[0] = filter_contrast(planes[0], width, {{1, 0.0047}});
  planes[1] = filter_contrast(planes[1], width, {{1, 0.0053}});
  planes[2] = filter_contrast(planes[2], width, {{34.1, 0.04}, {13.5, 0.025}});
  Perceived out;
  for (std::size_t i = 0; i < lightness.size(); ++i) {
    const auto opponent = [&](std::size_t c) { return static_cast<double>(planes[c][i]); };
    out.colours.push_back(to_hunt_lab(rgb_of_opponent({opponent(0), opponent(1), opponent(2)})));
  }
  const double deviation = 0.5 * kFeatureWidth * kPixelsPerDegree;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  const auto gaussian = [&](double i) { return std::exp(-i * i / (2 * deviation * deviation)); };
  const Kernel smooth = normalised(sampled_kernel(radius, gaussian));
  const Kernel edge = normalised(sampled_kernel(radius, [&](double i) { return -i * gaussian(i); }));
  const Kernel point =
      normalised(sampled_kernel(radius, [&](double i) { return (i * i / (deviation * deviation) - 1) * gaussian(i); }));
  out.edges = feature_magnitudes(lightness, width, edge, smooth);
  out.points = feature_magnitudes(lightness, width, point, smooth);
  return out;
}

}  // namespace

double mean_flip(std::span<const float> reference, std::span<const float> test, std::uint32_t width) {
  assert(reference.size() == test.size() && !reference.empty());
  const Perceived a = perceive_picture(reference, width), b = perceive_picture(test, width);
  const double largest = std::pow(hyab_distance(to_hunt_lab({0, 1, 0}), to_hunt_lab({0, 0, 1})), kColourExponent);
  const double limit = kColourLimit * largest;
  double sum = 0;
  for (std::size_t i = 0; i < a.colours.size(); ++i) {
    const double distance = std::pow(hyab_distance(a.colours[i], b.colours[i]), kColourExponent);
    const double colour = distance < limit ? distance * kColourShare / limit
                                           : kColourShare + (distance - limit) / (largest - limit) * (1 - kColourShare);
    const double feature =
        std::pow(std::max(std::abs(a.edges[i] - b.edges[i]), std::abs(a.points[i] - b.points[i])) / std::numbers::sqrt2,
                 kFeatureExponent);
    sum += std::pow(colour, 1 - feature);
  }
  return sum / static_cast<double>(a.colours.size());
}

}  // namespace tools
