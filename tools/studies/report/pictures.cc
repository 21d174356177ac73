#include "tools/studies/report/pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "tools/host/standard_streams.h"
#include "traces/scene/images.h"

namespace tools::pages {
namespace {

using sim::Json;

constexpr std::uint64_t kLargestFile = 64 << 20;
constexpr std::array<unsigned, 3> kChannels = {0, 8, 16};  ///< shifts of red, green and blue
constexpr int kDigits = 5;
constexpr std::size_t kMostTiles = 1 << 20;
constexpr double kLargestExact = 0x1p53;

struct ChannelSums {
  std::array<std::uint32_t, 3> channels{};
  std::uint32_t count = 0;
};

traces::Texture average_squares(const traces::Texture& picture, std::uint32_t square) {
  traces::Texture out;
  out.width = (picture.width + square - 1) / square;
  out.height = (picture.height + square - 1) / square;
  std::vector<ChannelSums> sums(std::size_t{out.width} * out.height);
  for (std::uint32_t y = 0; y < picture.height; ++y) {
    for (std::uint32_t x = 0; x < picture.width; ++x) {
      ChannelSums& sum = sums[std::size_t{y / square} * out.width + x / square];
      const std::uint32_t texel = picture.texels[std::size_t{y} * picture.width + x];
      for (std::size_t c = 0; c < kChannels.size(); ++c) sum.channels[c] += (texel >> kChannels[c]) & 0xff;
      ++sum.count;
    }
  }
  for (const ChannelSums& sum : sums) {
    std::uint32_t texel = 0xffU << 24;
    for (std::size_t c = 0; c < kChannels.size(); ++c)
      texel |= ((sum.channels[c] + sum.count / 2) / sum.count) << kChannels[c];
    out.texels.push_back(texel);
  }
  return out;
}

Json page_number(double value) {
  if (!std::isfinite(value)) return {};
  if (value == std::trunc(value) && std::abs(value) < kLargestExact) return static_cast<std::int64_t>(value);
  const double scale = std::pow(10.0, kDigits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

}  // namespace

std::string data_url(std::string_view mime, std::string_view bytes) {
  std::string base64(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int length =
      EVP_EncodeBlock(reinterpret_cast<unsigned char*>(base64.data()),
                      reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
  base64.resize(static_cast<std::size_t>(length));
  return fmt::format("data:{};base64,{}", mime, base64);
}

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
    return data_url("image/png", traces::encode_png(average_squares(picture, square)));
  } catch (const sim::InputError& error) {
    print_message("warning: {}; the page goes without it", error.what());
    return std::nullopt;
  }
}

const std::vector<TileMetric>& tile_metrics() {
  static const std::vector<TileMetric> kMetrics = {
      {"cycles", "T&I cycles of a tile", "", {"finished"}, "dispatched"},
      {"srp", "SRP cycles of a tile's kernels", "", {"srp_cycles"}},
      {"rays", "rays of a tile", "", {"rays_primary", "rays_shadow", "rays_reflection", "rays_refraction"}},
      {"steps", "steps of a tile", "", {"steps"}},
      {"tests", "triangle tests of a tile", "", {"tests"}},
      {"dram", "DRAM traffic of a tile", "B", {"dram_bytes"}},
      {"energy", "energy of a tile, nominal", "nJ", {"energy_mj_nominal"}, nullptr, 1e6}};
  return kMetrics;
}

const std::vector<double>& tile_column(const TileFrame& tiles, const char* name) {
  const TileColumn* const column = tiles.find(name);
  if (column == nullptr) throw sim::InputError(fmt::format("{} has no {} of its tiles", kTilesFile, name));
  return column->values;
}

TileGrid tile_grid(const TileFrame& tiles, double width, double height) {
  TileGrid grid;
  const std::vector<double>&x = tile_column(tiles, "x"), &y = tile_column(tiles, "y"),
        &widths = tile_column(tiles, "width");
  const sim::InputError outside(fmt::format("{} has tiles outside of the picture", kTilesFile));
  if (widths.empty()) throw sim::InputError(fmt::format("{} has no tiles", kTilesFile));
  grid.side = *std::ranges::max_element(widths);
  const auto is_in = [](double at, double end) { return at >= 0 && at < end; };
  const double columns = std::ceil(width / grid.side), rows = std::ceil(height / grid.side);
  if (!(grid.side >= 1) || !is_in(columns * rows, kMostTiles)) throw outside;
  grid.columns = static_cast<std::size_t>(columns);
  grid.rows = static_cast<std::size_t>(rows);
  for (std::size_t i = 0; i < widths.size(); ++i) {
    if (!is_in(x[i], width) || !is_in(y[i], height)) throw outside;
    grid.tile_of_row.push_back(static_cast<std::size_t>(y[i] / grid.side) * grid.columns +
                               static_cast<std::size_t>(x[i] / grid.side));
  }
  return grid;
}

std::vector<double> tile_values(const TileMetric& metric, const TileFrame& tiles, const TileGrid& grid) {
  std::vector<double> values(grid.size());
  const auto add = [&](const char* name, double scale) {
    const std::vector<double>& column = tile_column(tiles, name);
    for (std::size_t i = 0; i < column.size(); ++i) values[grid.tile_of_row[i]] += scale * column[i];
  };
  for (const char* name : metric.columns) add(name, metric.scale);
  if (metric.minus != nullptr) add(metric.minus, -metric.scale);
  return values;
}

Json page_numbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(page_number(value));
  return out;
}

}  // namespace tools::pages
