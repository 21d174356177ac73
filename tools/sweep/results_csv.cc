#include "tools/sweep/results_csv.h"

#include <map>

#include <fmt/format.h>

#include "sim/io/file.h"

namespace tools::sweep {

namespace {

using Json = nlohmann::ordered_json;

/// Numbers and texts of a report, by path.
void flatten(const Json& json, const std::string& path, std::vector<std::pair<std::string, std::string>>& cells) {
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) flatten(value, path.empty() ? key : path + "." + key, cells);
  } else if (!json.is_array()) {
    cells.emplace_back(path, json.is_string() ? json.get<std::string>() : json.dump());
  }
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out(1, '"');
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  out += '"';
  return out;
}

struct Row {
  std::vector<std::string> head;
  std::map<std::string, std::string> cells;
};

}  // namespace

void write_results_csv(const SweepFolder& folder) {
  const Store store = folder.store();
  const std::vector<Point> points = folder.points();
  std::vector<std::string> names = {"n", "id", "status"};
  for (const auto& [name, value] : points.front().axes) names.push_back(name);
  const std::size_t head = names.size();
  std::map<std::string, std::size_t> known;
  std::vector<Row> rows;
  for (const Point& point : points) {
    const std::optional<std::string> report = store.report(point.id);
    const char* status = report ? "done" : store.failure(point.id) ? "failed" : "missing";
    Row row{{std::to_string(point.n), point.id, status}, {}};
    for (const auto& [name, value] : point.axes) row.head.push_back(value);
    std::vector<std::pair<std::string, std::string>> cells;
    if (report) flatten(Json::parse(*report).at("totals"), "totals", cells);
    for (auto& [name, value] : cells) {
      if (known.emplace(name, names.size()).second) names.push_back(name);
      row.cells.emplace(name, std::move(value));
    }
    rows.push_back(std::move(row));
  }
  std::string text;
  const auto add_line = [&](auto&& cell) {
    for (std::size_t c = 0; c < names.size(); ++c) {
      if (c != 0) text += ',';
      text += quoted(cell(c));
    }
    text += '\n';
  };
  add_line([&](std::size_t c) { return names[c]; });
  for (const Row& row : rows) {
    add_line([&](std::size_t c) {
      if (c < head) return row.head.at(c);
      const auto cell = row.cells.find(names[c]);
      return cell != row.cells.end() ? cell->second : std::string();
    });
  }
  sim::write_file_atomically(folder.path() / "results.csv", text);
}

}  // namespace tools::sweep
