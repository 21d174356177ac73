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
  const std::filesystem::path file = report.file.parent_path() / "image.png";
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

double most_of(const Json& values) {
  double most = 0;
  for (const Json& value : values) most = std::max(most, value.get<double>());
  return most;
}

}  // namespace

void add_diff_pictures(const Difference& d, View& view) {
  Section section("pictures", "The pictures");
  try {
    const Picture a = read(d.a), b = read(d.b);
    if (a.pixels.width != b.pixels.width || a.pixels.height != b.pixels.height) {
      section.text("The pictures differ in size, so they are not laid over each other.");
      return view.add(section);
    }
    Json grids = Json::array();
    Json values = cell_differences(a.pixels, b.pixels);
    if (const double most = most_of(values); most > 0) {
      grids.push_back({{"id", "picture"},
                       {"name", "difference of the pictures, mean of a cell"},
                       {"tile", kTile},
                       {"unit", ""},
                       {"values", std::move(values)},
                       {"low", 0},
                       {"high", most}});
    }
    section.block("pair", "pictures-pair", "Both pictures",
                  {{"about", "Pictures of both runs"},
                   {"width", a.pixels.width},
                   {"height", a.pixels.height},
                   {"a", a.url},
                   {"b", b.url},
                   {"names", {d.name_a, d.name_b}},
                   {"grids", std::move(grids)}});
  } catch (const sim::InputError& error) {
    section.text("The pictures are not both there: " + std::string(error.what()));
  }
  view.add(section);
}

}  // namespace tools::pages
