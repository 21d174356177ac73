#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/json.h"

namespace tools {

/// A figure of all tiles of a frame.
struct TileColumn {
  std::string name, unit;
  bool is_sum = false;  ///< the frame's figure is the sum of all values, in their order, and the rest, to the last bit
  std::vector<double> values = {};  ///< a tile each; whole numbers are exact
  double rest = 0;                  ///< what belongs to no tile
  double total = 0;
};

/// Figures of a frame's tiles, one row for each entry of its tile list: a tile, or a tile in one of several passes.
struct TileFrame {
  std::uint32_t frame = 0;
  std::vector<TileColumn> columns;
  std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }
  /// Null if there is none of that name: a replay knows no places.
  const TileColumn* find(std::string_view name) const;
  const std::vector<double>& at(std::string_view name) const;
};

/// Content of tiles.json (docs/report.md).
struct TileTable {
  std::vector<TileFrame> frames;
};

inline constexpr std::string_view kTilesFile = "tiles.json";

/// The text of the file: equal tables, equal bytes.
std::string tiles_text(const TileTable& table);

/// Reads the file, or that of a run's folder. InputError if it is none, or is damaged.
TileTable load_tiles(const std::filesystem::path& file_or_folder);

}  // namespace tools
