#include "tools/studies/sweep/results/results.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
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
#include "sim/report/table.h"
#include "tools/analysis/report_file.h"
#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/results/machine_set.h"
#include "tools/studies/sweep/spec/condition.h"
#include "tools/studies/sweep/spec/set_metric.h"
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

/// True if `text` is one or more successive keys of `path`.
bool is_part_of_path(std::string_view text, std::string_view path) {
  const auto is_end = [](char c) { return c == '.' || c == '['; };
  for (std::size_t at = path.find(text); at != std::string_view::npos; at = path.find(text, at + 1)) {
    const std::size_t end = at + text.size();
    if ((at == 0 || path[at - 1] == '.') && (end == path.size() || is_end(path[end]))) return true;
  }
  return false;
}

/// Reads all numbers of a point's report; returns none if the report cannot be read.
std::vector<ReportNumber> read_numbers(const std::filesystem::path& folder) {
  try {
    return report_numbers(sim::parse_json(sim::read_file(folder / "report.json", kMostReportBytes)));
  } catch (const std::exception&) {
    return {};
  }
}

/// True if not all values are equal.
bool has_different_values(const std::vector<Value>& values) {
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

PointStatus parse_status(std::string_view name) {
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
          {row.getColumn(0).getInt64(), row.getColumn(1).getString(), parse_status(row.getColumn(2).getString())});
    }
    axes_ = read_texts(*index_, "SELECT name FROM axes ORDER BY axis");
    metrics_ = read_texts(*index_, "SELECT path FROM metric_names ORDER BY metric");
    machines_ = std::make_unique<const MachineSet>(read_machines());
  });
}

Results::~Results() = default;

MachineSet Results::read_machines() const {
  MachineSet set;
  set.workloads = read_texts(*index_, "SELECT name FROM workloads ORDER BY workload");
  set.axes = read_texts(*index_, "SELECT name FROM axes WHERE of_machine ORDER BY axis");
  if (set.workloads.empty()) {
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      set.rows.push_back({row});
      set.machine_of.push_back(row);
    }
    return set;
  }
  set.machine_of.resize(rows_.size());
  SQLite::Statement point(*index_, "SELECT machine, workload, point FROM machine_points ORDER BY machine, workload");
  while (point.executeStep()) {
    const auto machine = static_cast<std::size_t>(point.getColumn(0).getInt64());
    const auto workload = static_cast<std::size_t>(point.getColumn(1).getInt64());
    if (machine > set.rows.size() || workload >= set.workloads.size()) throw SQLite::Exception("machines are damaged");
    if (machine == set.rows.size()) set.rows.emplace_back(set.workloads.size());
    const std::size_t row = row_of_point(rows_, point.getColumn(2).getInt64());
    set.rows[machine][workload] = row;
    set.machine_of[row] = machine;
  }
  return set;
}

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

Column Results::column(std::string_view text, std::optional<bool> larger_in_goal) const {
  if (index_of(axes_, text) || text.find('(') == std::string_view::npos) return column_of_points(text);
  const sweep::SetMetric metric = sweep::parse_set_metric(text);
  return fold_column_over_workloads(*machines_, metric, column_of_points(metric.path), larger_in_goal);
}

Column Results::column_of_points(std::string_view text) const {
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
    if (std::ranges::none_of(names, [&](const std::string& path) { return is_part_of_path(text, path); })) {
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
    if (Column c = column(name); has_different_values(c.values)) columns.push_back(std::move(c));
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
      if (!is_part_of_path(text, number.path)) continue;
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

namespace {

/// In the column of a metric, replaces the value of each point that has replicates by their mean.
Column with_means(const Results& results, Column figure) {
  if (!is_totals_path(figure.name)) return figure;
  const std::string mean = fmt::format("totals.replicates.figures.{}.mean", metric_name(figure.name));
  if (!results.has_metric(mean)) return figure;
  const Column means = results.column(mean);
  for (std::size_t row = 0; row < figure.values.size(); ++row) {
    if (!is_absent(means.values[row])) figure.values[row] = means.values[row];
  }
  return figure;
}

}  // namespace

Column column_of_means(const Results& results, const std::string& path, std::optional<bool> larger_in_goal) {
  Column figure = results.column(path, larger_in_goal);
  if (!figure.fold) return with_means(results, std::move(figure));
  return fold_other_values(results.machines(), *figure.fold, with_means(results, figure.fold->points));
}

namespace {

/// Returns the text after the number in a value: "mm2" for "12mm2". Empty for a text that does not begin with a number.
std::string unknown_unit(std::string_view text) {
  double number = 0;
  const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), number);
  return bad == std::errc{} ? sim::printable(text.substr(static_cast<std::size_t>(end - text.data()))) : "";
}

/// Sets `met` to false for each point that does not meet `term`, one comparison of the condition `text`.
void apply_term(const Results& results, const std::string& text, const sweep::ConditionTerm& term,
                std::vector<bool>& met) {
  const auto refuse = [&](const std::string& problem) {
    throw sim::InputError(fmt::format("--where '{}': {}", sim::printable(text), problem));
  };
  const bool is_lower_limit =
      term.comparison == sweep::Comparison::kGreater || term.comparison == sweep::Comparison::kGreaterEqual;
  const bool is_ordered = needs_order(term.comparison);
  const Column column = column_of_means(results, term.name, is_ordered ? std::optional(is_lower_limit) : std::nullopt);
  const sweep::Operand wanted(term.value);
  const std::string shown = sim::printable(wanted.text);
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

namespace {

bool is_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

/// True if a spreadsheet would run the text as a formula.
bool is_formula(std::string_view text) {
  constexpr std::string_view kFirst = "=+-@\t\r";
  return !text.empty() && kFirst.find(text.front()) != std::string_view::npos && !is_number(text);
}

}  // namespace

std::string csv_cell(std::string_view text) {
  std::string plain = is_formula(text) ? "'" : "";
  plain += text;
  if (plain.find_first_of(",\"\r\n") == std::string::npos) return plain;
  std::string cell(1, '"');
  for (const char c : plain) cell.append(c == '"' ? 2 : 1, c);
  cell += '"';
  return cell;
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) line += ',';
    line += csv_cell(cell);
  }
  line += '\n';
  return line;
}

namespace {

constexpr int kDigits = 4;

/// Returns the decimal exponent of a number after rounding to the digits that are shown.
int exponent_of(double number) {
  const std::string text = fmt::format("{:.{}e}", number, kDigits - 1);
  const char* digits = text.data() + text.find('e') + 1;
  int exponent = 0;
  std::from_chars(*digits == '+' ? digits + 1 : digits, text.data() + text.size(), exponent);
  return exponent;
}

/// Returns a number as text without a metric prefix. Counts below 10,000 are written in full.
std::string plain_text(double number, bool is_count) {
  return is_count && std::abs(number) < 10'000 ? fmt::format("{:.0f}", number) : sim::four_digit_text(number);
}

/// The metric prefix (k, M, ...) of all numbers of a column: that of the largest, if it has more than four digits.
class SharedPrefix {
 public:
  void add_number(double number) { largest_ = std::max(largest_, exponent_of(number)); }

  std::string text(double number, bool is_count) const {
    constexpr std::string_view kPrefixes[] = {"", "k", "M", "G", "T", "P"};
    if (largest_ < kDigits) return plain_text(number, is_count);
    const int group = std::min(largest_ / 3, 5);
    if (number == 0 || exponent_of(number) < 3 * group - 1)
      return plain_text(number, is_count);  // too small for the prefix
    return fmt::format("{} {}", sim::four_digit_text(number / std::pow(10.0, 3 * group)), kPrefixes[group]);
  }

 private:
  int largest_ = 0;
};

/// Returns the cells of a column for display. `shortens`: show whole numbers with four digits, because they are values
/// of a metric; otherwise they are names or settings.
std::vector<std::string> cells_of(const std::vector<Value>& values, bool shortens) {
  const auto number_in = [&](const Value& value) -> std::optional<double> {
    if (const auto* real = std::get_if<double>(&value)) return *real;
    const auto* count = std::get_if<std::int64_t>(&value);
    return count != nullptr && shortens ? std::optional(static_cast<double>(*count)) : std::nullopt;
  };
  SharedPrefix prefix;
  for (const Value& value : values) {
    if (const auto number = number_in(value)) prefix.add_number(*number);
  }
  std::vector<std::string> cells;
  for (const Value& value : values) {
    const auto number = number_in(value);
    if (number) {
      cells.push_back(prefix.text(*number, std::holds_alternative<std::int64_t>(value)));
    } else {
      cells.push_back(is_absent(value) ? "-" : sim::printable(exact_text(value)));
    }
  }
  return cells;
}

}  // namespace

std::string number_text(double number) { return plain_text(number, number == std::trunc(number)); }

std::vector<std::string> shown_cells(const std::vector<Value>& values) { return cells_of(values, false); }

std::vector<std::string> shown_cells(const Column& column, const std::vector<std::size_t>& rows) {
  std::vector<Value> values;
  for (const std::size_t row : rows) values.push_back(column.values[row]);
  return cells_of(values, is_totals_path(report_path(column)));
}

std::string shown_name(const Column& column) {
  if (!column.fold) return sim::printable(metric_name(column.name));
  sweep::SetMetric metric = column.fold->metric;
  metric.path = metric_name(column.fold->points.name);
  return sim::printable(metric.text());
}

namespace {

/// Metrics that a table shows if no columns are requested.
constexpr const char* kUsualColumns[] = {"cycles", "perf.fps", "energy_mj.nominal", "power_w.nominal",
                                         "perf.frames_per_joule_gpu"};

/// Returns the CSV columns of a metric: mean and interval if there are replicates, otherwise only its value.
std::vector<std::string> statistics_of(const Results& results, const std::string& figure) {
  const std::string at = fmt::format("totals.replicates.figures.{}.", figure);
  if (!results.has_metric(at + "mean")) return {figure};
  return {at + "mean", at + "low", at + "high"};
}

std::vector<std::string> usual_columns(const Results& results, bool csv) {
  std::vector<std::string> names = {"n", "status"};
  for (const Column& column : results.varying_axes()) names.push_back(column.name);
  for (const char* metric : kUsualColumns) {
    if (!results.has_metric(fmt::format("totals.{}", metric))) continue;
    for (std::string& name : csv ? statistics_of(results, metric) : std::vector<std::string>{metric}) {
      names.push_back(std::move(name));
    }
  }
  constexpr const char* kExtrapolated = "totals.extrapolated";
  const auto some = [](const Value& value) { return !is_absent(value) && exact_text(value) != "0"; };
  if (results.has_metric(kExtrapolated) && std::ranges::any_of(results.column(kExtrapolated).values, some)) {
    names.emplace_back("extrapolated");
  }
  return names;
}

/// Returns the default columns of a table of machines: axes, and aggregates of the main metrics.
std::vector<std::string> usual_machine_columns(const Results& results) {
  std::vector<std::string> names = {"n", "status"};
  for (const Column& column : results.varying_axes()) {
    if (results.machines().is_axis(column.name)) names.push_back(column.name);
  }
  constexpr std::array kAggregates = {
      std::pair{"geomean(perf.fps)", "totals.perf.fps"},
      std::pair{"worst(perf.fps)", "totals.perf.fps"},
      std::pair{"worst(fps_margin)", "totals.fps_margin"},
      std::pair{"worst(power_w.nominal)", "totals.power_w.nominal"},
      std::pair{"worst(power_at_fps_w.nominal)", "totals.power_at_fps_w.nominal"},
      std::pair{"geomean(perf.frames_per_joule_gpu)", "totals.perf.frames_per_joule_gpu"},
      std::pair{"worst(psnr_db)", "totals.psnr_db"},
      std::pair{"area_mm2", "totals.area_mm2"}};
  for (const auto& [column, path] : kAggregates) {
    if (results.has_metric(path)) names.emplace_back(column);
  }
  return names;
}

/// Selects the machines that a table shows, by their first rows. Replaces columns of points by columns of machines.
std::vector<bool> select_machines(const Results& results, std::vector<Column>& columns,
                                  const std::vector<std::string>& where) {
  std::vector<const Column*> metrics;
  for (const Column& column : columns) {
    const bool is_own = std::ranges::find(kPointColumns, column.name) != kPointColumns.end();
    if (!is_own && column.name != "error") metrics.push_back(&column);
  }
  RankedRows rows = select_ranked(results, metrics, where);
  if (!rows.by_machine) {
    throw sim::InputError(
        "--machines: --where may not select by workload; allowed: a function, such as on(NAME, fps)>30");
  }
  for (Column& column : columns) {
    if (column.name == "n") column = rows.numbers(results);
    if (column.name == "status") column = machine_status(results);
  }
  return std::move(rows.selected);
}

/// Adds the 95 % interval to each value, as in "771200 ± 0.52 %", if all finished points were simulated in replicates.
Column add_intervals(const Results& results, Column column) {
  if (!results.has_metric("totals.replicates.count")) return column;
  std::vector<std::size_t> done;
  for (std::size_t row = 0; row < results.rows().size(); ++row) {
    if (results.rows()[row].is_done() && !is_absent(column.values[row])) done.push_back(row);
  }
  const MetricNoise noise(results, column, done);
  if (!noise.is_measured()) return column;
  const std::vector<std::string> means = shown_cells(noise.means(), done);
  for (std::size_t i = 0; i < done.size(); ++i) {
    column.values[done[i]] = fmt::format("{} {}", means[i], interval_text(noise, done[i]));
  }
  return column;
}

/// Sorts rows by "column" or "column:desc". Absent values come last in both orders.
void sort_rows(std::vector<std::size_t>& rows, const Results& results, const std::string& text) {
  const std::size_t colon = text.ends_with(')') ? std::string::npos : text.rfind(':');
  const std::string order = colon == std::string::npos ? "asc" : text.substr(colon + 1);
  if (order != "asc" && order != "desc") {
    throw sim::InputError(fmt::format("--sort '{}': the order '{}' is unknown; allowed: asc, desc",
                                      sim::printable(text), sim::printable(order)));
  }
  const Column column = column_of_means(results, text.substr(0, colon));
  std::ranges::stable_sort(rows, [&](std::size_t a, std::size_t b) {
    const Value &x = column.values[a], &y = column.values[b];
    if (is_absent(x) || is_absent(y)) return !is_absent(x) && is_absent(y);
    return order == "asc" ? sorts_before(x, y) : sorts_before(y, x);
  });
}

}  // namespace

std::string table_text(const std::vector<std::string>& names, const std::vector<Column>& columns,
                       const std::vector<std::size_t>& rows, bool csv) {
  std::vector<std::vector<std::string>> cells;
  for (const Column& column : columns) {
    if (!csv) {
      cells.push_back(shown_cells(column, rows));
      continue;
    }
    cells.emplace_back();
    for (const std::size_t row : rows) cells.back().push_back(exact_text(column.values[row]));
  }
  sim::Table table(names);
  std::string lines = csv_line(names);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<std::string> row;
    for (std::vector<std::string>& column : cells) row.push_back(std::move(column[i]));
    if (csv) {
      lines += csv_line(row);
    } else {
      table.add_row(std::move(row));
    }
  }
  return csv ? lines : table.text();
}

std::string results_table(const Results& results, const TableOptions& options) {
  const bool is_usual = options.columns.empty();
  if (options.machines && !results.machines().is_set()) {
    throw sim::InputError("--machines: the sweep has no list of workloads; allowed: a table without it");
  }
  const std::vector<std::string> asked = !is_usual          ? options.columns
                                         : options.machines ? usual_machine_columns(results)
                                                            : usual_columns(results, options.csv);
  std::vector<Column> columns;
  for (const std::string& name : asked) columns.push_back(results.column(name));
  const bool by_machine = options.machines || std::ranges::any_of(columns, [&](const Column& column) {
                            return column.fold && results.machines().is_set();
                          });
  std::vector<bool> met;
  if (by_machine) {
    met = select_machines(results, columns, options.where);
  } else {
    met = rows_meeting(results, options.where);
  }
  std::vector<std::string> names;
  for (Column& column : columns) {
    if (!options.csv) column = add_intervals(results, std::move(column));
    names.push_back(options.csv ? column.name : shown_name(column));
  }
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (met[i]) rows.push_back(i);
  }
  if (!options.sort.empty()) sort_rows(rows, results, options.sort);
  if (options.limit && rows.size() > *options.limit) rows.resize(*options.limit);
  const bool is_empty = rows.empty() && !options.where.empty() && !options.csv;
  return table_text(names, columns, rows, options.csv) +
         (is_empty ? fmt::format("no {} meets --where\n", by_machine ? "machine" : "point") : "");
}

}  // namespace tools::results
