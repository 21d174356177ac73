#include "tools/studies/report/page/page_picture.h"

#include <array>
#include <span>
#include <vector>

#include "sim/error.h"
#include "sim/io/file.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/report/page/page_file.h"
#include "traces/scene/images.h"

namespace tools::pages {
namespace {

constexpr std::uint64_t kLargestFile = 64 << 20;
constexpr std::array<unsigned, 3> kChannels = {0, 8, 16};  ///< shifts of red, green and blue

struct Sum {
  std::array<std::uint32_t, 3> channels{};
  std::uint32_t count = 0;
};

traces::Texture averaged(const traces::Texture& picture, std::uint32_t square) {
  traces::Texture out;
  out.width = (picture.width + square - 1) / square;
  out.height = (picture.height + square - 1) / square;
  std::vector<Sum> sums(std::size_t{out.width} * out.height);
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    for (std::uint32_t x = 0; x < picture.width; ++x) {
      Sum& sum = sums[std::size_t{y / square} * out.width + x / square];
      const std::uint32_t texel = picture.texels[std::size_t{y} * picture.width + x];
      for (std::size_t c = 0; c < kChannels.size(); ++c) sum.channels[c] += (texel >> kChannels[c]) & 0xff;
      ++sum.count;
    }
  }
  for (const Sum& sum : sums) {
    std::uint32_t texel = 0xffU << 24;
    for (std::size_t c = 0; c < kChannels.size(); ++c)
      texel |= ((sum.channels[c] + sum.count / 2) / sum.count) << kChannels[c];
    out.texels.push_back(texel);
  }
  return out;
}

}  // namespace

std::uint32_t square_for(std::uint32_t width, std::uint32_t height, std::size_t most) {
  std::uint32_t square = 1;
  while (std::size_t{(width + square - 1) / square} * ((height + square - 1) / square) > most) ++square;
  return square;
}

std::optional<std::string> page_picture(const std::filesystem::path& file, std::size_t most) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  try {
    const std::string bytes = sim::read_file(file, kLargestFile);
    const traces::Texture picture =
        traces::read_image(std::as_bytes(std::span(bytes.data(), bytes.size())), file.string());
    const std::uint32_t square = square_for(picture.width, picture.height, most);
    if (square == 1) return data_url("image/png", bytes);
    return data_url("image/png", traces::encode_png(averaged(picture, square)));
  } catch (const sim::InputError& error) {
    print_message("warning: {}; the page goes without it", error.what());
    return std::nullopt;
  }
}

}  // namespace tools::pages
