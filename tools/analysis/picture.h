#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace tools {

/// Encodes linear light in [0, 1] (clamped) as sRGB in [0, 1].
float srgb_encoded(float linear);

/// Encodes linear RGB as sRGB with 8 bits per channel.
std::vector<std::uint8_t> to_rgb8(std::span<const float> linear);

/// Returns the absolute difference of two linear pictures' sRGB values, times kShownDifference, with 8 bits per
/// channel.
std::vector<std::uint8_t> difference_rgb8(std::span<const float> a, std::span<const float> b);
inline constexpr float kShownDifference = 8;

/// Returns the mean squared error over R, G, B of two linear pictures' unquantised sRGB values.
double mean_squared_error(std::span<const float> a, std::span<const float> b);

/// Returns the peak signal-to-noise ratio in dB, peak 1; nullopt for identical pictures.
std::optional<double> psnr_db(double mean_squared_error);

}  // namespace tools
