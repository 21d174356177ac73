#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "traces/scene/images/writers.h"
#include "traces/scene/limits.h"
#include "traces/scene/scene.h"

namespace traces {

// Image files. They are read through OpenImageIO, which lives in a module of its own (raywatt_images) that the first
// reading call loads, or the first colour map or text: it brings some 260 libraries, a third of a second that most runs do
// without. IoError if the module is not found next to the program, in ../lib/raywatt/modules from there, or where it
// was built.

/// A PNG or JPEG file in memory, told by its first bytes. InputError, beginning with `name`, for any other format, a
/// damaged file, or more pixels than allowed, which is known before any is decoded.
Texture read_image(std::span<const std::byte> bytes, const std::string& name, const SceneLimits& limits = {});

/// Linear RGB, top row first.
struct FloatImage {
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgb;
};

/// The bytes of a PNG file, with alpha if any texel is not opaque. IoError if encoding fails.
std::string encode_png(const Texture& texture);

// Equal pixels and notes give equal bytes. Nobody sees a half-written file. IoError if writing fails.
void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint8_t> rgb8, std::span<const ImageNote> notes = {});
void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb);

/// Values pixel by pixel, one for each channel; channels in the order of their names, as readers find them.
void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const ImageChannel> channels, std::span<const float> values, std::span<const ImageNote> notes);

/// Colours of values from 0 to 1, for the screen: `map` is "turbo", "viridis", or another of OpenImageIO's.
std::vector<std::uint8_t> map_colours(const std::string& map, std::span<const float> values);

/// 8 bits a pixel, top row first.
struct GreyImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

/// Draws a line of text in black on white, kTextHeight rows high, in DejaVu Sans of Debian's fonts-dejavu-core. The
/// pixels are the same on Debian 12 and 13. IoError if the font is missing.
GreyImage draw_text(const std::string& text);
inline constexpr std::uint32_t kTextHeight = 12;

/// Up to four channels, in the order of their names; the first three are told.
FloatImage read_exr(const std::filesystem::path& path, const SceneLimits& limits = {});

}  // namespace traces
