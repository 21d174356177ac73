#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace traces {

/// Interface of the images module, which converts between pixels and the bytes of a file. The module opens no image
/// files and throws nothing: each call returns an error text, which is empty on success.
class ImageCodec {
 public:
  struct Size {
    std::uint32_t width = 0, height = 0;
  };

  virtual ~ImageCodec() = default;
  /// Decodes a "png" or "jpeg" file. `rgba` has 8 bits per channel, R in the lowest byte.
  virtual std::string decode_image(std::span<const std::byte> bytes, const char* format, std::uint64_t most_pixels,
                                   Size& size, std::vector<std::uint32_t>& rgba) const = 0;
  virtual std::string decode_exr(std::span<const std::byte> bytes, std::uint64_t most_pixels, Size& size,
                                 std::vector<float>& rgb) const = 0;
  /// Maps values from 0 to 1 to sRGB colours, 3 bytes each, by a colour map of OpenImageIO.
  virtual std::string apply_colour_map(const char* map, std::span<const float> values,
                                       std::vector<std::uint8_t>& rgb) const = 0;
  /// Draws a line of text in black on white with font file `font`. The result has `height` rows of 8 bits per pixel.
  virtual std::string draw_text(const char* text, const char* font, std::uint32_t height, Size& size,
                                std::vector<std::uint8_t>& grey) const = 0;
};

/// Type and name of the only symbol that the images module exports. The number in the name is increased when ImageCodec
/// changes.
using ImageCodecFactory = const ImageCodec* (*)();
inline constexpr char kImageCodecSymbol[] = "raywatt_image_codec_5";

}  // namespace traces
