#include "tools/studies/report/page/tile_maps.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sim/error.h"

namespace tools::pages {
namespace {

constexpr int kDigits = 5;
constexpr std::size_t kMostTiles = 1 << 20;
constexpr double kLargestExact = 0x1p53;

Json number(double value) {
  if (!std::isfinite(value)) return 0;
  if (value == std::trunc(value) && std::abs(value) < kLargestExact) return static_cast<std::int64_t>(value);
  const double scale = std::pow(10.0, kDigits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

}  // namespace

const std::vector<TileFigure>& tile_figures() {
  static const std::vector<TileFigure> kFigures = {
      {"cycles", "T&I cycles of a tile", "", {"finished"}, "dispatched"},
      {"srp", "SRP cycles of a tile's kernels", "", {"srp_cycles"}},
      {"rays", "rays of a tile", "", {"rays_primary", "rays_shadow", "rays_reflection", "rays_refraction"}},
      {"steps", "steps of a tile", "", {"steps"}},
      {"tests", "triangle tests of a tile", "", {"tests"}},
      {"dram", "DRAM traffic of a tile", "B", {"dram_bytes"}},
      {"energy", "energy of a tile, nominal", "nJ", {"energy_mj_nominal"}, nullptr, 1e6}};
  return kFigures;
}

const std::vector<double>& tile_column(const TileFrame& tiles, const char* name) {
  const TileColumn* const column = tiles.find(name);
  if (column == nullptr) {
    throw sim::InputError(fmt::format("{} has no {} of its tiles", kTilesFile, name));
  }
  return column->values;
}

TileGrid tile_grid(const TileFrame& tiles, double width, double height) {
  TileGrid grid;
  const std::vector<double>&x = tile_column(tiles, "x"), &y = tile_column(tiles, "y"),
        &wide = tile_column(tiles, "width");
  const auto refuse = [] {
    return sim::InputError(fmt::format("{} has tiles that do not lie in the picture", kTilesFile));
  };
  if (wide.empty()) throw sim::InputError(fmt::format("{} has no tiles", kTilesFile));
  grid.side = *std::ranges::max_element(wide);
  const auto is_in = [](double at, double end) { return at >= 0 && at < end; };
  const double columns = std::ceil(width / grid.side), rows = std::ceil(height / grid.side);
  if (!(grid.side >= 1) || !is_in(columns * rows, kMostTiles)) throw refuse();
  grid.columns = static_cast<std::size_t>(columns);
  grid.rows = static_cast<std::size_t>(rows);
  for (std::size_t i = 0; i < wide.size(); ++i) {
    if (!is_in(x[i], width) || !is_in(y[i], height)) throw refuse();
    grid.of_row.push_back(static_cast<std::size_t>(y[i] / grid.side) * grid.columns +
                          static_cast<std::size_t>(x[i] / grid.side));
  }
  return grid;
}

std::vector<double> tile_values(const TileFigure& figure, const TileFrame& tiles, const TileGrid& grid) {
  std::vector<double> all(grid.size());
  const auto add = [&](const char* name, double scale) {
    const std::vector<double>& column = tile_column(tiles, name);
    for (std::size_t i = 0; i < column.size(); ++i) all[grid.of_row[i]] += scale * column[i];
  };
  for (const char* name : figure.columns) add(name, figure.scale);
  if (figure.less != nullptr) add(figure.less, -figure.scale);
  return all;
}

Json tile_numbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(number(value));
  return out;
}

}  // namespace tools::pages
