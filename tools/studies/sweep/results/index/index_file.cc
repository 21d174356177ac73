#include "tools/studies/sweep/results/index/index_file.h"

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"

namespace tools::results {
namespace {

// Values of metrics and axes lie column by column: queries ask for few columns of all points.
constexpr const char* kTables = R"(
PRAGMA user_version = 1;
CREATE TABLE sweep (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE points (
  n INTEGER PRIMARY KEY,
  id TEXT NOT NULL,
  status TEXT NOT NULL CHECK (status IN ('done', 'failed', 'missing', 'damaged')));
CREATE TABLE axes (axis INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE);
CREATE TABLE parameters (
  axis INTEGER NOT NULL REFERENCES axes, point INTEGER NOT NULL REFERENCES points,
  value TEXT NOT NULL,
  number REAL, -- in bytes, hertz, femtoseconds, or as it stands
  PRIMARY KEY (axis, point)) WITHOUT ROWID;
CREATE TABLE metric_names (metric INTEGER PRIMARY KEY, path TEXT NOT NULL UNIQUE);
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
)";

constexpr const char* kIndices = R"(
CREATE INDEX points_by_id ON points (id);
CREATE INDEX points_by_status ON points (status);
)";

void write_points(Database& index, const Collection& all) {
  Statement point = index.prepare("INSERT INTO points VALUES (?, ?, ?)");
  Statement error = index.prepare("INSERT INTO errors VALUES (?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    const ListedPoint& p = all.points[i];
    const PointState& state = all.states[i];
    point.bind(1, p.n).bind(2, p.id).bind(3, name_of(state.status)).run();
    if (state.status != Status::kFailed && state.status != Status::kDamaged) continue;
    const PointError& e = state.error;
    error.bind(1, p.n).bind(2, e.text).bind(3, e.exit).bind(4, e.host).bind(5, e.attempt).bind(6, e.log).run();
  }
}

void write_axes(Database& index, const Collection& all) {
  Statement axis = index.prepare("INSERT INTO axes VALUES (?, ?)");
  Statement parameter = index.prepare("INSERT INTO parameters VALUES (?, ?, ?, ?)");
  for (std::size_t a = 0; a < all.axes.size(); ++a) {
    const auto number = static_cast<std::int64_t>(a);
    axis.bind(1, number).bind(2, all.axes[a]).run();
    for (const ListedPoint& point : all.points) {
      for (const auto& [name, value] : point.axes) {
        if (name != all.axes[a]) continue;
        Value amount;
        if (const std::optional<sweep::Magnitude> magnitude = sweep::magnitude_of(value)) amount = magnitude->value;
        parameter.bind(1, number).bind(2, point.n).bind(3, value).bind(4, amount).run();
      }
    }
  }
}

void write_metrics(Database& index, const Collection& all) {
  Statement metric = index.prepare("INSERT INTO metric_names VALUES (?, ?)");
  Statement cell = index.prepare("INSERT INTO metrics VALUES (?, ?, ?)");
  for (std::size_t m = 0; m < all.metrics.size(); ++m) {
    const auto number = static_cast<std::int64_t>(m);
    metric.bind(1, number).bind(2, all.metrics[m]).run();
    cell.bind(1, number);
    for (std::size_t i = 0; i < all.points.size(); ++i) {
      const Value& value = all.columns[m][i];
      if (!is_absent(value)) cell.bind(2, all.points[i].n).bind(3, value).run();
    }
  }
}

template <class Values>
void bind_from(Statement& statement, int parameter, const Values& values) {
  for (const Value& value : values) statement.bind(parameter++, value);
  statement.run();
}

void write_frames_and_hosts(Database& index, const Collection& all) {
  Statement frame = index.prepare("INSERT INTO frames VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  Statement host = index.prepare("INSERT INTO host VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (all.states[i].status != Status::kDone) continue;
    const ReportScan& report = all.states[i].report;
    for (std::size_t f = 0; f < report.frames.size(); ++f) {
      bind_from(frame.bind(1, all.points[i].n).bind(2, static_cast<std::int64_t>(f)), 3, report.frames[f]);
    }
    bind_from(host.bind(1, all.points[i].n), 2, report.host);
  }
}

}  // namespace

std::string index_bytes(const Collection& all, const SweepFacts& facts) {
  Database index;
  index.run("PRAGMA foreign_keys = OFF; BEGIN");
  index.run(kTables);
  Statement fact = index.prepare("INSERT INTO sweep VALUES (?, ?)");
  for (const auto& [key, value] : facts) fact.bind(1, key).bind(2, value).run();
  write_points(index, all);
  write_axes(index, all);
  write_metrics(index, all);
  write_frames_and_hosts(index, all);
  index.run(kIndices);
  index.run("COMMIT");
  return index.bytes();
}

Database open_index(const std::filesystem::path& file) {
  const std::string shown = sim::printable(file.string());
  std::error_code failed;
  if (!std::filesystem::exists(file, failed)) {
    throw sim::InputError(fmt::format("{}: no such file; 'raywatt sweep collect {}' makes it", shown,
                                      sim::printable(file.parent_path().string())));
  }
  try {
    Database index(file);
    Statement version = index.prepare("PRAGMA user_version");
    if (version.step() && version.number(0) == kIndexSchema) return index;
  } catch (const SqliteError&) {  // said below
  }
  throw sim::InputError(fmt::format("{}: is damaged or of another version; 'raywatt sweep collect {}' makes it anew",
                                    shown, sim::printable(file.parent_path().string())));
}

SweepFacts read_facts(Database& index) {
  SweepFacts facts;
  Statement statement = index.prepare("SELECT key, value FROM sweep");
  while (statement.step()) facts[statement.text(0)] = statement.text(1);
  return facts;
}

}  // namespace tools::results
