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
#include "traces/scene/exr_header.h"
#include "traces/scene/images/codec.h"

namespace traces {
namespace {

const ImageCodec& codec() {
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

/// Whether a chunk of a PNG file claims more bytes than there are: the library takes the memory first.
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

std::string_view as_text(const std::vector<unsigned char>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void check_size(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height, std::size_t values,
                std::size_t channels = 3) {
  if (width == 0 || height == 0 || values != std::size_t{width} * height * channels) {
    throw std::logic_error(
        fmt::format("{}: {} values do not make {} x {} pixels", path.string(), values, width, height));
  }
}

std::vector<ImageCodec::Note> codec_notes(std::span<const ImageNote> notes) {
  std::vector<ImageCodec::Note> out;
  for (const ImageNote& note : notes) out.push_back({note.name.c_str(), note.text.c_str()});
  return out;
}

void finish(const std::filesystem::path& path, const std::string& error, const std::vector<unsigned char>& bytes) {
  if (!error.empty())
    throw sim::IoError(fmt::format("{}: writing failed: {}", sim::printable(path.string()), sim::printable(error)));
  sim::write_file_atomically(path, as_text(bytes));
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
  const std::string error = codec().decode(bytes, format, limits.pixels, size, texture.texels);
  if (!error.empty()) throw sim::InputError(fmt::format("{}: {}", name, sim::printable(error)));
  texture.width = size.width;
  texture.height = size.height;
  return texture;
}

std::vector<unsigned char> encode_png(const Texture& texture) {
  const bool opaque = std::ranges::all_of(texture.texels, [](std::uint32_t texel) { return texel >> 24 == 255; });
  const std::uint32_t channels = opaque ? 3 : 4;
  std::vector<std::uint8_t> pixels;
  pixels.reserve(texture.texels.size() * channels);
  for (const std::uint32_t texel : texture.texels) {
    for (std::uint32_t k = 0; k < channels; ++k) pixels.push_back(static_cast<std::uint8_t>(texel >> (8 * k)));
  }
  std::vector<unsigned char> bytes;
  const std::string error = codec().encode_png({texture.width, texture.height}, channels, pixels, {}, bytes);
  if (!error.empty()) {
    throw sim::IoError(fmt::format("texture '{}': {}", sim::printable(texture.name), sim::printable(error)));
  }
  return bytes;
}

void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint8_t> rgb8, std::span<const ImageNote> notes) {
  check_size(path, width, height, rgb8.size());
  std::vector<unsigned char> bytes;
  finish(path, codec().encode_png({width, height}, 3, rgb8, codec_notes(notes), bytes), bytes);
}

void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb) {
  check_size(path, width, height, rgb.size());
  constexpr std::array<ImageCodec::Channel, 3> kColours = {{{"R"}, {"G"}, {"B"}}};
  std::vector<unsigned char> bytes;
  finish(path, codec().encode_exr({width, height}, kColours, rgb, {}, bytes), bytes);
}

void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const ImageChannel> channels, std::span<const float> values,
               std::span<const ImageNote> notes) {
  check_size(path, width, height, values.size(), channels.size());
  std::vector<ImageCodec::Channel> named;
  for (const ImageChannel& channel : channels) named.push_back({channel.name.c_str(), channel.is_half});
  std::vector<unsigned char> bytes;
  finish(path, codec().encode_exr({width, height}, named, values, codec_notes(notes), bytes), bytes);
}

std::vector<std::uint8_t> map_colours(const std::string& map, std::span<const float> values) {
  std::vector<std::uint8_t> rgb;
  const std::string error = codec().map_colours(map.c_str(), values, rgb);
  if (!error.empty()) throw sim::IoError(fmt::format("colour map '{}': {}", map, sim::printable(error)));
  return rgb;
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
      codec().decode_exr(std::as_bytes(std::span(bytes.data(), bytes.size())), limits.pixels, size, image.rgb);
  if (!error.empty()) throw sim::InputError(fmt::format("{}: {}", shown, sim::printable(error)));
  image.width = size.width;
  image.height = size.height;
  return image;
}

}  // namespace traces
