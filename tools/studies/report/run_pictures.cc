#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/report/page_data.h"
#include "tools/studies/report/pictures.h"
#include "traces/scene/images.h"

namespace tools::pages {
namespace {

using sim::Json;
namespace fs = std::filesystem;

constexpr std::string_view kPixelsFile = "pixels.exr";
constexpr std::size_t kMostPixels = 1 << 19;  ///< pixels of an overlay; larger ones are averaged over squares
constexpr std::size_t kAnyPixels = std::numeric_limits<std::size_t>::max();
// Bytes of data: URLs of a page. A frame of 2048x1024 then makes at most 6 MB.
constexpr std::uint64_t kLargestPictures = 3'900'000;  ///< picture, pixel overlays and debug pictures
constexpr std::uint64_t kLargestDebug = 1'000'000;     ///< debug pictures

/// Overlays of a picture. Tiles: {id, name, tile, unit, values, low, high}. Pixels: {id, name, pixels, step, unit, low,
/// high, scale}.
struct Overlays {
  Json grids = Json::array();
  std::uint64_t pixel_bytes = 0;  ///< size of the data: URLs of pixel overlays
  Json times;                     ///< {side, begin_us, end_us, core} of tiles; null if unknown
  std::string missing;            ///< reasons for missing overlays
};

const Json& first_frame_of(const ReportFile& report) {
  static const Json kNone{};
  const auto frames = report.json.find("frames");
  return frames != report.json.end() && frames->is_array() && !frames->empty() ? frames->front() : kNone;
}

/// Returns the first dispatch, the last finish and the core of each tile, in us. Tiles without a row are null.
Json times_of(const TileGrid& grid, const TileFrame& tiles, double us_per_cycle) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const std::vector<double>&begin = tile_column(tiles, "dispatched"), &end = tile_column(tiles, "finished"),
        &core = tile_column(tiles, "core");
  std::vector<double> first(grid.size(), kNever), last(grid.size(), -kNever), cores(grid.size());
  for (std::size_t i = 0; i < grid.tile_of_row.size(); ++i) {
    const std::size_t tile = grid.tile_of_row[i];
    first[tile] = std::min(first[tile], begin[i] * us_per_cycle);
    last[tile] = std::max(last[tile], end[i] * us_per_cycle);
    cores[tile] = core[i];
  }
  return {{"side", grid.side}, {"begin_us", page_numbers(first)}, {"end_us", page_numbers(last)}, {"core", cores}};
}

void add_tiles(const ReportFile& report, Overlays& out) {
  const TileTable table = load_tiles(report.file.parent_path() / kTilesFile);
  if (table.frames.empty()) throw sim::InputError(fmt::format("{} has no frames", kTilesFile));
  const TileFrame& tiles = table.frames.front();
  const TileGrid grid = tile_grid(tiles, report.number("resolution[0]"), report.number("resolution[1]"));
  for (const TileMetric& metric : tile_metrics()) {
    const std::vector<double> values = tile_values(metric, tiles, grid);
    const double most = *std::ranges::max_element(values);
    out.grids.push_back({{"id", metric.id},
                         {"name", metric.words},
                         {"tile", grid.side},
                         {"unit", metric.unit},
                         {"values", page_numbers(values)},
                         {"low", 0},
                         {"high", most > 0 ? most : 1}});
  }
  const double cycles = report.number("totals.cycles");
  if (cycles > 0) out.times = times_of(grid, tiles, 1e3 * report.number("totals.time_ms") / cycles);
}

/// Adds the similar ratio and the block side of each tile of an adaptive frame.
void add_samples(const ReportFile& report, Overlays& out) {
  const sim::JsonPointer pointer("/sampling/tiles");
  const Json& frame = first_frame_of(report);
  if (!frame.contains(pointer)) return;
  const Json& tiles = frame.at(pointer);
  const double pixels = report.number("resolution[0]") * report.number("resolution[1]");
  const double samples = report.number("frames[0].sampling.wanted");
  const double side = report.number("frames[0].sampling.tiles.side");
  if (side <= 0 || samples <= 0 || pixels <= 0) return;
  const auto add = [&](const char* id, const char* words, const char* key, double low, double high) {
    const auto values = tiles.find(key);
    if (values == tiles.end() || !values->is_array()) return;
    out.grids.push_back({{"id", id},
                         {"name", words},
                         {"tile", side / std::sqrt(samples / pixels)},
                         {"unit", ""},
                         {"values", *values},
                         {"low", low},
                         {"high", high}});
  };
  add("similar", "similar samples of a tile, of those checked", "similar_ratio", 0, 1);
  add("blocks", "sampling rate: side of a tile's blocks", "blocks", 1, 4);
}

/// Returns a channel of pixels.exr, averaged over squares, as a PNG whose red and green are the high and low byte.
Json pixel_overlay(const traces::FloatImage& image, std::size_t channel, std::uint32_t square, const char* id,
                   const std::string& name) {
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

void add_pixels(const ReportFile& report, Overlays& out) {
  const traces::FloatImage image = traces::read_exr(report.file.parent_path() / kPixelsFile);
  if (image.width != report.number("resolution[0]") || image.height != report.number("resolution[1]"))
    throw sim::InputError("pixels.exr has another size than the picture");
  const std::uint32_t square = square_for(image.width, image.height, kMostPixels);
  const std::string suffix = square == 1 ? "" : fmt::format(", means of {}x{} pixels", square, square);
  const auto add = [&](std::size_t channel, const char* id, const std::string& name) {
    Json grid = pixel_overlay(image, channel, square, id, name + suffix);
    out.pixel_bytes += grid["pixels"].get_ref<const std::string&>().size();
    out.grids.push_back(std::move(grid));
  };
  add(0, "pixel-rays", "rays of a pixel");
  add(1, "pixel-steps", "steps of a pixel");
  add(2, "pixel-tests", "triangle tests of a pixel");
}

/// Returns the overlays of the first frame, from tiles.json, pixels.exr and the report.
Overlays overlays_of(const ReportFile& report) {
  Overlays out;
  const auto add_missing = [&](const std::string& sentence) {
    out.missing += (out.missing.empty() ? "" : " ") + sentence;
  };
  const auto add = [&](std::string_view file, void (*read)(const ReportFile&, Overlays&)) {
    std::error_code ignored;
    if (!fs::is_regular_file(report.file.parent_path() / file, ignored))
      return add_missing(fmt::format("There is no {}.", file));
    try {
      read(report, out);
    } catch (const sim::InputError& error) {
      add_missing(fmt::format("{}.", error.what()));
      print_message("warning: {}; the page lacks its overlays", error.what());
    }
  };
  if (report.is_reference()) {
    add_missing("A reference has no data of tiles and pixels.");
  } else {
    add(kTilesFile, add_tiles);
    add(kPixelsFile, add_pixels);
  }
  add_samples(report, out);
  return out;
}

/// Returns the debug pictures of the first frame by name; not those that also have an .exr of values.
std::vector<std::pair<std::string, fs::path>> debug_pictures_in(const ReportFile& report) {
  const std::string of_first = fmt::format("frame-{:04.0f}-debug-", report.number("frames[0].frame"));
  std::vector<std::pair<std::string, fs::path>> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(report.file.parent_path(), ignored)) {
    std::string name = entry.path().filename().string();
    const bool is_first_frame = name.starts_with("debug-") || name.starts_with(of_first);
    const fs::path values = fs::path(entry.path()).replace_extension(".exr");
    if (!is_first_frame || !name.ends_with(".png") || fs::exists(values, ignored)) continue;
    name = name.substr(name.find("debug-") + 6);
    name = name.substr(0, name.size() - 4);
    std::ranges::replace(name, '-', ' ');
    found.emplace_back(sim::printable(name), entry.path());
  }
  std::ranges::sort(found);
  return found;
}

/// Debug pictures of a page: {name, picture}.
struct DebugPictures {
  Json list = Json::array();
  std::uint64_t bytes = 0;
  std::size_t left_out = 0;
};

DebugPictures debug_pictures_of(const ReportFile& report) {
  DebugPictures out;
  if (report.is_reference()) return out;
  for (const auto& [name, file] : debug_pictures_in(report)) {
    const std::optional<std::string> picture = page_picture(file, kMostPixels);
    if (!picture || out.bytes + picture->size() > kLargestDebug) {
      ++out.left_out;
      continue;
    }
    out.bytes += picture->size();
    out.list.push_back({{"name", name}, {"picture", *picture}});
  }
  return out;
}

}  // namespace

Json run_picture(const ReportFile& report) {
  const fs::path file = report.picture("png");
  std::optional<std::string> picture = page_picture(file, kAnyPixels);
  Overlays overlays = overlays_of(report);
  if (!picture) {
    return {
        {"missing", fmt::format("The report has no {} next to it. {}", file.filename().string(), overlays.missing)}};
  }
  DebugPictures debug = debug_pictures_of(report);
  std::string note = overlays.missing;
  if (debug.left_out > 0)
    note += fmt::format(" Too large for the page: {} debug picture{}.", debug.left_out, debug.left_out == 1 ? "" : "s");
  if (picture->size() + debug.bytes + overlays.pixel_bytes > kLargestPictures)
    picture = page_picture(file, kMostPixels);
  return {{"type", "picture"},
          {"id", "frame"},
          {"title", "Picture and overlays"},
          {"about", "The rendered picture: " + sim::printable(report.text("scene", "name"))},
          {"width", report.number("resolution[0]")},
          {"height", report.number("resolution[1]")},
          {"picture", *picture},
          {"debug", std::move(debug.list)},
          {"grids", std::move(overlays.grids)},
          {"times", std::move(overlays.times)},
          {"note", note}};
}

}  // namespace tools::pages
