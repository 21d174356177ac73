#pragma once
#include <cstdint>
#include <span>
#include <string>

namespace traces {

// Image files by the libraries that OpenImageIO writes them with too, as loading that one takes longer than a small
// run. Equal arguments give equal bytes.

/// A line of text that an image file carries beside its pixels.
struct ImageNote {
  std::string name, text;
};

/// The bytes of a PNG file: 8 bits a channel, sRGB, 3 channels or 4, colour not multiplied by alpha. IoError if libpng
/// refuses, e.g. a side of more than 1,000,000 pixels.
std::string png_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                      std::span<const std::uint8_t> pixels, std::span<const ImageNote> notes = {});

/// A channel of an OpenEXR file. `is_half`: in 16 bits, exact for whole numbers up to 2,048.
struct ImageChannel {
  std::string name;
  bool is_half = false;
};

/// The bytes of an OpenEXR file, compressed without loss; values pixel by pixel, one for each channel. IoError if
/// OpenEXR refuses, e.g. a note with the name of an attribute that is no text.
std::string exr_bytes(std::uint32_t width, std::uint32_t height, std::span<const ImageChannel> channels,
                      std::span<const float> values, std::span<const ImageNote> notes = {});

}  // namespace traces
