#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "traces/scene/limits.h"
#include "traces/scene/scene.h"

namespace traces {

// Image files through OpenImageIO, which lives in a module of its own (raywatt_images) that is loaded by the first of
// these calls: it brings some 260 libraries along, and most runs of the program need no image. IoError if it is not
// found next to the program, in ../lib/raywatt from there, or where it was built.

/// A PNG or JPEG file in memory, told by its first bytes. InputError, beginning with `name`, for any other format, a
/// damaged file, or more pixels than allowed, which is known before any is decoded.
Texture read_image(std::span<const std::byte> bytes, const std::string& name, const SceneLimits& limits = {});

/// Linear RGB, top row first.
struct FloatImage {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgb;
};

/// The bytes of a PNG file, with alpha if any texel is not opaque. IoError if encoding fails.
std::vector<unsigned char> encode_png(const Texture& texture);

// Equal pixels give equal bytes. Nobody sees a half-written file. IoError if writing fails.
void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint8_t> rgb8);
void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb);

FloatImage read_exr(const std::filesystem::path& path, const SceneLimits& limits = {});

}  // namespace traces
