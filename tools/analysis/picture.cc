#include "tools/analysis/picture.h"

#include <algorithm>
#include <cassert>
#include <cmath>

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

std::optional<double> psnr_db(double mean_squared_error) {
  if (mean_squared_error == 0) return {};
  return -10 * std::log10(mean_squared_error);
}

}  // namespace tools
