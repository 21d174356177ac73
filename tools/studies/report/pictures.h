#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/json.h"
#include "tools/tiles/tile_table.h"

namespace tools::pages {

/// Returns bytes as a data: URL.
std::string data_url(std::string_view mime, std::string_view bytes);

/// Returns a picture file as a data: URL. A picture of more than `most` pixels is averaged over squares. Nothing if the
/// file does not exist or is not a picture.
std::optional<std::string> page_picture(const std::filesystem::path& file, std::size_t most);

/// Returns the side of the smallest squares that divide a picture into at most `most` squares.
std::uint32_t square_for(std::uint32_t width, std::uint32_t height, std::size_t most);

/// Tiles of a picture in row order, and the tile of each row of a tile table.
struct TileGrid {
  double side = 0;
  std::size_t columns = 0, rows = 0;
  std::vector<std::size_t> tile_of_row;
  std::size_t size() const { return columns * rows; }
};
/// InputError for a table without positions, and for tiles outside of the picture.
TileGrid tile_grid(const TileFrame& tiles, double width, double height);

/// A metric of a tile: the sum of columns of tiles.json minus another column, over all rows of the tile.
struct TileMetric {
  const char *id, *words, *unit;
  std::vector<const char*> columns;
  const char* minus = nullptr;
  double scale = 1;
};
/// Metrics that pages draw over pictures.
const std::vector<TileMetric>& tile_metrics();

/// Returns the values of a column; InputError if the table does not have it.
const std::vector<double>& tile_column(const TileFrame& tiles, const char* name);
/// Returns the metric of each tile of the grid; InputError if the table lacks a column.
std::vector<double> tile_values(const TileMetric& metric, const TileFrame& tiles, const TileGrid& grid);
/// Returns numbers for a page: integers exactly, others with five digits, null for values that are not finite.
sim::Json page_numbers(const std::vector<double>& values);

}  // namespace tools::pages
