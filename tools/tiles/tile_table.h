#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/json.h"

namespace tools {

/// A column of a frame's tile table: one value for each tile.
struct TileColumn {
  std::string name, unit;
  bool is_sum = false;              ///< true: the frame's total is exactly the sum of all values, in row order, plus
                                    ///< `rest`
  std::vector<double> values = {};  ///< one per tile; whole numbers are exact
  double rest = 0;                  ///< part of the frame's total that belongs to no tile
  double total = 0;
};

/// Table of a frame's tiles, one row per entry of its tile list: a tile, or a tile in one of several passes.
struct TileFrame {
  std::uint32_t frame = 0;
  std::vector<TileColumn> columns;
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }
  /// Returns the column with this name; null if there is none: the table of a replay has no columns of positions.
  const TileColumn* find(std::string_view name) const;
  const std::vector<double>& at(std::string_view name) const;
};

/// Content of tiles.json (docs/report.md): the tables of all frames.
struct TileTable {
  std::vector<TileFrame> frames;
};

inline constexpr std::string_view kTilesFile = "tiles.json";
/// Name of the reference program's tiles.json, which is in the run's folder.
inline constexpr std::string_view kReferenceTiles = "reference-tiles.json";

/// Returns the text of tiles.json; equal tables give equal bytes.
std::string tiles_text(const TileTable& table);

/// Reads a tiles.json, or the one in a run's folder. Throws InputError if the file is not a tiles.json or is damaged.
TileTable load_tiles(const std::filesystem::path& file_or_folder);

}  // namespace tools
