#include "tools/studies/sweep/results/results.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <new>
#include <optional>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sqlite3.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_paths.h"
#include "tools/studies/sweep/spec/condition.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::results {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostReportBytes = 256 << 20;
constexpr std::array<std::string_view, 3> kPointColumns = {"n", "id", "status"};

Value value_of(const Row& row, std::string_view name) {
  if (name == "n") return row.n;
  return name == "id" ? row.id : std::string(name_of(row.status));
}

std::optional<std::size_t> index_of(const std::vector<std::string>& names, std::string_view name) {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

/// True if `text` is a path, its end, or a group in it.
bool occurs_in(std::string_view text, std::string_view path) {
  const auto is_end = [](char c) { return c == '.' || c == '['; };
  for (std::size_t at = path.find(text); at != std::string_view::npos; at = path.find(text, at + 1)) {
    const std::size_t end = at + text.size();
    if ((at == 0 || path[at - 1] == '.') && (end == path.size() || is_end(path[end]))) return true;
  }
  return false;
}

/// Reads the numbers of the report of a point; none if it cannot be read.
std::vector<ReportNumber> read_numbers(const std::filesystem::path& folder) {
  try {
    return report_numbers(sim::parse_json(sim::read_file(folder / "report.json", kMostReportBytes)));
  } catch (const std::exception&) {
    return {};
  }
}

/// True if not all values are equal.
bool has_several(const std::vector<Value>& values) {
  return std::ranges::any_of(values, [&](const Value& value) { return value != values.front(); });
}

/// Calls `query`. An error of SQLite becomes an InputError that names the file.
template <class Query>
auto query_index(const fs::path& file, Query&& query) {
  try {
    return query();
  } catch (const SQLite::Exception& error) {
    if (error.getErrorCode() == SQLITE_NOMEM) throw std::bad_alloc();
    throw sim::InputError(
        fmt::format("{}: is damaged ({}); remove it, and it is built again", file.string(), error.what()));
  }
}

std::vector<std::string> read_texts(const SQLite::Database& index, const char* sql) {
  std::vector<std::string> texts;
  SQLite::Statement statement(index, sql);
  while (statement.executeStep()) texts.push_back(statement.getColumn(0).getString());
  return texts;
}

std::size_t row_of_point(const std::vector<Row>& rows, std::int64_t n) {
  const auto found = std::ranges::lower_bound(rows, n, {}, &Row::n);
  if (found == rows.end() || found->n != n) throw SQLite::Exception("a value belongs to no point");
  return static_cast<std::size_t>(found - rows.begin());
}

}  // namespace

std::string missing_text(const StatusCounts& counts) {
  std::size_t all = 0, without = 0;
  for (const auto& [status, count] : counts) all += count;
  std::string kinds;
  for (const PointStatus status : {PointStatus::kFailed, PointStatus::kDamaged, PointStatus::kMissing}) {
    const auto found = counts.find(status);
    if (found == counts.end()) continue;
    without += found->second;
    kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", found->second, name_of(status));
  }
  return without == 0 ? "" : fmt::format("{} of {} points have no result: {}", without, all, kinds);
}

std::unique_ptr<SQLite::Database> open_index(const fs::path& file) {
  const std::string shown = sim::printable(file.string()), sweep = sim::printable(file.parent_path().string());
  std::error_code failed;
  if (!fs::exists(file, failed)) {
    throw sim::InputError(fmt::format("{}: no such file; 'raywatt sweep collect {}' makes it", shown, sweep));
  }
  try {
    if (fs::is_regular_file(file)) {  // opening a pipe would block
      auto index = std::make_unique<SQLite::Database>(file.string(), SQLite::OPEN_READONLY, 0, "unix-none");
      index->exec("PRAGMA trusted_schema = OFF");
      if (index->execAndGet("PRAGMA user_version").getInt() == kIndexSchema) return index;
    }
  } catch (const SQLite::Exception& error) {
    if (error.getErrorCode() == SQLITE_NOMEM) throw std::bad_alloc();
  }
  throw sim::InputError(
      fmt::format("{}: is damaged or of another version; 'raywatt sweep collect {}' builds it again", shown, sweep));
}

std::map<std::string, std::string> read_facts(const SQLite::Database& index) {
  std::map<std::string, std::string> facts;
  SQLite::Statement statement(index, "SELECT key, value FROM sweep");
  while (statement.executeStep()) facts[statement.getColumn(0).getString()] = statement.getColumn(1).getString();
  return facts;
}

Value to_value(const SQLite::Column& column) {
  if (column.isNull()) return {};
  if (column.isInteger()) return std::int64_t{column.getInt64()};
  if (column.isFloat()) return column.getDouble();
  return column.getString();
}

PointStatus status_named(std::string_view name) {
  for (const PointStatus status : {PointStatus::kDone, PointStatus::kFailed, PointStatus::kMissing}) {
    if (name_of(status) == name) return status;
  }
  return PointStatus::kDamaged;
}

Results::Results(const fs::path& sweep) : file_(sweep / "index.sqlite"), index_(open_index(file_)) {
  query_index(file_, [&] {
    store_ = read_facts(*index_)["store"];
    SQLite::Statement row(*index_, "SELECT n, id, status FROM points ORDER BY n");
    while (row.executeStep()) {
      rows_.push_back(
          {row.getColumn(0).getInt64(), row.getColumn(1).getString(), status_named(row.getColumn(2).getString())});
    }
    axes_ = read_texts(*index_, "SELECT name FROM axes ORDER BY axis");
    metrics_ = read_texts(*index_, "SELECT path FROM metric_names ORDER BY metric");
  });
}

Results::~Results() = default;

fs::path Results::folder_of(const Row& row) const { return sweep::Store(store_).folder_of(row.id); }

Column Results::query_column(const std::string& name, const std::string& sql, std::int64_t number) const {
  return query_index(file_, [&] {
    Column column{name, std::vector<Value>(rows_.size())};
    SQLite::Statement cell(*index_, sql);
    if (number >= 0) cell.bind(1, number);
    while (cell.executeStep()) {
      column.values[row_of_point(rows_, cell.getColumn(0).getInt64())] = to_value(cell.getColumn(1));
    }
    return column;
  });
}

Column Results::column(std::string_view text) const {
  if (text == "error") return query_column("error", "SELECT point, error FROM errors", -1);
  if (std::ranges::find(kPointColumns, text) != kPointColumns.end()) {
    Column column{std::string(text), {}};
    for (const Row& row : rows_) column.values.push_back(value_of(row, text));
    return column;
  }
  std::vector<std::string> names = axes_;
  names.insert(names.end(), metrics_.begin(), metrics_.end());
  std::string name(text);
  if (!index_of(axes_, text)) {
    if (std::ranges::none_of(names, [&](const std::string& path) { return occurs_in(text, path); })) {
      return read_from_reports(text);
    }
    name = resolve_report_path(text, names);
  }
  if (const auto axis = index_of(axes_, name)) {
    return query_column(name, "SELECT point, value FROM parameters WHERE axis = ?", static_cast<std::int64_t>(*axis));
  }
  return query_column(name, "SELECT point, value FROM metrics WHERE metric = ?",
                      static_cast<std::int64_t>(*index_of(metrics_, name)));
}

bool Results::has_metric(std::string_view path) const { return index_of(metrics_, path).has_value(); }

std::vector<Column> Results::varying_axes() const {
  std::vector<Column> columns;
  for (const std::string& name : axes_) {
    if (Column c = column(name); has_several(c.values)) columns.push_back(std::move(c));
  }
  return columns;
}

std::string Results::missing_text() const {
  StatusCounts counts;
  for (const Row& row : rows_) ++counts[row.status];
  return results::missing_text(counts);
}

Column Results::read_from_reports(std::string_view text) const {
  std::map<std::string, std::vector<Value>, std::less<>> found;
  std::vector<std::string> paths = axes_;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!rows_[i].is_done()) continue;
    const bool is_first = paths.size() == axes_.size();
    for (const ReportNumber& number : read_numbers(folder_of(rows_[i]))) {
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

Column column_of_means(const Results& results, const std::string& path) {
  Column figure = results.column(path);
  if (!is_total(figure.name)) return figure;
  const std::string mean = fmt::format("totals.replicates.figures.{}.mean", metric_name(figure.name));
  if (!results.has_metric(mean)) return figure;
  const Column means = results.column(mean);
  for (std::size_t row = 0; row < figure.values.size(); ++row) {
    if (!is_absent(means.values[row])) figure.values[row] = means.values[row];
  }
  return figure;
}

namespace {

/// Returns "mm2" of "12mm2"; empty for a text that does not begin with a number.
std::string unknown_unit(std::string_view text) {
  double number = 0;
  const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), number);
  return bad == std::errc{} ? sim::printable(text.substr(static_cast<std::size_t>(end - text.data()))) : "";
}

/// Clears `met` for the points that do not meet one comparison of the condition `text`.
void apply_term(const Results& results, const std::string& text, const sweep::ConditionTerm& term,
                std::vector<bool>& met) {
  const auto refuse = [&](const std::string& problem) {
    throw sim::InputError(fmt::format("--where '{}': {}", sim::printable(text), problem));
  };
  const Column column = column_of_means(results, term.name);
  const sweep::Operand wanted(term.value);
  const std::string shown = sim::printable(wanted.text);
  const bool is_ordered = needs_order(term.comparison);
  if (is_ordered && !wanted.magnitude) {
    const std::string unit = unknown_unit(wanted.text);
    if (unit.empty()) refuse(fmt::format("'{}' is no number", shown));
    refuse(
        fmt::format("'{}' of '{}' is no unit of frequency, time or bytes; other figures are compared without one, in "
                    "the unit that their name ends with",
                    unit, shown));
  }
  bool has_number = false, has_text = false;
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (is_absent(column.values[i])) {
      met[i] = false;
      continue;
    }
    const sweep::Operand value(column.values[i]);
    (value.magnitude ? has_number : has_text) = true;
    if (value.magnitude && wanted.magnitude && value.magnitude->kind != wanted.magnitude->kind) {
      refuse(fmt::format("{} has values such as '{}', with which '{}' cannot be compared", column.name,
                         sim::printable(value.text), shown));
    }
    met[i] = met[i] && compare(value, term.comparison, wanted).value_or(false);
  }
  if (is_ordered && has_text && !has_number) {
    refuse(fmt::format("{} is no number; texts are compared with = and != only", column.name));
  }
}

}  // namespace

std::vector<bool> rows_meeting(const Results& results, const std::vector<std::string>& conditions) {
  std::vector<bool> met(results.rows().size(), true);
  for (const std::string& text : conditions) {
    for (const sweep::ConditionTerm& term : sweep::parse_condition(text)) apply_term(results, text, term, met);
  }
  return met;
}

std::vector<std::string> compared_paths(const std::vector<std::string>& conditions) {
  std::vector<std::string> paths;
  for (const std::string& text : conditions) {
    for (sweep::ConditionTerm& term : sweep::parse_condition(text)) {
      if (std::ranges::find(paths, term.name) == paths.end()) paths.push_back(std::move(term.name));
    }
  }
  return paths;
}

}  // namespace tools::results
