#include "tools/studies/sweep/results/results.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "tools/analysis/report_paths.h"
#include "tools/studies/sweep/results/index/point_state.h"

namespace tools::results {
namespace {

constexpr std::uint64_t kMostReportBytes = 256 << 20;

const std::vector<std::string>& own_columns() {
  static const std::vector<std::string> kNames = {"n", "id", "status", "error"};
  return kNames;
}

Value own_value(const Row& row, std::string_view name) {
  if (name == "n") return row.n;
  return name == "id" ? row.id : row.status;
}

std::optional<std::size_t> find(const std::vector<std::string>& names, std::string_view name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

/// Does `text` stand for a path, its end, or a group in it?
bool occurs_in(std::string_view text, std::string_view path) {
  const auto is_end = [](char c) { return c == '.' || c == '['; };
  for (std::size_t at = path.find(text); at != std::string_view::npos; at = path.find(text, at + 1)) {
    const std::size_t end = at + text.size();
    if ((at == 0 || path[at - 1] == '.') && (end == path.size() || is_end(path[end]))) return true;
  }
  return false;
}

/// Numbers of the report of a point; none if it can no longer be read.
std::vector<ReportNumber> numbers_of(const std::filesystem::path& folder) {
  try {
    return report_numbers(sim::parse_json(sim::read_file(folder / "report.json", kMostReportBytes)));
  } catch (const std::exception&) {
    return {};
  }
}

bool varies(const std::vector<Value>& values) {
  return std::ranges::any_of(values, [&](const Value& value) { return value != values.front(); });
}

}  // namespace

Results::Results(const std::filesystem::path& sweep) : index_(open_index(sweep / "index.sqlite")) {
  store_ = read_facts(index_)["store"];
  Statement row = index_.prepare("SELECT n, id, status FROM points ORDER BY n");
  while (row.step()) rows_.push_back({row.number(0), row.text(1), row.text(2)});
  Statement axis = index_.prepare("SELECT name FROM axes ORDER BY axis");
  while (axis.step()) axes_.push_back(axis.text(0));
  Statement metric = index_.prepare("SELECT path FROM metric_names ORDER BY metric");
  while (metric.step()) metrics_.push_back(metric.text(0));
}

std::filesystem::path Results::folder_of(const Row& row) const { return sweep::Store(store_).folder(row.id); }

Column Results::column(std::string_view text) const {
  if (text == "error") return of_errors();
  if (find(own_columns(), text)) {
    Column column{std::string(text), {}};
    for (const Row& row : rows_) column.values.push_back(own_value(row, text));
    return column;
  }
  if (const auto axis = find(axes_, text)) return of_axis(*axis, axes_[*axis]);
  std::vector<std::string> names = axes_;
  names.insert(names.end(), metrics_.begin(), metrics_.end());
  if (std::ranges::none_of(names, [&](const std::string& name) { return occurs_in(text, name); })) {
    return of_reports(text);
  }
  const std::string name = resolve_report_path(text, names);
  if (const auto axis = find(axes_, name)) return of_axis(*axis, name);
  return of_metric(*find(metrics_, name), name);
}

bool Results::has_metric(std::string_view path) const { return find(metrics_, path).has_value(); }

std::vector<Column> Results::varying() const {
  std::vector<Column> columns;
  for (const std::string& name : axes_) {
    if (Column c = column(name); varies(c.values)) columns.push_back(std::move(c));
  }
  return columns;
}

std::string Results::what_is_missing() const {
  StatusCounts counts;
  for (const Row& row : rows_) ++counts[row.status];
  return missing_text(counts);
}

std::size_t Results::place_of(std::int64_t n) const {
  const auto found = std::ranges::lower_bound(rows_, n, {}, &Row::n);
  if (found == rows_.end() || found->n != n) throw SqliteError("a value belongs to no point");
  return static_cast<std::size_t>(found - rows_.begin());
}

Column Results::of_metric(std::size_t number, const std::string& path) const {
  Column column{path, std::vector<Value>(rows_.size())};
  Statement cell = index_.prepare("SELECT point, value FROM metrics WHERE metric = ?");
  cell.bind(1, static_cast<std::int64_t>(number));
  while (cell.step()) column.values[place_of(cell.number(0))] = cell.value(1);
  return column;
}

Column Results::of_axis(std::size_t number, const std::string& name) const {
  Column column{name, std::vector<Value>(rows_.size())};
  Statement cell = index_.prepare("SELECT point, value FROM parameters WHERE axis = ?");
  cell.bind(1, static_cast<std::int64_t>(number));
  while (cell.step()) column.values[place_of(cell.number(0))] = cell.text(1);
  return column;
}

Column Results::of_errors() const {
  Column column{"error", std::vector<Value>(rows_.size())};
  Statement cell = index_.prepare("SELECT point, error FROM errors");
  while (cell.step()) column.values[place_of(cell.number(0))] = cell.text(1);
  return column;
}

Column Results::of_reports(std::string_view text) const {
  std::map<std::string, std::vector<Value>, std::less<>> found;
  std::vector<std::string> paths = axes_;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!rows_[i].is_done()) continue;
    const bool is_first = paths.size() == axes_.size();
    for (const ReportNumber& number : numbers_of(folder_of(rows_[i]))) {
      if (is_first) paths.push_back(number.path);
      if (!occurs_in(text, number.path)) continue;
      std::vector<Value>& values = found[number.path];
      values.resize(rows_.size());
      values[i] = number.value;
    }
  }
  for (const auto& [path, values] : found) {
    if (std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
  }
  std::string path = resolve_report_path(text, paths);
  return {path, found[path]};
}

}  // namespace tools::results
