#include "tools/timeline/selection.h"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"

namespace tools {
namespace {

/// Parses `count` comma-separated whole numbers; empty if the text is anything else.
std::vector<std::uint32_t> numbers(std::string_view text, std::size_t count) {
  std::vector<std::uint32_t> out;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (out.size() < count) {
    std::uint32_t number = 0;
    const auto [next, bad] = std::from_chars(at, end, number);
    if (bad != std::errc{}) return {};
    out.push_back(number);
    at = next;
    if (out.size() == count) break;
    if (at == end || *at++ != ',') return {};
  }
  return at == end ? out : std::vector<std::uint32_t>{};
}

/// Returns the text after a word and a colon; none if it begins differently.
std::optional<std::string_view> behind(std::string_view text, std::string_view word) {
  if (!text.starts_with(word)) return {};
  return text.substr(word.size());
}

bool covers(const TileFrame& tiles, std::size_t row, std::uint32_t x, std::uint32_t y) {
  const auto at = [&](const char* column) { return tiles.at(column)[row]; };
  return x >= at("x") && x < at("x") + at("width") && y >= at("y") && y < at("y") + at("height");
}

/// Returns the distinct values of a column, ascending.
std::vector<double> distinct(const std::vector<double>& column) {
  const std::set<double> values(column.begin(), column.end());
  return {values.begin(), values.end()};
}

std::vector<std::size_t> slowest(const TileFrame& tiles, std::size_t count) {
  const std::vector<double>&begin = tiles.at("dispatched"), &end = tiles.at("finished");
  std::vector<std::size_t> rows(tiles.rows());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::ranges::stable_sort(rows, std::ranges::greater{}, [&](std::size_t row) { return end[row] - begin[row]; });
  rows.resize(std::min(rows.size(), count));
  return rows;
}

}  // namespace

TimelineSelection parse_timeline(const std::string& text) {
  using Kind = TimelineSelection::Kind;
  if (text == "all") return {};
  if (const auto count = behind(text, "slowest:")) {
    const std::vector<std::uint32_t> n = numbers(*count, 1);
    if (!n.empty() && n[0] > 0) return {Kind::kSlowest, n[0], 0, 0};
  }
  if (const auto position = behind(text, "tile:")) {
    if (const auto n = numbers(*position, 2); !n.empty()) return {Kind::kTile, 0, n[0], n[1]};
  }
  if (const auto position = behind(text, "pixel:")) {
    if (const auto n = numbers(*position, 2); !n.empty()) return {Kind::kPixel, 0, n[0], n[1]};
  }
  throw sim::InputError(fmt::format(
      "--timeline '{}': allowed: all, slowest:N, tile:X,Y (column and row of a tile) or pixel:X,Y, e.g. slowest:8",
      sim::printable(text)));
}

std::vector<std::size_t> selected_tiles(const TimelineSelection& selection, const TileFrame& tiles) {
  using Kind = TimelineSelection::Kind;
  if (selection.kind == Kind::kAll) {
    std::vector<std::size_t> rows(tiles.rows());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    return rows;
  }
  if (selection.kind == Kind::kSlowest) return slowest(tiles, selection.count);
  std::uint32_t x = selection.x, y = selection.y;
  if (selection.kind == Kind::kTile) {
    const std::vector<double> columns = distinct(tiles.at("x")), rows = distinct(tiles.at("y"));
    if (x >= columns.size() || y >= rows.size()) {
      throw sim::InputError(fmt::format("--timeline tile:{},{}: there is no such tile; allowed: 0,0 to {},{}", x, y,
                                        columns.size() - 1, rows.size() - 1));
    }
    x = static_cast<std::uint32_t>(columns[x]);
    y = static_cast<std::uint32_t>(rows[y]);
  }
  std::vector<std::size_t> found;
  for (std::size_t row = 0; row < tiles.rows(); ++row) {
    if (covers(tiles, row, x, y)) found.push_back(row);
  }
  if (found.empty()) throw sim::InputError(fmt::format("--timeline pixel:{},{}: there is no such pixel", x, y));
  return found;
}

}  // namespace tools
