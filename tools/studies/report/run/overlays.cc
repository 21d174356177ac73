#include "tools/studies/report/run/overlays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "tools/studies/report/page/page_file.h"
#include "traces/scene/images.h"

namespace tools::pages {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostPixels = 1 << 19;  ///< pixels of an overlay; larger ones are averaged
constexpr int kDigits = 5;                    ///< digits of a tile's figure
constexpr std::size_t kMostTiles = 1 << 20;
constexpr const char *kTilesFile = "tiles.json", *kPixelsFile = "pixels.exr";
constexpr std::uint64_t kLargestFile = 1ULL << 30;

/// Columns of a frame of tiles.json (docs/report.md): by name a value for each entry of its list of tiles.
class Tiles {
 public:
  explicit Tiles(const fs::path& file) {
    try {
      json_ = sim::parse_json<Json>(sim::read_file(file, kLargestFile));
    } catch (const Json::exception&) {
      throw sim::InputError("tiles.json is not JSON.");
    }
    const Json& frames = pages::at(json_, {"frames"});
    if (text_at(json_, {"schema"}) != "raywatt-tiles/1" || !frames.is_array() || frames.empty())
      throw sim::InputError("tiles.json is of another kind.");
    columns_ = pages::at(frames[0], {"columns"});
    rows_ = pages::at(columns_, {"tile"}).size();
  }
  std::size_t rows() const { return rows_; }
  /// Numbers of all rows. InputError if there are none of that name.
  std::vector<double> at(const char* name) const {
    const Json& values = pages::at(columns_, {name});
    std::vector<double> out;
    for (const Json& value : values) out.push_back(value.is_number() ? value.get<double>() : 0);
    if (out.size() != rows_ || out.empty())
      throw sim::InputError(
          fmt::format("tiles.json has no {} of its tiles, so they are not laid over the picture.", name));
    return out;
  }

 private:
  Json json_, columns_;
  std::size_t rows_ = 0;
};

double rounded(double value) {
  if (value == 0 || !std::isfinite(value)) return 0;
  const double scale = std::pow(10.0, kDigits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

/// The picture's tiles in rows, and which of them each row of the table is part of.
struct Grid {
  double side = 0;
  std::size_t columns = 0, rows = 0;
  std::vector<std::size_t> of_row;
  std::size_t size() const { return columns * rows; }
};

/// InputError for tiles that lie outside of the picture.
Grid grid_of(const Tiles& tiles, double width, double height) {
  Grid grid;
  const std::vector<double> x = tiles.at("x"), y = tiles.at("y"), wide = tiles.at("width");
  grid.side = *std::ranges::max_element(wide);
  const auto refuse = [] { return sim::InputError("tiles.json has tiles that do not lie in the picture."); };
  if (grid.side < 1 || width < 1 || height < 1) throw refuse();
  grid.columns = static_cast<std::size_t>(std::ceil(width / grid.side));
  grid.rows = static_cast<std::size_t>(std::ceil(height / grid.side));
  for (std::size_t i = 0; i < tiles.rows(); ++i) {
    const auto column = static_cast<std::size_t>(std::max(0.0, x[i]) / grid.side);
    const auto row = static_cast<std::size_t>(std::max(0.0, y[i]) / grid.side);
    if (grid.size() > kMostTiles || column >= grid.columns || row >= grid.rows) throw refuse();
    grid.of_row.push_back(row * grid.columns + column);
  }
  return grid;
}

void add_grid(const Grid& grid, const char* id, const std::string& name, const char* unit,
              const std::vector<double>& values, Json& grids) {
  Json numbers = Json::array();
  for (const double value : values) numbers.push_back(rounded(value));
  const double most = *std::ranges::max_element(values);
  grids.push_back({{"id", id},
                   {"name", name},
                   {"tile", grid.side},
                   {"unit", unit},
                   {"values", std::move(numbers)},
                   {"low", 0},
                   {"high", most > 0 ? most : 1}});
}

/// When each tile was handed out first and through last, in us, and on which core.
Json times_of(const Grid& grid, const Tiles& tiles, double us_a_cycle) {
  const std::vector<double> begin = tiles.at("dispatched"), end = tiles.at("finished"), core = tiles.at("core");
  std::vector<double> first(grid.size(), std::numeric_limits<double>::infinity()), last(grid.size()), on(grid.size());
  for (std::size_t i = 0; i < grid.of_row.size(); ++i) {
    const std::size_t tile = grid.of_row[i];
    first[tile] = std::min(first[tile], begin[i] * us_a_cycle);
    last[tile] = std::max(last[tile], end[i] * us_a_cycle);
    on[tile] = core[i];
  }
  Json begins = Json::array(), ends = Json::array();
  for (std::size_t i = 0; i < first.size(); ++i) {
    const bool is_known = std::isfinite(first[i]);
    begins.push_back(is_known ? Json(rounded(first[i])) : Json());
    ends.push_back(is_known ? Json(rounded(last[i])) : Json());
  }
  return {{"side", grid.side}, {"begin_us", std::move(begins)}, {"end_us", std::move(ends)}, {"core", on}};
}

void add_tiles(const Run& run, Overlays& out) {
  const Tiles tiles(run.folder / kTilesFile);
  const Grid grid = grid_of(tiles, run.number("resolution[0]"), run.number("resolution[1]"));
  const auto sum = [&](std::initializer_list<const char*> names, double scale = 1) {
    std::vector<double> all(grid.size());
    for (const char* name : names) {
      const std::vector<double> column = tiles.at(name);
      for (std::size_t i = 0; i < column.size(); ++i) all[grid.of_row[i]] += scale * column[i];
    }
    return all;
  };
  std::vector<double> cycles_of = sum({"finished"});
  const std::vector<double> dispatched = sum({"dispatched"});
  for (std::size_t i = 0; i < cycles_of.size(); ++i) cycles_of[i] -= dispatched[i];
  add_grid(grid, "cycles", "T&I cycles of a tile", "", cycles_of, out.grids);
  add_grid(grid, "srp", "SRP cycles of a tile's kernels", "", sum({"srp_cycles"}), out.grids);
  add_grid(grid, "rays", "rays of a tile", "",
           sum({"rays_primary", "rays_shadow", "rays_reflection", "rays_refraction"}), out.grids);
  add_grid(grid, "steps", "steps of a tile", "", sum({"steps"}), out.grids);
  add_grid(grid, "tests", "triangle tests of a tile", "", sum({"tests"}), out.grids);
  add_grid(grid, "dram", "DRAM traffic of a tile", "B", sum({"dram_bytes"}), out.grids);
  add_grid(grid, "energy", "energy of a tile, nominal", "nJ", sum({"energy_mj_nominal"}, 1e6), out.grids);
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
  const std::vector<unsigned char> png = traces::encode_png(picture);
  const auto area = static_cast<double>(square) * square;
  return {{"id", id},
          {"name", name},
          {"pixels", data_url("image/png", {reinterpret_cast<const char*>(png.data()), png.size()})},
          {"step", unit / area},
          {"unit", ""},
          {"low", 0},
          {"high", most > 0 ? most / area : 1},
          {"scale", "log"}};
}

void add_pixels(const Run& run, Overlays& out) {
  const traces::FloatImage image = traces::read_exr(run.folder / kPixelsFile);
  if (image.width != run.number("resolution[0]") || image.height != run.number("resolution[1]"))
    throw sim::InputError("pixels.exr has another size than the picture.");
  std::uint32_t square = 1;
  while (std::size_t{image.width} * image.height / (square * square) > kMostPixels) ++square;
  const std::string of = square == 1 ? "" : fmt::format(", means of {}x{} pixels", square, square);
  out.grids.push_back(pixels_of(image, 0, square, "pixel-rays", ("rays of a pixel" + of).c_str()));
  out.grids.push_back(pixels_of(image, 1, square, "pixel-steps", ("steps of a pixel" + of).c_str()));
  out.grids.push_back(pixels_of(image, 2, square, "pixel-tests", ("triangle tests of a pixel" + of).c_str()));
}

}  // namespace

Overlays overlays_of(const Run& run) {
  Overlays out;
  std::error_code ignored;
  const auto add = [&](const char* file, void (*from)(const Run&, Overlays&)) {
    if (!fs::is_regular_file(run.folder / file, ignored)) {
      out.missing += fmt::format("{}There is no {}.", out.missing.empty() ? "" : " ", file);
      return;
    }
    try {
      from(run, out);
    } catch (const sim::InputError& error) {
      out.missing += fmt::format("{}{}", out.missing.empty() ? "" : " ", error.what());
    }
  };
  add(kTilesFile, add_tiles);
  add(kPixelsFile, add_pixels);
  add_samples(run, out);
  return out;
}

}  // namespace tools::pages
