#pragma once
#include <string>
#include <vector>

#include "tools/studies/report/page/page_model.h"
#include "tools/tiles/tile_table.h"

namespace tools::pages {

/// The picture's tiles in rows, and which of them each row of a table of tiles is part of.
struct TileGrid {
  double side = 0;
  std::size_t columns = 0, rows = 0;
  std::vector<std::size_t> of_row;
  std::size_t size() const { return columns * rows; }
};

/// InputError for a table that knows no places, and for tiles that lie outside of the picture.
TileGrid tile_grid(const TileFrame& tiles, double width, double height);

/// A figure of a tile: the sum of columns of tiles.json, less another, of all its rows.
struct TileFigure {
  const char *id, *words, *unit;
  std::vector<const char*> columns;
  const char* less = nullptr;
  double scale = 1;
};
/// Those that pages lay over pictures.
const std::vector<TileFigure>& tile_figures();

/// Values of a column. InputError if the table has none of that name.
const std::vector<double>& tile_column(const TileFrame& tiles, const char* name);

/// The figure of each tile of the grid. InputError if the table lacks a column of it.
std::vector<double> tile_values(const TileFigure& figure, const TileFrame& tiles, const TileGrid& grid);

/// Numbers as a page holds them: whole ones exactly, others in five digits.
Json tile_numbers(const std::vector<double>& values);

}  // namespace tools::pages
