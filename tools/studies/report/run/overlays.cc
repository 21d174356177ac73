#include "tools/studies/report/run/overlays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "sim/error.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/report/page/page_file.h"
#include "tools/studies/report/page/page_picture.h"
#include "tools/studies/report/page/tile_maps.h"
#include "traces/scene/images.h"

namespace tools::pages {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPixelsFile = "pixels.exr";

/// When each tile was handed out first and through last, in us, and on which core.
Json times_of(const TileGrid& grid, const TileFrame& tiles, double us_a_cycle) {
  const std::vector<double>&begin = tile_column(tiles, "dispatched"), &end = tile_column(tiles, "finished"),
        &core = tile_column(tiles, "core");
  std::vector<double> first(grid.size(), std::numeric_limits<double>::infinity()), last(grid.size()), on(grid.size());
  for (std::size_t i = 0; i < grid.of_row.size(); ++i) {
    const std::size_t tile = grid.of_row[i];
    first[tile] = std::min(first[tile], begin[i] * us_a_cycle);
    last[tile] = std::max(last[tile], end[i] * us_a_cycle);
    on[tile] = core[i];
  }
  Json begins = tile_numbers(first), ends = tile_numbers(last);
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (!std::isfinite(first[i])) begins[i] = ends[i] = nullptr;  // no row of the table is part of it
  }
  return {{"side", grid.side}, {"begin_us", std::move(begins)}, {"end_us", std::move(ends)}, {"core", on}};
}

void add_tiles(const Run& run, Overlays& out) {
  const TileTable table = load_tiles(run.folder / kTilesFile);
  if (table.frames.empty()) throw sim::InputError(fmt::format("{} has no frames", kTilesFile));
  const TileFrame& tiles = table.frames.front();
  const TileGrid grid = tile_grid(tiles, run.number("resolution[0]"), run.number("resolution[1]"));
  for (const TileFigure& figure : tile_figures()) {
    const std::vector<double> values = tile_values(figure, tiles, grid);
    const double most = *std::ranges::max_element(values);
    out.grids.push_back({{"id", figure.id},
                         {"name", figure.words},
                         {"tile", grid.side},
                         {"unit", figure.unit},
                         {"values", tile_numbers(values)},
                         {"low", 0},
                         {"high", most > 0 ? most : 1}});
  }
  const double cycles = run.number("totals.cycles");
  if (cycles > 0) out.times = times_of(grid, tiles, 1e3 * run.number("totals.time_ms") / cycles);
}

/// Similar ratios and sides of blocks of an adaptive frame.
void add_samples(const Run& run, Overlays& out) {
  const Json& frames = at(run.report.json, {"frames"});
  if (!frames.is_array() || frames.empty()) return;
  const Json& tiles = at(frames[0], {"sampling", "tiles"});
  const double pixels = run.number("resolution[0]") * run.number("resolution[1]");
  const double wanted = number_at(frames[0], {"sampling", "wanted"}), side = number_at(tiles, {"side"});
  if (side <= 0 || wanted <= 0 || pixels <= 0) return;
  const auto add = [&](const char* id, const char* words, const char* key, double low, double high) {
    const Json& values = at(tiles, {key});
    if (!values.is_array()) return;
    out.grids.push_back({{"id", id},
                         {"name", words},
                         {"tile", side / std::sqrt(wanted / pixels)},
                         {"unit", ""},
                         {"values", values},
                         {"low", low},
                         {"high", high}});
  };
  add("similar", "similar samples of a tile, of those checked", "similar_ratio", 0, 1);
  add("blocks", "sampling rate: side of a tile's blocks", "blocks", 1, 4);
}

/// A channel of pixels.exr, averaged over squares of so many pixels, as a PNG whose red and green are sums of squares.
Json pixels_of(const traces::FloatImage& image, std::size_t channel, std::uint32_t square, const char* id,
               const char* name) {
  const std::uint32_t width = (image.width + square - 1) / square, height = (image.height + square - 1) / square;
  std::vector<double> sums(std::size_t{width} * height);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      sums[std::size_t{y / square} * width + x / square] += image.rgb[3 * (std::size_t{y} * image.width + x) + channel];
    }
  }
  const double most = *std::ranges::max_element(sums), unit = std::max(1.0, most / 65535);
  traces::Texture picture;
  picture.width = width;
  picture.height = height;
  for (const double sum : sums) {
    const auto count = static_cast<std::uint32_t>(std::lround(sum / unit));
    picture.texels.push_back(count >> 8 | (count & 0xff) << 8 | 0xffU << 24);
  }
  const auto area = static_cast<double>(square) * square;
  return {{"id", id},
          {"name", name},
          {"pixels", data_url("image/png", traces::encode_png(picture))},
          {"step", unit / area},
          {"unit", ""},
          {"low", 0},
          {"high", most > 0 ? most / area : 1},
          {"scale", "log"}};
}

void add_pixels(const Run& run, Overlays& out) {
  const traces::FloatImage image = traces::read_exr(run.folder / kPixelsFile);
  if (image.width != run.number("resolution[0]") || image.height != run.number("resolution[1]"))
    throw sim::InputError("pixels.exr has another size than the picture");
  const std::uint32_t square = square_for(image.width, image.height, kMostPixels);
  const std::string of = square == 1 ? "" : fmt::format(", means of {}x{} pixels", square, square);
  const auto add = [&](std::size_t channel, const char* id, const std::string& name) {
    Json grid = pixels_of(image, channel, square, id, (name + of).c_str());
    out.pixel_bytes += grid["pixels"].get_ref<const std::string&>().size();
    out.grids.push_back(std::move(grid));
  };
  add(0, "pixel-rays", "rays of a pixel");
  add(1, "pixel-steps", "steps of a pixel");
  add(2, "pixel-tests", "triangle tests of a pixel");
}

}  // namespace

Overlays overlays_of(const Run& run) {
  Overlays out;
  std::error_code ignored;
  const auto add = [&](std::string_view file, void (*from)(const Run&, Overlays&)) {
    if (!fs::is_regular_file(run.folder / file, ignored)) {
      out.missing += fmt::format("{}There is no {}.", out.missing.empty() ? "" : " ", file);
      return;
    }
    try {
      from(run, out);
    } catch (const sim::InputError& error) {
      out.missing += fmt::format("{}{}.", out.missing.empty() ? "" : " ", error.what());
      print_message("warning: {}; the page lacks its overlays", error.what());
    }
  };
  if (run.report.is_reference()) {
    out.missing = "Of a reference nothing is kept of tiles and pixels.";
  } else {
    add(kTilesFile, add_tiles);
    add(kPixelsFile, add_pixels);
  }
  add_samples(run, out);
  return out;
}

}  // namespace tools::pages
