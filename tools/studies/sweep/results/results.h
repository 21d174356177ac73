#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tools/studies/sweep/results/index/index_file.h"

namespace tools::results {

/// A point as the index knows it.
struct Row {
  std::int64_t n = 0;
  std::string id, status;
  bool is_done() const { return status == "done"; }
};

/// A value of every point, in their order.
struct Column {
  std::string name;  ///< in full
  std::vector<Value> values;
};

/// The results of a sweep, read from its index.
class Results {
 public:
  /// InputError if there is no index.
  explicit Results(const std::filesystem::path& sweep);

  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<std::string>& axes() const { return axes_; }
  std::filesystem::path folder_of(const Row& row) const;

  /// "n", "id", "status" or "error"; an axis; or a path of report.json. Any end of a path at a dot means it if it is
  /// the only one. What is neither an axis nor in `totals` is looked for in the reports themselves, which takes longer.
  /// InputError with the candidates, or the nearest.
  Column column(std::string_view text) const;
  bool has_metric(std::string_view path) const;

  /// Axes with more than one value.
  std::vector<Column> varying() const;

  /// "2 of 200 points have no result: 1 failed, 1 missing", or nothing.
  std::string what_is_missing() const;

 private:
  Column of_metric(std::size_t number, const std::string& path) const;
  Column of_axis(std::size_t number, const std::string& name) const;
  Column of_errors() const;
  Column of_reports(std::string_view text) const;
  std::size_t place_of(std::int64_t n) const;

  std::filesystem::path store_;
  mutable Database index_;
  std::vector<Row> rows_;
  std::vector<std::string> axes_, metrics_;
};

}  // namespace tools::results
