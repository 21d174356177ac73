#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/io/json.h"
#include "tools/analysis/report_file.h"
#include "tools/tiles/tile_table.h"

namespace tools::pages {

struct Options {
  std::vector<std::filesystem::path> inputs;  ///< one run, several runs, or one sweep or search
  std::vector<std::string> names;             ///< names of several runs; empty: short forms of their paths
  std::filesystem::path out;
  std::string counters;  ///< GPU whose counters are printed instead (vendor_counters.h); empty: none
  bool force = false;
};

/// Writes an HTML page about one run, several runs, or one sweep or search. Throws InputError for other folders, for a
/// mixture of these, and for an output file that may not be replaced.
void write_report_page(const Options& options);

/// Returns the title of a run's page: "chess, 1024x512, full:1".
std::string run_title(const ReportFile& report);

/// Returns the JSON for a page with a run's picture, its overlays and debug pictures, or {missing: reason}.
sim::Json run_picture(const ReportFile& report);

/// Returns the JSON for the part of a page that plays the pictures of all frames: {type, id, title, width, height,
/// frames: [{frame, picture}], note}; null for a single frame. All pictures are scaled down equally to limit the size
/// of the page.
sim::Json frame_pictures_block(const ReportFile& report);

/// Returns the path of the tiles.json that belongs to a report of a run or of its reference.
std::filesystem::path tiles_file(const ReportFile& report);

/// True if the folder is that of a sweep or a search.
bool is_sweep(const std::filesystem::path& folder);

/// Returns the data of a page about a sweep or a search, from the results so far:
///   name, question; goals: texts of a search
///   axes            [{field, levels}], levels in ascending order
///   metrics         [{field, name, show, unit, more}]; more: more is better
///   noun            "machine" for a search or a set of workloads, whose rows in `points` are machines; otherwise
///   "point" workloads       {names, figures: [{name, show, unit, fields}]}: metrics on each workload; null without a
///   set points          [[n, status, axes..., metrics..., is_eligible, error, command], ...] has_constraints, limits:
///   [[constraint, met, best value, its 95 % interval, room], ...] headlines       fields of the metrics that headlines
///   show, the main one first best            row of the best point of each metric; ties: text on ties with the best in
///   the main metric start           {x, y, front, near}: metrics and Pareto front of the scatter plot; null without
///   metrics sensitivities   [{metric, points, is_grid, effects: [{axis, share, low, high, range, levels}]}] notices
///   warnings
sim::Json sweep_data(const std::filesystem::path& folder);

/// Returns bytes as a data: URL.
std::string data_url(std::string_view mime, std::string_view bytes);

/// Returns a picture file as a data: URL. A picture with more than `max_pixels` pixels is scaled down by averaging
/// squares of pixels. Returns nothing if the file does not exist or is not a picture.
std::optional<std::string> picture_as_data_url(const std::filesystem::path& file, std::size_t max_pixels);

/// The grid of a picture's tiles, which are numbered row by row. `tile_of_row`: tile number of each row of tiles.json.
struct TileGrid {
  double side = 0;
  std::size_t columns = 0, rows = 0;
  std::vector<std::size_t> tile_of_row;
  std::size_t size() const { return columns * rows; }
};
/// Returns the tile grid of a picture. Throws InputError if tile positions are missing or outside the picture.
TileGrid tile_grid(const TileFrame& tiles, double width, double height);

/// A metric that pages show for each tile: the sum of some columns of tiles.json minus another, over all its rows.
struct TileMetric {
  const char *id, *words, *unit;
  std::vector<const char*> columns;
  const char* minus = nullptr;
  double scale = 1;
};
/// Returns the tile metrics that pages can show as overlays of a picture.
const std::vector<TileMetric>& tile_metrics();

/// Returns the value of a metric for each tile of the grid. Throws InputError if the table lacks a column.
std::vector<double> tile_values(const TileMetric& metric, const TileFrame& tiles, const TileGrid& grid);
/// Returns numbers as JSON for a page: integers exact, others with five digits, infinity and NaN as null.
sim::Json rounded_for_page(const std::vector<double>& values);

}  // namespace tools::pages
