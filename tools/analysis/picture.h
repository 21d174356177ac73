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

/// Mean squared error over R, G, B of the unquantised sRGB-encoded values of two linear pictures.
double mean_squared_error(std::span<const float> a, std::span<const float> b);

/// Peak signal-to-noise ratio in dB, peak 1. Nothing for identical pictures.
std::optional<double> psnr_db(double mean_squared_error);

}  // namespace tools
