#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace traces {

// Writing of image files with libpng and OpenEXR, the libraries that OpenImageIO itself uses. Loading OpenImageIO would
// take longer than a small run. Equal arguments give equal bytes.

/// A line of text that is stored in an image file.
struct ImageNote {
  std::string name, text;
};

/// Returns the bytes of a PNG file: 8 bits per channel, sRGB, 3 or 4 channels, colour not multiplied by alpha. Throws
/// IoError if libpng reports an error, such as for a side of more than 1,000,000 pixels.
std::string png_bytes(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                      std::span<const std::uint8_t> pixels, std::span<const ImageNote> notes = {});

/// A channel of an OpenEXR file. `is_half` selects 16 bits, which are exact for integers up to 2,048.
struct ImageChannel {
  std::string name;
  bool is_half = false;
};

/// Returns the bytes of a losslessly compressed OpenEXR file. `values`: for each pixel in row order, one value per
/// channel. Throws IoError if OpenEXR reports an error, such as for a note with the name of an attribute of another
/// type.
std::string exr_bytes(std::uint32_t width, std::uint32_t height, std::span<const ImageChannel> channels,
                      std::span<const float> values, std::span<const ImageNote> notes = {});

/// Returns why a file must not be given to OpenEXR, which allocates as much memory as a header claims; an empty text if
/// the file is safe. A safe file has one part of scan lines, only attribute types that exr_bytes() writes, all data
/// within the file, up to four channels, and at most `most_pixels` pixels.
std::string exr_problem(std::string_view file, std::uint64_t most_pixels);

}  // namespace traces
