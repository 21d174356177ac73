#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace traces {

/// Interface of the images module: between pixels and the bytes of a file. No files, no exceptions: each call returns
/// what went wrong, or an empty string.
class ImageCodec {
 public:
  struct Size {
    std::uint32_t width = 0, height = 0;
  };

  virtual ~ImageCodec() = default;
  /// `format` is "png" or "jpeg"; `rgba` gets 8 bits a channel, R in the lowest byte.
  virtual std::string decode(std::span<const std::byte> bytes, const char* format, std::uint64_t most_pixels,
                             Size& size, std::vector<std::uint32_t>& rgba) const = 0;
  virtual std::string decode_exr(std::span<const std::byte> bytes, std::uint64_t most_pixels, Size& size,
                                 std::vector<float>& rgb) const = 0;
  /// Colours of values from 0 to 1 in one of the library's colour maps; 8 bits a channel, for the screen.
  virtual std::string map_colours(const char* map, std::span<const float> values,
                                  std::vector<std::uint8_t>& rgb) const = 0;
  /// Draws a line of text in black on white, in the font of that file; `height` rows, 8 bits a pixel.
  virtual std::string draw_text(const char* text, const char* font, std::uint32_t height, Size& size,
                                std::vector<std::uint8_t>& grey) const = 0;
};

/// The module's only symbol, a function of this type and name; the number changes with the class above.
using ImageCodecFactory = const ImageCodec* (*)();
inline constexpr char kImageCodecSymbol[] = "raywatt_image_codec_5";

}  // namespace traces
