#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "tools/studies/report/diff/diff_parts.h"
#include "tools/studies/report/page/page_file.h"
#include "traces/scene/images.h"

namespace tools::pages {
namespace {

constexpr std::uint64_t kLargestPicture = 64 << 20;
constexpr std::uint32_t kTile = 16;  ///< side of a cell of the map, in pixels

struct Picture {
  traces::Texture pixels;
  Json url;
};

Picture read(const ReportFile& report) {
  const std::filesystem::path file = report.picture("png");
  const std::string bytes = sim::read_file(file, kLargestPicture);
  return {traces::read_image(std::as_bytes(std::span(bytes.data(), bytes.size())), file.string()),
          data_url("image/png", bytes)};
}

/// Mean difference of the channels of each cell, in steps of 8 bits.
Json cell_differences(const traces::Texture& a, const traces::Texture& b) {
  const std::uint32_t columns = (a.width + kTile - 1) / kTile, rows = (a.height + kTile - 1) / kTile;
  std::vector<double> sums(std::size_t{columns} * rows), counts(sums.size());
  for (std::uint32_t y = 0; y < a.height; ++y) {
    for (std::uint32_t x = 0; x < a.width; ++x) {
      const std::size_t i = std::size_t{y} * a.width + x;
      const std::size_t cell = std::size_t{y / kTile} * columns + x / kTile;
      for (const unsigned shift : {0U, 8U, 16U}) {
        const auto channel = [&](std::uint32_t texel) { return static_cast<double>((texel >> shift) & 0xff); };
        sums[cell] += std::abs(channel(a.texels[i]) - channel(b.texels[i])) / 3;
      }
      ++counts[cell];
    }
  }
  Json out = Json::array();
  for (std::size_t i = 0; i < sums.size(); ++i) out.push_back(std::round(1e3 * sums[i] / counts[i]) / 1e3);
  return out;
}

/// Null if the pictures are equal.
Json picture_differences(const traces::Texture& a, const traces::Texture& b) {
  Json values = cell_differences(a, b);
  double most = 0;
  for (const Json& value : values) most = std::max(most, value.get<double>());
  if (most == 0) return {};
  return {{"id", "picture"},  {"name", "channels of the picture, mean distance in 255ths"},
          {"tile", kTile},    {"unit", ""},
          {"values", values}, {"low", 0},
          {"high", most}};
}

}  // namespace

void add_diff_pictures(const Difference& d, View& view) {
  Section section("pictures", "Pictures and tiles",
                  "Both pictures, to flip between and to split, and what each tile took in the second run less what it "
                  "took in the first: blue, less; orange, more.");
  const auto size = [](const ReportFile& report) {
    return std::pair{report.number("resolution[0]"), report.number("resolution[1]")};
  };
  if (size(d.a) != size(d.b)) {
    section.text("The pictures differ in size, so neither they nor their tiles are laid over each other.");
    return view.add(section);
  }
  TileDifferences tiles = tile_differences(d);
  double width = size(d.a).first, height = size(d.a).second;
  Json a, b;
  try {
    Picture first = read(d.a), second = read(d.b);
    if (first.pixels.width != second.pixels.width || first.pixels.height != second.pixels.height)
      throw sim::InputError("they differ in size");
    if (Json grid = picture_differences(first.pixels, second.pixels); !grid.is_null())
      tiles.grids.push_back(std::move(grid));
    width = first.pixels.width;
    height = first.pixels.height;
    a = std::move(first.url);
    b = std::move(second.url);
  } catch (const sim::InputError& error) {
    section.text(fmt::format("The pictures are not shown: {}.", error.what()));
  }
  section.block("pair", "pictures-pair", "Both pictures",
                {{"about", "Pictures of both runs"},
                 {"width", width},
                 {"height", height},
                 {"a", std::move(a)},
                 {"b", std::move(b)},
                 {"names", {d.name_a, d.name_b}},
                 {"grids", std::move(tiles.grids)},
                 {"note", tiles.note}});
  view.add(section);
}

}  // namespace tools::pages
