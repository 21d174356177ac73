#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/studies/sweep/spec/condition.h"
#include "tools/studies/sweep/spec/point.h"

namespace SQLite {
class Column;
class Database;
}  // namespace SQLite

namespace tools::results {

using sweep::exact_text;
using sweep::is_absent;
using sweep::magnitude_of;
using sweep::PointStatus;
using sweep::sorts_before;
using sweep::Value;

/// Numbers of a sweep's points by status.
using StatusCounts = std::map<PointStatus, std::size_t>;
/// Returns "2 of 200 points have no result: 1 failed, 1 missing"; empty if all points have one.
std::string missing_text(const StatusCounts& counts);

/// Version of the tables of index.sqlite. An index of another version is rebuilt.
inline constexpr int kIndexSchema = 2;
/// Opens index.sqlite for reading, without locks: the file is only ever replaced as a whole. Throws InputError if it is
/// missing, damaged or of another version.
std::unique_ptr<SQLite::Database> open_index(const std::filesystem::path& file);
/// Reads the table `sweep` of an index, which has the folder of the store and the hash of the inputs.
std::map<std::string, std::string> read_facts(const SQLite::Database& index);
Value to_value(const SQLite::Column& column);
PointStatus parse_status(std::string_view name);

/// A point of a sweep, as stored in the index.
struct Row {
  std::int64_t n = 0;
  std::string id;
  PointStatus status = PointStatus::kMissing;
  bool is_done() const { return sweep::is_done(status); }
};

struct Fold;
struct MachineSet;

/// A column of the results: one value for each point, in the order of the points.
struct Column {
  std::string name;  ///< report path, name of an axis, or function over workloads, such as worst(fps)
  std::vector<Value> values;
  std::shared_ptr<const Fold> fold{};  ///< function over workloads that computed the column; null otherwise
};

/// The results of a sweep, read from its index. All members throw InputError if the index is damaged.
class Results {
 public:
  explicit Results(const std::filesystem::path& sweep);
  ~Results();
  Results(const Results&) = delete;
  Results& operator=(const Results&) = delete;

  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<std::string>& axes() const { return axes_; }
  /// Returns the folder of a point in the store.
  std::filesystem::path folder_of(const Row& row) const;

  /// Reads a column. `text`: "n", "id", "status", "error", an axis, a path of report.json or an unambiguous end of one,
  /// or a function over workloads. Paths outside `totals` are read from the reports, which takes longer. A function
  /// over workloads, such as worst(fps), gives each point the value of its machine. Throws InputError with similar
  /// names for other text. `larger_in_goal`: as in fold_column_over_workloads().
  Column column(std::string_view text, std::optional<bool> larger_in_goal = {}) const;
  bool has_metric(std::string_view path) const;
  /// Returns the machines of the sweep. If the sweep lists no workloads, each point is a machine.
  const MachineSet& machines() const { return *machines_; }
  /// Returns a column for each axis with more than one value.
  std::vector<Column> varying_axes() const;
  /// Returns a line with the number of points without a result, by status; empty if there is none.
  std::string missing_text() const;

 private:
  /// Reads a column with an SQL query whose rows are pairs of point and value. `number`: parameter of the query.
  Column query_column(const std::string& name, const std::string& sql, std::int64_t number) const;
  Column read_from_reports(std::string_view text) const;
  Column column_of_points(std::string_view text) const;
  MachineSet read_machines() const;

  const std::filesystem::path file_;
  std::filesystem::path store_;
  std::unique_ptr<SQLite::Database> index_;
  std::vector<Row> rows_;
  std::vector<std::string> axes_, metrics_;
  std::unique_ptr<const MachineSet> machines_;
};

/// Reads the column of a metric. A point with replicates has their mean. Throws InputError as Results::column().
Column column_of_means(const Results& results, const std::string& path, std::optional<bool> larger_in_goal = {});

/// Returns for each point whether it meets all conditions ("power_w.nominal<1 and cores>=2"). Replicates are compared
/// by their mean. A point that lacks a compared value does not meet the condition. A function over workloads has the
/// same value for all points of a machine. Throws InputError for unknown paths and values that cannot be compared.
std::vector<bool> rows_meeting(const Results& results, const std::vector<std::string>& conditions);
/// Lists the paths that conditions compare, each once.
std::vector<std::string> compared_paths(const std::vector<std::string>& conditions);

/// Returns a cell of a CSV file, quoted if it contains a comma, a quote or a line end (RFC 4180). A text that begins
/// with =, +, -, @, tab or carriage return and is no number gets a leading apostrophe, so that no spreadsheet runs it.
std::string csv_cell(std::string_view text);
/// Returns the cells as a line of a CSV file, including the line end.
std::string csv_line(const std::vector<std::string>& cells);

/// Returns the cells of a column for display: numbers with at most four digits and a common metric prefix, whole
/// numbers in full, "-" for absent values.
std::vector<std::string> shown_cells(const std::vector<Value>& values);
/// Returns the cells of some rows of a column for display. Whole numbers of a metric have at most four digits, too.
std::vector<std::string> shown_cells(const Column& column, const std::vector<std::size_t>& rows);
/// Returns the name of the column for display.
std::string shown_name(const Column& column);
/// Returns a number as text with at most four digits; whole numbers below 10,000 stay whole.
std::string number_text(double number);

struct TableOptions {
  std::vector<std::string> columns;  ///< empty: the axes that vary and the main metrics
  std::string sort;                  ///< "column" or "column:desc"; empty: order of the points
  std::vector<std::string> where;    ///< conditions; all must hold
  std::optional<std::size_t> limit;  ///< maximum number of rows
  bool csv = false;                  ///< CSV with all digits
  bool machines = false;             ///< a row per machine, even if no column is a function over workloads
};
/// Returns a table of the points of a sweep; of its machines if a column is a function over workloads.
std::string results_table(const Results& results, const TableOptions& options);

/// Returns the given rows of the columns as a table or as CSV, with the headers `names`.
std::string table_text(const std::vector<std::string>& names, const std::vector<Column>& columns,
                       const std::vector<std::size_t>& rows, bool csv);

}  // namespace tools::results
