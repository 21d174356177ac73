#include "tools/studies/sweep/results/collect.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <new>
#include <thread>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/sha256.h"
#include "tools/analysis/report_file.h"
#include "tools/host/parallel.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/results/machine_set.h"
#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/spec/set_metric.h"

namespace tools::results {
namespace {

namespace fs = std::filesystem;
using sim::Json;

constexpr std::size_t kDeepest = 32;  // maximum nesting depth of a report

/// Returns a scalar as the index stores it; absent for null, arrays and objects.
Value scalar_of(const Json& json) {
  if (json.is_boolean()) return std::string(json.get<bool>() ? "true" : "false");
  if (json.is_string()) return json.get<std::string>();
  const auto is_large = [](const Json& j) {
    return j.is_number_unsigned() && j.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()};
  };
  if (json.is_number_float() || is_large(json)) return json.get<double>();
  return json.is_number_integer() ? Value(json.get<std::int64_t>()) : Value();
}

/// Adds all scalars of a report to `scan`, with their paths such as "totals.top_down.cores[2].boxes".
void add_metrics(const Json& json, const std::string& path, MetricNames& names, ReportScan& scan) {
  if (json.is_array()) {
    for (std::size_t i = 0; i < json.size(); ++i) add_metrics(json[i], fmt::format("{}[{}]", path, i), names, scan);
  } else if (json.is_object()) {
    for (const auto& [name, value] : json.items()) add_metrics(value, path + "." + name, names, scan);
  } else if (Value value = scalar_of(json); !is_absent(value)) {
    scan.metrics.emplace_back(names.number_of(path), std::move(value));
  }
}

/// Returns the scalars at these dotted paths of a JSON value; an absent value where there is none.
template <std::size_t kCount>
std::array<Value, kCount> scalars_at(const Json& json, const std::array<const char*, kCount>& paths) {
  std::array<Value, kCount> values;
  for (std::size_t i = 0; i < kCount; ++i) {
    std::string pointer = std::string("/") + paths[i];
    std::ranges::replace(pointer, '.', '/');
    if (const sim::JsonPointer at(pointer); json.contains(at)) values[i] = scalar_of(json.at(at));
  }
  return values;
}

}  // namespace

std::optional<std::string> scan_report(std::string_view text, MetricNames& names, ReportScan& scan) {
  Json report;
  try {
    report = sim::parse_json(text);
  } catch (const sim::JsonError& error) {
    const std::string_view what = error.what();
    const std::size_t head = what.find("] ");  // end of "[json.exception.parse_error.101] "
    return sim::printable(what.substr(head == std::string_view::npos ? 0 : head + 2));
  } catch (const sim::InputError& error) {
    return error.what();
  }
  if (sim::is_nested_deeper(text, kDeepest)) return "it is nested more deeply than any report";
  const auto has = [&](const char* name) { return report.is_object() && report.contains(name); };
  if (!has("schema") || !report["schema"].is_string() || !report["schema"].get<std::string>().starts_with("raywatt-")) {
    return "it is no report: it has no schema";
  }
  if (has("partial") && report["partial"] == true) return "it is of an interrupted run";
  if (has("totals")) {
    for (const char* name : kPsnrNames) {
      Json& totals = report["totals"];
      if (totals.is_object() && totals.contains(name) && totals[name].is_null()) totals[name] = kIdenticalPsnr;
    }
    add_metrics(report["totals"], "totals", names, scan);
  }
  if (has("frames") && report["frames"].is_array()) {
    for (const Json& frame : report["frames"]) scan.frames.push_back(scalars_at(frame, kFrameFigures));
  }
  if (has("host")) scan.host = scalars_at(report["host"], kHostFacts);
  return scan.metrics.empty() ? std::optional<std::string>("it has no totals") : std::nullopt;
}

namespace {

/// A point of a sweep, with what tables show of it.
struct ListedPoint {
  std::int64_t n = 0;
  std::string id;
  /// Names and values of the point: its axes, then scene, program and so on unless these are axes.
  std::vector<std::pair<std::string, std::string>> axes;
};

/// Reason that a point has no result.
struct PointError {
  std::string text, log;
  Value exit, host, attempt;
};

struct PointState {
  PointStatus status = PointStatus::kMissing;
  ReportScan report;  ///< values of the report of a point that is done
  PointError error;   ///< error of a point that failed or is damaged
};

std::vector<ListedPoint> list_points(std::span<const sweep::Point> points) {
  std::vector<ListedPoint> listed;
  for (const sweep::Point& point : points) {
    ListedPoint& line = listed.emplace_back(ListedPoint{static_cast<std::int64_t>(point.n), point.id, point.axes});
    for (const auto& [name, option, member, job] : sweep::kPointTexts) {
      const bool is_axis =
          std::ranges::find(point.axes, name, [](const auto& axis) { return axis.first; }) != point.axes.end();
      if (!is_axis && !(point.*member).empty()) line.axes.emplace_back(name, point.*member);
    }
  }
  return listed;
}

PointState damaged_state(std::string why) {
  PointState state;
  state.status = PointStatus::kDamaged;
  state.error.text = std::move(why);
  return state;
}

/// Reads a point from the store. A point with a malformed or unfinished report counts as damaged.
PointState read_point_state(const sweep::Store& store, const std::string& id, MetricNames& names) try {
  PointState state;
  if (const std::optional<std::string> report = store.read_report(id)) {
    state.status = PointStatus::kDone;
    const std::optional<std::string> problem = scan_report(*report, names, state.report);
    return problem ? damaged_state("report.json: " + *problem) : state;
  }
  state.status = listed_status(store, id);
  if (state.status != PointStatus::kMissing && state.status != PointStatus::kFailed) {
    return damaged_state("its files are not as they were written");
  }
  if (state.status == PointStatus::kMissing) return state;
  if (const std::optional<sweep::Failure> failure = store.read_failure(id)) {
    state.error = {failure->error, failure->log, std::int64_t{failure->exit}, failure->host,
                   std::int64_t{failure->attempt}};
  } else {
    state.error.text = "the record of its failure is damaged";
  }
  return state;
} catch (const sim::InputError& error) {
  return damaged_state(error.what());
} catch (const sim::IoError& error) {
  return damaged_state(error.what());
} catch (const fs::filesystem_error& error) {
  return damaged_state(error.what());
}

/// All points of a sweep with their results.
struct Collection {
  std::vector<ListedPoint> points;
  std::vector<PointState> states;           ///< states of the points without their metrics, which are in `columns`
  std::vector<std::string> axes;            ///< names, in the order of their first use
  std::vector<std::string> metrics;         ///< paths, in the order of their first use
  std::vector<std::vector<Value>> columns;  ///< values by metric, then by point
};

/// Reads all points of a sweep from the store, on all host cores. The result does not depend on the number of cores.
Collection read_all_points(std::vector<ListedPoint> points, const sweep::Store& store) {
  constexpr std::uint32_t kUnknown = std::numeric_limits<std::uint32_t>::max();
  /// The metrics that a reader thread has found. `global`: for each of `names`, its number in the whole collection.
  struct Reader {
    MetricNames names;
    std::vector<std::uint32_t> global;
  };
  Collection all;
  all.points = std::move(points);
  all.states.resize(all.points.size());
  const std::size_t cores = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 8);
  std::vector<Reader> readers(std::min(cores, all.points.size()));
  std::vector<std::size_t> reader_of(all.points.size());
  parallel_for(all.points.size(), readers.size(), [&](std::size_t i, std::size_t reader) {
    all.states[i] = read_point_state(store, all.points[i].id, readers[reader].names);
    reader_of[i] = reader;
  });
  MetricNames names, axes;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    for (const auto& [axis, value] : all.points[i].axes) axes.number_of(axis);
    if (all.states[i].status != PointStatus::kDone) continue;
    Reader& reader = readers[reader_of[i]];
    reader.global.resize(reader.names.names().size(), kUnknown);
    for (auto& [number, value] : std::exchange(all.states[i].report.metrics, {})) {
      std::uint32_t& global = reader.global[number];
      if (global == kUnknown) global = names.number_of(reader.names.names()[number]);
      if (all.columns.size() <= global) all.columns.resize(global + 1, std::vector<Value>(all.points.size()));
      all.columns[global][i] = std::move(value);
    }
  }
  all.metrics = names.names();
  all.axes = axes.names();
  return all;
}

// Values are stored column by column, because queries read few columns of all points.
constexpr const char* kTables = R"(
PRAGMA user_version = 2;
CREATE TABLE sweep (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE points (
  n INTEGER PRIMARY KEY,
  id TEXT NOT NULL,
  status TEXT NOT NULL CHECK (status IN ('done', 'failed', 'missing', 'damaged')));
CREATE TABLE axes (
  axis INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE,
  of_machine INTEGER NOT NULL); -- 0: the workload determines its value
CREATE TABLE parameters (
  axis INTEGER NOT NULL REFERENCES axes, point INTEGER NOT NULL REFERENCES points,
  value TEXT NOT NULL,
  number REAL, -- in bytes, hertz, femtoseconds, or as it stands
  PRIMARY KEY (axis, point)) WITHOUT ROWID;
CREATE TABLE metric_names (
  metric INTEGER PRIMARY KEY, path TEXT NOT NULL UNIQUE,
  better TEXT); -- 'more', 'less', or NULL if unknown
CREATE TABLE workloads (workload INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE);
CREATE TABLE machine_points (
  machine INTEGER NOT NULL, workload INTEGER NOT NULL REFERENCES workloads,
  point INTEGER PRIMARY KEY REFERENCES points);
CREATE TABLE metrics (
  metric INTEGER NOT NULL REFERENCES metric_names, point INTEGER NOT NULL REFERENCES points,
  value NOT NULL,
  PRIMARY KEY (metric, point)) WITHOUT ROWID;
CREATE TABLE frames (
  point INTEGER NOT NULL REFERENCES points, place INTEGER NOT NULL,
  frame INTEGER, cycles INTEGER, time_ms REAL, rays INTEGER, traversal_steps INTEGER, dram_bytes INTEGER,
  energy_mj REAL, power_w REAL, traced_ratio REAL, psnr_db REAL,
  PRIMARY KEY (point, place)) WITHOUT ROWID;
CREATE TABLE errors (
  point INTEGER PRIMARY KEY REFERENCES points, error TEXT NOT NULL, exit INTEGER, host TEXT, attempt INTEGER,
  log TEXT NOT NULL);
CREATE TABLE host (
  point INTEGER PRIMARY KEY REFERENCES points, name TEXT, date TEXT, threads INTEGER, wall_s REAL, timing_s REAL,
  rays_per_s REAL, peak_rss_mb REAL);
CREATE VIEW results AS
  SELECT point, id, status, path, value FROM metrics JOIN metric_names USING (metric) JOIN points ON n = point;
CREATE VIEW machines AS
  SELECT machine, path, AVG(value) AS mean,
         CASE better WHEN 'more' THEN MIN(value) WHEN 'less' THEN MAX(value) END AS worst
  FROM metrics JOIN metric_names USING (metric) JOIN machine_points USING (point)
  WHERE typeof(value) IN ('integer', 'real')
  GROUP BY machine, metric HAVING COUNT(*) = (SELECT COUNT(*) FROM workloads);
)";

constexpr const char* kIndices = R"(
CREATE INDEX points_by_id ON points (id);
CREATE INDEX points_by_status ON points (status);
)";

void bind_value(SQLite::Statement& statement, int parameter, const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    statement.bind(parameter, *text);
  } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    statement.bind(parameter, *whole);
  } else if (const auto* real = std::get_if<double>(&value)) {
    statement.bind(parameter, *real);
  } else {
    statement.bind(parameter);
  }
}

/// Executes an SQL statement that inserts a row of values.
void insert_row(SQLite::Statement& statement, std::span<const Value> values) {
  for (int parameter = 1; const Value& value : values) bind_value(statement, parameter++, value);
  statement.exec();
  statement.reset();
}
void insert_row(SQLite::Statement& statement, std::initializer_list<Value> values) {
  insert_row(statement, std::span(values.begin(), values.size()));
}

void write_points(SQLite::Database& index, const Collection& all) {
  SQLite::Statement point(index, "INSERT INTO points VALUES (?, ?, ?)");
  SQLite::Statement error(index, "INSERT INTO errors VALUES (?, ?, ?, ?, ?, ?)");
  SQLite::Statement frame(index, "INSERT INTO frames VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  SQLite::Statement host(index, "INSERT INTO host VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    const std::int64_t n = all.points[i].n;
    const PointState& state = all.states[i];
    insert_row(point, {n, all.points[i].id, std::string(name_of(state.status))});
    if (state.status == PointStatus::kFailed || state.status == PointStatus::kDamaged) {
      const PointError& e = state.error;
      insert_row(error, {n, e.text, e.exit, e.host, e.attempt, e.log});
    }
    if (state.status != PointStatus::kDone) continue;
    for (std::size_t f = 0; f < state.report.frames.size(); ++f) {
      std::vector<Value> row = {n, static_cast<std::int64_t>(f)};
      row.insert(row.end(), state.report.frames[f].begin(), state.report.frames[f].end());
      insert_row(frame, row);
    }
    std::vector<Value> row = {n};
    row.insert(row.end(), state.report.host.begin(), state.report.host.end());
    insert_row(host, row);
  }
}

void write_axes(SQLite::Database& index, const Collection& all, const MachineSet& machines) {
  SQLite::Statement axis(index, "INSERT INTO axes VALUES (?, ?, ?)");
  SQLite::Statement parameter(index, "INSERT INTO parameters VALUES (?, ?, ?, ?)");
  for (std::size_t a = 0; a < all.axes.size(); ++a) {
    const auto number = static_cast<std::int64_t>(a);
    insert_row(axis, {number, all.axes[a], std::int64_t{machines.is_axis(all.axes[a])}});
    for (const ListedPoint& point : all.points) {
      for (const auto& [name, value] : point.axes) {
        if (name != all.axes[a]) continue;
        const std::optional<sweep::Magnitude> magnitude = sweep::parse_magnitude(value);
        insert_row(parameter, {number, point.n, value, magnitude ? Value(magnitude->value) : Value()});
      }
    }
  }
}

void write_metrics(SQLite::Database& index, const Collection& all) {
  SQLite::Statement metric(index, "INSERT INTO metric_names VALUES (?, ?, ?)");
  SQLite::Statement cell(index, "INSERT INTO metrics VALUES (?, ?, ?)");
  for (std::size_t m = 0; m < all.metrics.size(); ++m) {
    const auto number = static_cast<std::int64_t>(m);
    const std::optional<bool> larger = sweep::is_larger_better(all.metrics[m]);
    insert_row(metric, {number, all.metrics[m], larger ? Value(*larger ? "more" : "less") : Value()});
    cell.bind(1, number);
    for (std::size_t i = 0; i < all.points.size(); ++i) {
      if (is_absent(all.columns[m][i])) continue;
      cell.bind(2, all.points[i].n);
      bind_value(cell, 3, all.columns[m][i]);
      cell.exec();
      cell.reset();
    }
  }
}

MachineSet group_into_machines(const Collection& all) {
  std::vector<std::vector<Value>> values(all.axes.size(), std::vector<Value>(all.points.size()));
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    for (const auto& [name, value] : all.points[i].axes) {
      values[static_cast<std::size_t>(std::ranges::find(all.axes, name) - all.axes.begin())][i] = value;
    }
  }
  return group_points(all.axes, values);
}

/// Writes the machines of a sweep that lists workloads; nothing for others.
void write_machines(SQLite::Database& index, const Collection& all, const MachineSet& machines) {
  SQLite::Statement workload(index, "INSERT INTO workloads VALUES (?, ?)");
  SQLite::Statement point(index, "INSERT INTO machine_points VALUES (?, ?, ?)");
  for (std::size_t w = 0; w < machines.workloads.size(); ++w) {
    const auto number = static_cast<std::int64_t>(w);
    insert_row(workload, {number, machines.workloads[w]});
    for (std::size_t machine = 0; machine < machines.rows.size(); ++machine) {
      const std::optional<std::size_t> row = machines.rows[machine][w];
      if (row) insert_row(point, {static_cast<std::int64_t>(machine), number, all.points[*row].n});
    }
  }
}

/// Fills all tables of an index except `sweep`.
void write_tables(SQLite::Database& index, const Collection& all, const MachineSet& machines) {
  index.exec("PRAGMA page_size = 8192; PRAGMA foreign_keys = OFF; BEGIN");
  index.exec(kTables);
  write_points(index, all);
  write_axes(index, all, machines);
  write_machines(index, all, machines);
  write_metrics(index, all);
  index.exec(kIndices);
  index.exec("COMMIT");
}

/// Reads the cells of one column of results.csv in the order of the points.
class CellReader {
 public:
  CellReader(const SQLite::Database& index, const char* sql, std::int64_t number) : cells_(index, sql) {
    cells_.bind(1, number);
    has_next_ = cells_.executeStep();
  }
  /// Returns the cell of point `n`. Points must be read in ascending order.
  Value read_value(std::int64_t n) {
    if (!has_next_ || cells_.getColumn(0).getInt64() != n) return {};
    Value value = to_value(cells_.getColumn(1));
    has_next_ = cells_.executeStep();
    return value;
  }

 private:
  SQLite::Statement cells_;
  bool has_next_ = false;
};

/// Returns the name of the base unit of an axis; null if none of its values has a unit.
const char* unit_of_axis(const SQLite::Database& index, std::int64_t axis) {
  using Kind = sweep::Magnitude::Kind;
  SQLite::Statement values(index, "SELECT value FROM parameters WHERE axis = ?");
  values.bind(1, axis);
  while (values.executeStep()) {
    const std::optional<sweep::Magnitude> number = sweep::parse_magnitude(values.getColumn(0).getString());
    if (!number || number->kind == Kind::kNumber) continue;
    return number->kind == Kind::kBytes ? "bytes" : number->kind == Kind::kTime ? "fs" : "hz";
  }
  return nullptr;
}

/// Exports results.csv: one row per point with its axis values (those with a unit also as numbers) and all metrics.
/// Leaves out host data and errors, so that equal sweeps give equal bytes.
std::string export_csv(const SQLite::Database& index) {
  std::vector<std::string> header = {"n", "id", "status"};
  std::vector<CellReader> texts, numbers, metrics;
  std::vector<std::string> number_names;
  SQLite::Statement axis(index, "SELECT axis, name FROM axes ORDER BY axis");
  while (axis.executeStep()) {
    const std::int64_t a = axis.getColumn(0).getInt64();
    header.push_back(axis.getColumn(1).getString());
    texts.emplace_back(index, "SELECT point, value FROM parameters WHERE axis = ? ORDER BY point", a);
    const char* const unit = unit_of_axis(index, a);
    if (unit == nullptr) continue;
    number_names.push_back(fmt::format("{}_{}", header.back(), unit));
    numbers.emplace_back(
        index, "SELECT point, number FROM parameters WHERE axis = ? AND number IS NOT NULL ORDER BY point", a);
  }
  header.insert(header.end(), number_names.begin(), number_names.end());
  SQLite::Statement metric(index, "SELECT metric, path FROM metric_names ORDER BY path");
  while (metric.executeStep()) {
    header.push_back(metric.getColumn(1).getString());
    metrics.emplace_back(index, "SELECT point, value FROM metrics WHERE metric = ? ORDER BY point",
                         metric.getColumn(0).getInt64());
  }
  std::string out = csv_line(header);
  SQLite::Statement point(index, "SELECT n, id, status FROM points ORDER BY n");
  while (point.executeStep()) {
    const std::int64_t n = point.getColumn(0).getInt64();
    out += fmt::format("{},{},{}", n, point.getColumn(1).getString(), point.getColumn(2).getString());
    for (std::vector<CellReader>* columns : {&texts, &numbers, &metrics}) {
      for (CellReader& column : *columns) {
        const Value value = column.read_value(n);
        const bool is_text = std::holds_alternative<std::string>(value);
        out += ',' + (is_text ? csv_cell(exact_text(value)) : exact_text(value));
      }
    }
    out += '\n';
  }
  return out;
}

/// Metrics whose aggregates machines.csv contains.
constexpr std::array kAggregated = {"totals.cycles",
                                    "totals.time_ms",
                                    "totals.perf.fps",
                                    "totals.fps_margin",
                                    "totals.energy_mj.nominal",
                                    "totals.power_w.nominal",
                                    "totals.power_at_fps_w.nominal",
                                    "totals.perf.frames_per_joule_gpu",
                                    "totals.dram_bytes",
                                    "totals.psnr_db",
                                    "totals.worst_psnr_db",
                                    "totals.temporal_psnr_db"};

/// The columns of metrics in machines.csv.
class MachineColumns {
 public:
  MachineColumns(const Collection& all, const MachineSet& machines) : all_(all), machines_(machines) {
    for (std::size_t m = 0; m < all.metrics.size(); ++m) by_path_[all.metrics[m]] = m;
    folded_ = fold_metrics();
  }

  void add_names(std::vector<std::string>& header) const {
    for (const Column& column : folded_) header.push_back(column.name);
    for (const auto& [path, m] : by_path_) {
      if (sweep::is_metric_of_machine(path)) continue;
      for (const std::string& workload : machines_.workloads) {
        header.push_back(sweep::SetMetric{Kind::kOn, path, workload}.text());
      }
    }
  }
  void add_cells(std::size_t machine, std::vector<std::string>& cells) const {
    for (const Column& column : folded_) cells.push_back(exact_text(column.values[machines_.first_row(machine)]));
    for (const auto& [path, m] : by_path_) {
      if (sweep::is_metric_of_machine(path)) continue;
      for (const std::optional<std::size_t>& row : machines_.rows[machine]) {
        cells.push_back(row ? exact_text(all_.columns[m][*row]) : std::string());
      }
    }
  }

 private:
  using Kind = sweep::SetMetric::Kind;

  /// Returns the metrics of the machine alone, then the aggregates of the main metrics over workloads, as columns.
  std::vector<Column> fold_metrics() const {
    std::vector<Column> columns;
    for (const auto& [path, m] : by_path_) {
      if (sweep::is_metric_of_machine(path)) columns.push_back(fold(Kind::kEach, path, all_.columns[m]));
    }
    for (const char* path : kAggregated) {
      if (!by_path_.contains(path)) continue;
      for (const Kind kind : {Kind::kWorst, Kind::kMean, Kind::kGeomean}) {
        columns.push_back(fold(kind, path, means_of(path)));
      }
    }
    return columns;
  }
  Column fold(Kind kind, const std::string& path, std::vector<Value> values) const {
    return fold_column_over_workloads(machines_, {kind, path, {}}, {path, std::move(values)}, false);
  }
  /// Returns the value of a metric at each point; the mean of its replicates if it has some.
  std::vector<Value> means_of(const std::string& path) const {
    std::vector<Value> values = all_.columns[by_path_.at(path)];
    const auto means = by_path_.find(fmt::format("totals.replicates.figures.{}.mean", metric_name(path)));
    if (means == by_path_.end()) return values;
    for (std::size_t row = 0; row < values.size(); ++row) {
      const Value& mean = all_.columns[means->second][row];
      if (!is_absent(mean)) values[row] = mean;
    }
    return values;
  }

  const Collection& all_;
  const MachineSet& machines_;
  std::map<std::string, std::size_t> by_path_;
  std::vector<Column> folded_;
};

/// Exports machines.csv: one row per machine with its axes, the aggregates of the main metrics over its workloads, and
/// every metric on each workload.
std::string export_machines(const SQLite::Database& index, const Collection& all, const MachineSet& machines) {
  std::vector<std::string> header = {"machine", "status", "points"};
  std::vector<std::vector<Value>> axes, numbers;
  std::vector<std::string> number_names;
  for (std::size_t a = 0; a < all.axes.size(); ++a) {
    if (!machines.is_axis(all.axes[a])) continue;
    header.push_back(all.axes[a]);
    const char* const unit = unit_of_axis(index, static_cast<std::int64_t>(a));
    std::vector<Value> texts, values;
    for (const ListedPoint& point : all.points) {
      const auto axis = std::ranges::find(point.axes, all.axes[a], [](const auto& named) { return named.first; });
      texts.push_back(axis == point.axes.end() ? Value() : Value(axis->second));
      const std::optional<sweep::Magnitude> number = magnitude_of(texts.back());
      values.push_back(number ? Value(number->value) : Value());
    }
    axes.push_back(std::move(texts));
    if (unit == nullptr) continue;
    number_names.push_back(fmt::format("{}_{}", all.axes[a], unit));
    numbers.push_back(std::move(values));
  }
  header.insert(header.end(), number_names.begin(), number_names.end());
  const MachineColumns metrics(all, machines);
  metrics.add_names(header);
  std::string out = csv_line(header);
  for (std::size_t machine = 0; machine < machines.rows.size(); ++machine) {
    const std::size_t first = machines.first_row(machine);
    std::string points;
    std::size_t done = 0;
    for (const std::optional<std::size_t>& row : machines.rows[machine]) {
      if (!row) continue;
      done += all.states[*row].status == PointStatus::kDone ? 1 : 0;
      points += fmt::format("{}{}", points.empty() ? "" : " ", all.points[*row].n);
    }
    const bool is_done = done == machines.workloads.size();
    std::vector<std::string> cells = {fmt::format("{}", machine), is_done ? "done" : "incomplete", points};
    for (const auto* values : {&axes, &numbers}) {
      for (const std::vector<Value>& column : *values) cells.push_back(exact_text(column[first]));
    }
    metrics.add_cells(machine, cells);
    out += csv_line(cells);
  }
  return out;
}

/// Returns an in-memory database as the bytes of a database file.
std::string file_bytes(SQLite::Database& index) {
  sqlite3_int64 size = 0;
  const std::unique_ptr<unsigned char, decltype(&sqlite3_free)> image(
      sqlite3_serialize(index.getHandle(), "main", &size, 0), &sqlite3_free);
  if (!image) throw std::bad_alloc();
  return {reinterpret_cast<const char*>(image.get()), static_cast<std::size_t>(size)};
}

/// Returns size, inode and time of a file as text, to detect changes of the file; "-" if there is no file.
std::string file_fingerprint(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return "-";
  return fmt::format("{} {} {}.{:09}", status.st_size, status.st_ino, status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

/// Returns a hash of all inputs of a sweep's index: the points and the files of their results.
std::string input_fingerprint(const std::vector<ListedPoint>& points, const sweep::Store& store) {
  sim::Sha256 all;
  all.add(fmt::format("{}\n{}\n", kIndexSchema, store.root().string()));
  for (const ListedPoint& point : points) {
    all.add(fmt::format("{} {}\n", point.n, point.id));
    for (const auto& [name, value] : point.axes) all.add(fmt::format("{}\n{}\n", name, value));
    const fs::path folder = store.folder_of(point.id);
    all.add(fmt::format("{}, {}, {}, {}\n", file_fingerprint(folder), file_fingerprint(folder / "report.json"),
                        file_fingerprint(folder / "point.json"), file_fingerprint(store.failure_file(point.id))));
  }
  return all.hex_digest();
}

/// Returns the numbers of points by status from a sweep's index. Returns nothing if the inputs (`fingerprint`) or the
/// CSV files have changed since the index was made.
std::optional<Collected> load_if_current(const fs::path& sweep, const std::string& fingerprint) {
  try {
    const std::unique_ptr<SQLite::Database> index = open_index(sweep / "index.sqlite");
    std::map<std::string, std::string> facts = read_facts(*index);
    const bool has_files = facts["csv"] == file_fingerprint(sweep / "results.csv") &&
                           facts["machines_csv"] == file_fingerprint(sweep / "machines.csv");
    if (facts["made_from"] != fingerprint || !has_files) return std::nullopt;
    Collected collected{{}, true};
    SQLite::Statement count(*index, "SELECT status, COUNT(*) FROM points GROUP BY status");
    while (count.executeStep()) {
      collected.counts[parse_status(count.getColumn(0).getString())] =
          static_cast<std::size_t>(count.getColumn(1).getInt64());
    }
    return collected;
  } catch (const sim::InputError&) {
    return std::nullopt;
  } catch (const SQLite::Exception&) {
    return std::nullopt;
  }
}

sim::FileLock wait_for_lock(const fs::path& file) {
  for (;;) {
    if (std::optional<sim::FileLock> lock = sim::FileLock::try_acquire(file)) return std::move(*lock);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace

PointStatus listed_status(const sweep::Store& store, const std::string& id) {
  const PointStatus status = store.status_of(id);
  return status == PointStatus::kMissing && fs::exists(store.failure_file(id)) ? PointStatus::kFailed : status;
}

Collected collect_results(const sweep::SweepFolder& folder) try {
  const fs::path &path = folder.path(), csv = path / "results.csv", machines_csv = path / "machines.csv";
  const sim::FileLock lock = wait_for_lock(path / "collect.lock");
  std::vector<ListedPoint> points = list_points(folder.read_points());
  if (points.empty()) throw sim::InputError(sim::printable((path / "points.jsonl").string()) + ": holds no point");
  const sweep::Store store = folder.store();
  const std::string fingerprint = input_fingerprint(points, store);
  if (const std::optional<Collected> current = load_if_current(path, fingerprint)) return *current;

  Collected collected;
  SQLite::Database index(":memory:", SQLite::OPEN_READWRITE);
  {
    const Collection all = read_all_points(std::move(points), store);
    for (const PointState& state : all.states) ++collected.counts[state.status];
    const MachineSet machines = group_into_machines(all);
    write_tables(index, all, machines);
    if (machines.is_set()) sim::write_file_atomically(machines_csv, export_machines(index, all, machines));
  }
  sim::write_file_atomically(csv, export_csv(index));
  SQLite::Statement fact(index, "INSERT INTO sweep VALUES (?, ?)");
  insert_row(fact, {"store", store.root().string()});
  insert_row(fact, {"made_from", fingerprint});
  insert_row(fact, {"csv", file_fingerprint(csv)});
  insert_row(fact, {"machines_csv", file_fingerprint(machines_csv)});
  sim::write_file_atomically(path / "index.sqlite", file_bytes(index));
  return collected;
} catch (const SQLite::Exception& error) {
  if (error.getErrorCode() == SQLITE_NOMEM) throw std::bad_alloc();
  throw;
}

void collect_if_writable(const fs::path& sweep, std::string_view consequence) {
  try {
    collect_results(sweep::SweepFolder::open(sweep));
  } catch (const sim::IoError& error) {
    std::error_code failed;
    if (!fs::exists(sweep / "index.sqlite", failed)) throw;
    print_message("warning: {}; {}", error.what(), consequence);
  }
}

std::string summary_text(const Collected& collected) {
  std::size_t points = 0;
  for (const auto& [status, count] : collected.counts) points += count;
  const auto found = collected.counts.find(PointStatus::kDone);
  std::string text = fmt::format("{} points: {} done", points, found == collected.counts.end() ? 0 : found->second);
  for (const PointStatus status : {PointStatus::kFailed, PointStatus::kDamaged, PointStatus::kMissing}) {
    const auto some = collected.counts.find(status);
    if (some != collected.counts.end()) text += fmt::format(", {} {}", some->second, name_of(status));
  }
  return text;
}

}  // namespace tools::results
