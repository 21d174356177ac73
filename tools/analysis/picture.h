#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace tools {

/// Linear light in [0, 1] (clamped) as sRGB-encoded in [0, 1].
float srgb_encoded(float linear);

/// Linear RGB as 8 bits a channel, sRGB-encoded.
std::vector<std::uint8_t> to_rgb8(std::span<const float> linear);

/// Distance of two linear pictures' sRGB-encoded values, for the eye: kShownDifference times as large, 8 bits a
/// channel.
std::vector<std::uint8_t> difference_rgb8(std::span<const float> a, std::span<const float> b);
inline constexpr float kShownDifference = 8;

/// Mean squared error over R, G, B of the unquantised sRGB-encoded values of two linear pictures.
double mean_squared_error(std::span<const float> a, std::span<const float> b);

/// Peak signal-to-noise ratio in dB, peak 1. Nothing for identical pictures.
std::optional<double> psnr_db(double mean_squared_error);

}  // namespace tools
