#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/compare/compare.h"
#include "tools/studies/report/page_data.h"
#include "tools/studies/report/pictures.h"
#include "traces/scene/images.h"

namespace tools::pages {
namespace {

using sim::Json;

constexpr std::uint64_t kLargestPicture = 64 << 20;
constexpr std::uint32_t kCell = 16;  ///< side of a cell of the picture's difference map, in pixels

/// Two runs and their names.
struct Difference {
  const ReportFile &a, &b;
  std::string name_a, name_b;
};

TileFrame first_tile_frame(const ReportFile& report, const std::string& name) {
  const std::filesystem::path file = report.file.parent_path() / kTilesFile;
  std::error_code ignored;
  if (report.is_reference()) throw sim::InputError(fmt::format("{} is a reference without a {}", name, kTilesFile));
  if (!std::filesystem::is_regular_file(file, ignored))
    throw sim::InputError(fmt::format("{} has no {}", name, kTilesFile));
  try {
    TileTable table = load_tiles(file);
    if (!table.frames.empty()) return std::move(table.frames.front());
  } catch (const sim::InputError& error) {
    print_message("warning: {}; the page compares no tiles", error.what());
    throw;
  }
  throw sim::InputError(fmt::format("{} of {} has no frames", kTilesFile, name));
}

/// Adds a grid for each tile metric that differs, the second run minus the first. `note`: metrics that do not differ,
/// or why tiles are not compared.
void add_tile_differences(const Difference& d, Json& grids, std::string& note) {
  const double width = d.a.number("resolution[0]"), height = d.a.number("resolution[1]");
  try {
    const TileFrame a = first_tile_frame(d.a, d.name_a), b = first_tile_frame(d.b, d.name_b);
    const TileGrid grid_a = tile_grid(a, width, height), grid_b = tile_grid(b, width, height);
    if (grid_a.side != grid_b.side) {
      throw sim::InputError(
          fmt::format("{} has tiles of {} pixels, {} of {}", d.name_a, grid_a.side, d.name_b, grid_b.side));
    }
    std::vector<std::string> equal;
    for (const TileMetric& metric : tile_metrics()) {
      const std::vector<double> of_a = tile_values(metric, a, grid_a), of_b = tile_values(metric, b, grid_b);
      std::vector<double> difference(of_a.size());
      double most = 0;
      for (std::size_t i = 0; i < difference.size(); ++i) {
        difference[i] = of_b[i] - of_a[i];
        most = std::max(most, std::abs(difference[i]));
      }
      if (most == 0) {
        equal.emplace_back(metric.words);
        continue;
      }
      grids.push_back({{"id", metric.id},
                       {"name", metric.words},
                       {"tile", grid_a.side},
                       {"unit", metric.unit},
                       {"values", page_numbers(difference)},
                       {"of", {page_numbers(of_a), page_numbers(of_b)}},
                       {"low", -most},
                       {"high", most},
                       {"diverging", true}});
    }
    if (!equal.empty()) note = fmt::format("Equal in every tile: {}.", fmt::join(equal, ", "));
  } catch (const sim::InputError& error) {
    note = fmt::format("Tiles are not compared: {}.", error.what());
  }
}

struct Picture {
  traces::Texture pixels;
  Json url;
};

Picture read_picture(const ReportFile& report) {
  const std::filesystem::path file = report.picture("png");
  const std::string bytes = sim::read_file(file, kLargestPicture);
  return {traces::read_image(std::as_bytes(std::span(bytes.data(), bytes.size())), file.string()),
          data_url("image/png", bytes)};
}

/// Returns the mean absolute difference of the channels of each cell, in 8-bit steps.
std::vector<double> cell_differences(const traces::Texture& a, const traces::Texture& b) {
  const std::uint32_t columns = (a.width + kCell - 1) / kCell, rows = (a.height + kCell - 1) / kCell;
  std::vector<double> sums(std::size_t{columns} * rows), counts(sums.size());
  for (std::uint32_t y = 0; y < a.height; ++y) {
    for (std::uint32_t x = 0; x < a.width; ++x) {
      const std::size_t i = std::size_t{y} * a.width + x;
      const std::size_t cell = std::size_t{y / kCell} * columns + x / kCell;
      for (const unsigned shift : {0U, 8U, 16U}) {
        const auto channel = [&](std::uint32_t texel) { return static_cast<double>((texel >> shift) & 0xff); };
        sums[cell] += std::abs(channel(a.texels[i]) - channel(b.texels[i])) / 3;
      }
      ++counts[cell];
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = std::round(1e3 * sums[i] / counts[i]) / 1e3;
  return sums;
}

/// Returns the block of both pictures and of what differs.
Json pictures_json(const Difference& d) {
  const auto size = [](const ReportFile& report) {
    return std::pair{report.number("resolution[0]"), report.number("resolution[1]")};
  };
  if (size(d.a) != size(d.b)) {
    return {{"missing", "The pictures differ in size, so neither pictures nor tiles are compared."}};
  }
  Json grids = Json::array(), out = {{"type", "pair"}, {"id", "pictures-pair"}, {"title", "Both pictures"}};
  std::string note;
  add_tile_differences(d, grids, note);
  out.update({{"about", "Pictures of both runs"},
              {"width", size(d.a).first},
              {"height", size(d.a).second},
              {"a", nullptr},
              {"b", nullptr},
              {"names", {d.name_a, d.name_b}},
              {"note", note}});
  try {
    Picture first = read_picture(d.a), second = read_picture(d.b);
    if (first.pixels.width != second.pixels.width || first.pixels.height != second.pixels.height)
      throw sim::InputError("they differ in size");
    const std::vector<double> cells = cell_differences(first.pixels, second.pixels);
    if (const double most = std::ranges::max(cells); most > 0) {
      grids.push_back({{"id", "picture"},
                       {"name", "channels of the picture, mean distance in 255ths"},
                       {"tile", kCell},
                       {"unit", ""},
                       {"values", cells},
                       {"low", 0},
                       {"high", most}});
    }
    out.update({{"width", first.pixels.width},
                {"height", first.pixels.height},
                {"a", std::move(first.url)},
                {"b", std::move(second.url)}});
  } catch (const sim::InputError& error) {
    out["missing"] = fmt::format("The pictures are not shown: {}.", error.what());
  }
  out["grids"] = std::move(grids);
  return out;
}

}  // namespace

Json diff_data(const std::vector<ReportFile>& reports) {
  const std::vector<std::string> names = short_names(reports);
  std::vector<Comparison> against;
  std::vector<std::string> titles;
  Json warnings = Json::array(), pictures = Json::array();
  for (const ReportFile& report : reports) titles.push_back(run_title(report));
  for (std::size_t i = 1; i < reports.size(); ++i) {
    against.push_back(compare(reports.front(), reports[i]));
    warnings.push_back(comparison_warnings({reports.front(), reports[i]}, {against.back()}));
    pictures.push_back(pictures_json({reports.front(), reports[i], names.front(), names[i]}));
  }
  return {{"names", names},
          {"titles", titles},
          {"against", comparison_json(reports, against)["against"]},
          {"warnings", std::move(warnings)},
          {"pictures", std::move(pictures)}};
}

}  // namespace tools::pages
