#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/report/diff/diff_parts.h"
#include "tools/studies/report/page/tile_maps.h"

namespace tools::pages {
namespace {

TileTable loaded_or_told(const std::filesystem::path& file) {
  try {
    return load_tiles(file);
  } catch (const sim::InputError& error) {
    print_message("warning: {}; the page compares no tiles", error.what());
    throw;
  }
}

TileFrame first_frame(const ReportFile& report, const std::string& name) {
  const std::filesystem::path folder = report.file.parent_path();
  std::error_code ignored;
  if (report.is_reference())
    throw sim::InputError(fmt::format("{} is a reference, of which no {} is kept", name, kTilesFile));
  if (!std::filesystem::is_regular_file(folder / kTilesFile, ignored))
    throw sim::InputError(fmt::format("{} has no {}", name, kTilesFile));
  TileTable table = loaded_or_told(folder / kTilesFile);
  if (table.frames.empty()) throw sim::InputError(fmt::format("{} of {} has no frames", kTilesFile, name));
  return std::move(table.frames.front());
}

}  // namespace

TileDifferences tile_differences(const Difference& d) {
  TileDifferences out;
  const double width = d.a.number("resolution[0]"), height = d.a.number("resolution[1]");
  try {
    const TileFrame a = first_frame(d.a, d.name_a), b = first_frame(d.b, d.name_b);
    const TileGrid grid_a = tile_grid(a, width, height), grid_b = tile_grid(b, width, height);
    if (grid_a.side != grid_b.side) {
      throw sim::InputError(
          fmt::format("{} has tiles of {}, {} of {}", d.name_a, counted(grid_a.side, "pixel"), d.name_b, grid_b.side));
    }
    std::vector<std::string> equal;
    for (const TileFigure& figure : tile_figures()) {
      const std::vector<double> of_a = tile_values(figure, a, grid_a), of_b = tile_values(figure, b, grid_b);
      std::vector<double> difference(of_a.size());
      double most = 0;
      for (std::size_t i = 0; i < difference.size(); ++i) {
        difference[i] = of_b[i] - of_a[i];
        most = std::max(most, std::abs(difference[i]));
      }
      if (most == 0) {
        equal.emplace_back(figure.words);
        continue;
      }
      out.grids.push_back({{"id", figure.id},
                           {"name", figure.words},
                           {"tile", grid_a.side},
                           {"unit", figure.unit},
                           {"values", tile_numbers(difference)},
                           {"of", {tile_numbers(of_a), tile_numbers(of_b)}},
                           {"low", -most},
                           {"high", most},
                           {"diverging", true}});
    }
    if (!equal.empty()) out.note = fmt::format("Equal in every tile: {}.", fmt::join(equal, ", "));
  } catch (const sim::InputError& error) {
    out.note = fmt::format("Tiles are not compared: {}.", error.what());
  }
  return out;
}

}  // namespace tools::pages
