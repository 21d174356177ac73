#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/report/report.h"
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

/// Returns the smallest side, in pixels, of squares such that at most `max_squares` cover a picture.
std::uint32_t averaging_square_side(std::uint32_t width, std::uint32_t height, std::size_t max_squares) {
  std::uint32_t square = 1;
  while (std::size_t{(width + square - 1) / square} * ((height + square - 1) / square) > max_squares) ++square;
  return square;
}

/// Returns the values of a column of tiles.json. Throws InputError if the table does not have it.
const std::vector<double>& tile_column(const TileFrame& tiles, const char* name) {
  const TileColumn* const column = tiles.find(name);
  if (column == nullptr) throw sim::InputError(fmt::format("{} has no {} of its tiles", kTilesFile, name));
  return column->values;
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

std::optional<std::string> picture_as_data_url(const std::filesystem::path& file, std::size_t max_pixels) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  try {
    const std::string bytes = sim::read_file(file, kLargestFile);
    const traces::Texture picture =
        traces::read_image(std::as_bytes(std::span(bytes.data(), bytes.size())), file.string());
    const std::uint32_t square = averaging_square_side(picture.width, picture.height, max_pixels);
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

Json rounded_for_page(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(page_number(value));
  return out;
}

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPixelsFile = "pixels.exr";
constexpr std::size_t kMostPixels = 1 << 19;  ///< maximum pixels of an overlay; larger ones are averaged over squares
constexpr std::size_t kAnyPixels = std::numeric_limits<std::size_t>::max();
// Limits in bytes of data: URLs. They keep the page of a 2048x1024 frame below 6 MB.
/// Limit in bytes for a picture together with its pixel overlays and debug pictures.
constexpr std::uint64_t kLargestPictures = 3'900'000;
constexpr std::uint64_t kLargestDebug = 1'000'000;  ///< limit for debug pictures alone
constexpr std::uint64_t kLargestFilm = 1'500'000;   ///< limit for the pictures of all frames
constexpr std::size_t kFilmPixels = 1 << 20;        ///< initial limit of the pixels of all frames together
constexpr std::size_t kLeastFilmPixels = 1 << 10;   ///< smallest limit of the pixels of one frame
constexpr std::size_t kMostFilmFrames = 600;

/// The overlays of a picture, as JSON for a page. A tile overlay is {id, name, tile, unit, values, low, high}, a pixel
/// overlay {id, name, pixels, step, unit, low, high, scale}.
struct Overlays {
  Json grids = Json::array();
  std::uint64_t pixel_bytes = 0;  ///< size of the data: URLs of pixel overlays
  Json times;                     ///< times and cores of tiles, {side, begin_us, end_us, core}; null if unknown
  std::string missing;            ///< reasons for missing overlays
};

const Json& first_frame_of(const ReportFile& report) {
  static const Json kNone{};
  const auto frames = report.json.find("frames");
  return frames != report.json.end() && frames->is_array() && !frames->empty() ? frames->front() : kNone;
}

/// Returns for each tile the times of its first dispatch and last finish in us, and its core; null without a table row.
Json tile_times_json(const TileGrid& grid, const TileFrame& tiles, double us_per_cycle) {
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
  return {
      {"side", grid.side}, {"begin_us", rounded_for_page(first)}, {"end_us", rounded_for_page(last)}, {"core", cores}};
}

void add_tiles(const ReportFile& report, Overlays& out) {
  const TileTable table = load_tiles(tiles_file(report));
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
                         {"values", rounded_for_page(values)},
                         {"low", 0},
                         {"high", most > 0 ? most : 1}});
  }
  const double cycles = report.number("totals.cycles");
  if (cycles > 0) out.times = tile_times_json(grid, tiles, 1e3 * report.number("totals.time_ms") / cycles);
}

/// Adds tile overlays for adaptive sampling: the share of similar samples, and the side of the sampling blocks.
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

/// Returns the overlay of one channel of pixels.exr, averaged over squares of pixels. Its picture is a PNG whose red
/// and green are the high and low byte of the value.
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
  const std::uint32_t square = averaging_square_side(image.width, image.height, kMostPixels);
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

/// Reads the overlays of a run's first frame from tiles.json, pixels.exr and the report.
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
  add(tiles_file(report).filename().string(), add_tiles);
  if (report.is_reference()) {
    add_missing("A reference has no data of pixels.");
  } else {
    add(kPixelsFile, add_pixels);
  }
  add_samples(report, out);
  return out;
}

/// Returns name and file of each debug picture of the first frame, except those whose values are also in an .exr file.
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

/// Debug pictures of a page, as JSON: {name, picture}.
struct DebugPictures {
  Json list = Json::array();
  std::uint64_t bytes = 0;
  std::size_t left_out = 0;
};

DebugPictures debug_pictures_of(const ReportFile& report) {
  DebugPictures out;
  if (report.is_reference()) return out;
  for (const auto& [name, file] : debug_pictures_in(report)) {
    const std::optional<std::string> picture = picture_as_data_url(file, kMostPixels);
    if (!picture || out.bytes + picture->size() > kLargestDebug) {
      ++out.left_out;
      continue;
    }
    out.bytes += picture->size();
    out.list.push_back({{"name", name}, {"picture", *picture}});
  }
  return out;
}

/// Returns the picture of each frame as a `data:` URL, scaled down by averaging to at most `max_pixels` pixels. Missing
/// and unreadable pictures are null.
std::vector<Json> frame_pictures(const std::vector<fs::path>& files, std::size_t max_pixels) {
  std::vector<Json> pictures;
  for (const fs::path& file : files) {
    const std::optional<std::string> picture = picture_as_data_url(file, max_pixels);
    pictures.push_back(picture ? Json(*picture) : Json());
  }
  return pictures;
}

std::uint64_t bytes_of(const std::vector<Json>& pictures) {
  std::uint64_t bytes = 0;
  for (const Json& picture : pictures) bytes += picture.is_string() ? picture.get_ref<const std::string&>().size() : 0;
  return bytes;
}

}  // namespace

fs::path tiles_file(const ReportFile& report) {
  return report.file.parent_path() / (report.is_reference() ? kReferenceTiles : kTilesFile);
}

Json frame_pictures_block(const ReportFile& report) {
  const auto frames = report.json.find("frames");
  if (report.is_reference() || frames == report.json.end() || !frames->is_array() || frames->size() < 2) return {};
  const std::size_t shown = std::min(frames->size(), kMostFilmFrames);
  std::vector<fs::path> files;
  for (std::size_t i = 0; i < shown; ++i) {
    const double number = report.number(fmt::format("frames[{}].frame", i));
    files.push_back(report.file.parent_path() / fmt::format("frame-{:04.0f}.png", number));
  }
  std::size_t max_pixels = std::clamp(kFilmPixels / shown, kLeastFilmPixels, kMostPixels);
  std::vector<Json> pictures = frame_pictures(files, max_pixels);
  while (bytes_of(pictures) > kLargestFilm && max_pixels > kLeastFilmPixels) {
    max_pixels = std::max(max_pixels / 2, kLeastFilmPixels);
    pictures = frame_pictures(files, max_pixels);
  }
  Json list = Json::array();
  for (std::size_t i = 0; i < shown; ++i) {
    if (pictures[i].is_string())
      list.push_back({{"frame", report.number(fmt::format("frames[{}].frame", i))}, {"picture", pictures[i]}});
  }
  if (list.empty()) return {};
  std::string note;
  if (list.size() < frames->size()) note = fmt::format("{} of {} frames have a picture.", list.size(), frames->size());
  return {{"type", "film"},
          {"id", "film"},
          {"title", "Picture of each frame"},
          {"width", report.number("resolution[0]")},
          {"height", report.number("resolution[1]")},
          {"frames", std::move(list)},
          {"note", note}};
}

Json run_picture(const ReportFile& report) {
  const fs::path file = report.picture("png");
  std::optional<std::string> picture = picture_as_data_url(file, kAnyPixels);
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
    picture = picture_as_data_url(file, kMostPixels);
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
