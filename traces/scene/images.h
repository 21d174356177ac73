#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "traces/scene/images/formats.h"
#include "traces/scene/limits.h"
#include "traces/scene/scene.h"

namespace traces {

// Reading and writing of image files. Reading, colour maps and text need OpenImageIO. Its 260 libraries take a third of
// a second to load, so it is in a module (raywatt_images) that the first such call loads. Throws IoError if the module
// is not next to the program, in ../lib/raywatt/modules relative to it, or where it was built.

/// Reads a PNG or JPEG file in memory. Throws InputError, beginning with `name`, for any other format, a damaged file,
/// or more pixels than allowed (before decoding).
Texture read_image(std::span<const std::byte> bytes, const std::string& name, const SceneLimits& limits = {});

/// A picture in linear RGB floats, top row first.
struct FloatImage {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgb;
};

/// Returns the bytes of a PNG file, with alpha if any texel is not opaque. Throws IoError if encoding fails.
std::string encode_png(const Texture& texture);

// These functions write a file atomically. Equal pixels and notes give equal bytes. They throw IoError if writing
// fails.
void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint8_t> rgb8, std::span<const ImageNote> notes = {});
void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb);

/// Writes an OpenEXR file. `values`: for each pixel in row order, one value per channel. `channels` must be sorted by
/// name, the order in which readers return them.
void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const ImageChannel> channels, std::span<const float> values, std::span<const ImageNote> notes);

/// Returns the colours of values from 0 to 1 in a colour map, as sRGB with 3 bytes each. `map` is "turbo", "viridis" or
/// another of OpenImageIO's.
std::vector<std::uint8_t> apply_colour_map(const std::string& map, std::span<const float> values);

/// A grey picture with 8 bits per pixel, top row first.
struct GreyImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

/// Draws a line of text in black on white, kTextHeight rows high, in DejaVu Sans of Debian's fonts-dejavu-core. The
/// pixels are the same on Debian 12 and 13. Throws IoError if the font is missing.
GreyImage draw_text(const std::string& text);
inline constexpr std::uint32_t kTextHeight = 12;

/// Reads an OpenEXR file of one to four channels. Each pixel of the result has the first three channels of the file. If
/// the file has fewer, its last channel is repeated.
FloatImage read_exr(const std::filesystem::path& path, const SceneLimits& limits = {});

}  // namespace traces
