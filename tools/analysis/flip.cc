#include "tools/analysis/flip.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace tools {
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
