#include "traces/scene/images.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/module.h"
#include "sim/io/printable.h"
#include "traces/scene/images/codec.h"
#include "traces/scene/images/formats.h"

namespace traces {
namespace {

const ImageCodec& image_codec() {
  static const ImageCodec* const loaded = reinterpret_cast<ImageCodecFactory>(
      sim::load_module(RAYWATT_IMAGES_MODULE, kImageCodecSymbol, "for image files"))();
  return *loaded;
}

const char* format_of(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\x89PNG\r\n\x1a\n")) return "png";
  if (text.starts_with("\xff\xd8\xff")) return "jpeg";
  return nullptr;
}

/// True if a chunk of a PNG file claims more bytes than the file has. libpng would allocate them before it reads.
bool has_longer_chunk(std::span<const std::byte> png) {
  constexpr std::size_t kBegin = 8, kAroundContent = 12;
  const auto byte = [&](std::size_t at) { return std::to_integer<std::uint64_t>(png[at]); };
  for (std::size_t at = kBegin; at + kAroundContent <= png.size();) {
    const std::uint64_t content = byte(at) << 24 | byte(at + 1) << 16 | byte(at + 2) << 8 | byte(at + 3);
    if (content > png.size() - at - kAroundContent) return true;
    if (std::memcmp(&png[at + 4], "IEND", 4) == 0) return false;
    at += kAroundContent + content;
  }
  return false;
}

void check_size(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height, std::size_t values,
                std::size_t channels = 3) {
  if (width == 0 || height == 0 || values != std::size_t{width} * height * channels) {
    throw std::logic_error(
        fmt::format("{}: {} values do not make {} x {} pixels", path.string(), values, width, height));
  }
}

/// Calls `write`. IoErrors that `write` throws are prefixed with the name of the file or texture.
template <class Write>
std::string call_with_name(const std::string& name, const Write& write) try {
  return write();
} catch (const sim::IoError& error) {
  throw sim::IoError(fmt::format("{}: {}", sim::printable(name), error.what()));
}

}  // namespace

Texture read_image(std::span<const std::byte> bytes, const std::string& name, const SceneLimits& limits) {
  const char* format = format_of(bytes);
  if (format == nullptr) throw sim::InputError(fmt::format("{}: neither PNG nor JPEG", name));
  if (format == std::string_view("png") && has_longer_chunk(bytes)) {
    throw sim::InputError(fmt::format("{}: damaged: a chunk is longer than the file", name));
  }
  Texture texture;
  texture.name = name;
  ImageCodec::Size size;
  const std::string error = image_codec().decode_image(bytes, format, limits.pixels, size, texture.texels);
  if (!error.empty()) throw sim::InputError(fmt::format("{}: {}", name, sim::printable(error)));
  texture.width = size.width;
  texture.height = size.height;
  return texture;
}

std::string encode_png(const Texture& texture) {
  const bool opaque = std::ranges::all_of(texture.texels, [](std::uint32_t texel) { return texel >> 24 == 255; });
  const std::uint32_t channels = opaque ? 3 : 4;
  std::vector<std::uint8_t> pixels;
  pixels.reserve(texture.texels.size() * channels);
  for (const std::uint32_t texel : texture.texels) {
    for (std::uint32_t k = 0; k < channels; ++k) pixels.push_back(static_cast<std::uint8_t>(texel >> (8 * k)));
  }
  return call_with_name(fmt::format("texture '{}'", texture.name),
                        [&] { return png_bytes(texture.width, texture.height, channels, pixels); });
}

void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint8_t> rgb8, std::span<const ImageNote> notes) {
  check_size(path, width, height, rgb8.size());
  sim::write_file_atomically(path,
                             call_with_name(path.string(), [&] { return png_bytes(width, height, 3, rgb8, notes); }));
}

void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb) {
  static const std::array<ImageChannel, 3> kColours = {{{"R"}, {"G"}, {"B"}}};
  write_exr(path, width, height, kColours, rgb, {});
}

void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const ImageChannel> channels, std::span<const float> values,
               std::span<const ImageNote> notes) {
  check_size(path, width, height, values.size(), channels.size());
  sim::write_file_atomically(
      path, call_with_name(path.string(), [&] { return exr_bytes(width, height, channels, values, notes); }));
}

std::vector<std::uint8_t> apply_colour_map(const std::string& map, std::span<const float> values) {
  std::vector<std::uint8_t> rgb;
  const std::string error = image_codec().apply_colour_map(map.c_str(), values, rgb);
  if (!error.empty()) throw sim::IoError(fmt::format("colour map '{}': {}", map, sim::printable(error)));
  return rgb;
}

GreyImage draw_text(const std::string& text) {
  constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  if (!std::filesystem::exists(kFont)) {
    throw sim::IoError(fmt::format("{}: no such file; the package fonts-dejavu-core has it", kFont));
  }
  GreyImage image;
  ImageCodec::Size size;
  const std::string error = image_codec().draw_text(text.c_str(), kFont, kTextHeight, size, image.pixels);
  if (!error.empty()) throw sim::IoError(fmt::format("the text '{}': {}", sim::printable(text), sim::printable(error)));
  image.width = size.width;
  image.height = size.height;
  return image;
}

FloatImage read_exr(const std::filesystem::path& path, const SceneLimits& limits) {
  const std::string bytes = sim::read_file(path, limits.memory.bytes);
  const std::string shown = sim::printable(path.string());
  if (!bytes.starts_with("\x76\x2f\x31\x01")) throw sim::InputError(shown + ": not an OpenEXR file");
  if (const std::string problem = exr_problem(bytes, limits.pixels); !problem.empty()) {
    throw sim::InputError(fmt::format("{}: {}", shown, problem));
  }
  FloatImage image;
  ImageCodec::Size size;
  const std::string error =
      image_codec().decode_exr(std::as_bytes(std::span(bytes.data(), bytes.size())), limits.pixels, size, image.rgb);
  if (!error.empty()) throw sim::InputError(fmt::format("{}: {}", shown, sim::printable(error)));
  image.width = size.width;
  image.height = size.height;
  return image;
}

}  // namespace traces
