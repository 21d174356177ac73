#include "tools/tiles/tile_table.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"

namespace tools {
namespace {

using sim::Json;

constexpr std::string_view kTilesSchema = "raywatt-tiles/1";
constexpr std::uint64_t kLargestTiles = std::uint64_t{4} << 30;
constexpr double kLargestExact = 0x1p53;

Json number_json(double value) {
  if (value == std::trunc(value) && std::abs(value) < kLargestExact) return static_cast<std::int64_t>(value);
  return value;
}

/// Writes each column of the table as one line of JSON without spaces.
void append_columns(const TileFrame& frame, std::string& out) {
  for (const TileColumn& column : frame.columns) {
    Json values = Json::array();
    for (const double value : column.values) values.push_back(number_json(value));
    out += fmt::format("{}\n        {}: {}", &column == &frame.columns.front() ? "" : ",",
                       sim::json_line(Json(column.name)), sim::json_line(values));
  }
}

Json sums_json(const TileFrame& frame, double TileColumn::*of) {
  Json out = Json::object();
  for (const TileColumn& column : frame.columns) {
    if (column.is_sum) out[column.name] = number_json(column.*of);
  }
  return out;
}

TileFrame frame_of(const Json& json, const Json& units, const std::string& file) {
  TileFrame frame;
  frame.frame = sim::whole_number<std::uint32_t>(json.at("frame"), file + ": the number 'frame'");
  for (const auto& [name, values] : json.at("columns").items()) {
    TileColumn column{name, units.at(name).get<std::string>()};
    column.values = values.get<std::vector<double>>();
    column.is_sum = json.at("totals").contains(name);
    if (column.is_sum) {
      column.rest = json.at("rest").at(name).get<double>();
      column.total = json.at("totals").at(name).get<double>();
    }
    frame.columns.push_back(std::move(column));
    if (frame.columns.back().values.size() != frame.rows()) {
      throw sim::InputError(fmt::format("{}: frame {}: column '{}' has another length than the first", file,
                                        frame.frame, sim::printable(name)));
    }
  }
  return frame;
}

/// Parses JSON; throws InputError, with the file's name, if it is nested too deeply.
Json parse_file(const std::string& bytes, const std::string& name) {
  try {
    return sim::parse_json(bytes);
  } catch (const sim::InputError& error) {
    throw sim::InputError(fmt::format("{}: {}", name, error.what()));
  }
}

}  // namespace

const TileColumn* TileFrame::find(std::string_view name) const {
  const auto found = std::ranges::find(columns, name, &TileColumn::name);
  return found == columns.end() ? nullptr : &*found;
}

const std::vector<double>& TileFrame::at(std::string_view name) const {
  const TileColumn* column = find(name);
  if (column == nullptr) throw std::logic_error(fmt::format("tiles have no column '{}'", name));
  return column->values;
}

std::string tiles_text(const TileTable& table) {
  Json units = Json::object();
  for (const TileFrame& frame : table.frames) {
    for (const TileColumn& column : frame.columns) units[column.name] = column.unit;
  }
  std::string out =
      fmt::format("{{\n  \"schema\": \"{}\",\n  \"units\": {},\n  \"frames\": [", kTilesSchema, sim::json_line(units));
  for (const TileFrame& frame : table.frames) {
    out += fmt::format("{}\n    {{\n      \"frame\": {},\n      \"columns\": {{",
                       &frame == &table.frames.front() ? "" : ",", frame.frame);
    append_columns(frame, out);
    out += fmt::format("\n      }},\n      \"rest\": {},\n      \"totals\": {}\n    }}",
                       sim::json_line(sums_json(frame, &TileColumn::rest)),
                       sim::json_line(sums_json(frame, &TileColumn::total)));
  }
  return out + "\n  ]\n}\n";
}

TileTable load_tiles(const std::filesystem::path& file_or_folder) {
  std::error_code failed;
  const bool is_folder = std::filesystem::is_directory(file_or_folder, failed);
  const std::filesystem::path file = is_folder ? file_or_folder / kTilesFile : file_or_folder;
  const std::string name = sim::printable(file.string());
  TileTable table;
  try {
    const Json json = parse_file(sim::read_file(file, kLargestTiles), name);
    const std::string schema = json.at("schema").get<std::string>();
    if (schema != kTilesSchema) {
      throw sim::InputError(fmt::format("{}: schema '{}'; allowed: '{}'", name, sim::printable(schema), kTilesSchema));
    }
    for (const Json& frame : json.at("frames")) table.frames.push_back(frame_of(frame, json.at("units"), name));
  } catch (const sim::JsonError& error) {
    throw sim::InputError(fmt::format("{}: is no tiles.json of raywatt ({})", name, sim::printable(error.what())));
  }
  return table;
}

}  // namespace tools
