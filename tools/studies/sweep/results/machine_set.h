#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/spec/set_metric.h"

namespace tools::results {

/// The machines of a sweep. A machine is the set of points that differ only in their workload.
struct MachineSet {
  std::vector<std::string> workloads;  ///< names in the order of the points; empty if the sweep lists no workloads
  std::vector<std::string> axes;  ///< axes that distinguish machines: all except those that the workload determines
  std::vector<std::vector<std::optional<std::size_t>>> rows;  ///< by machine and workload: row of the point, if any
  std::vector<std::size_t> machine_of;                        ///< machine of each row

  /// True if machines are evaluated on more than one workload.
  bool is_set() const { return workloads.size() > 1; }
  bool is_axis(std::string_view name) const;
  /// Returns the row of a machine's first point. This row represents the machine in columns and selections.
  std::size_t first_row(std::size_t machine) const;
  /// Returns, in ascending order, the rows of all points of the machines to which the rows `of` belong.
  std::vector<std::size_t> points_of(const std::vector<std::size_t>& of) const;
  /// Returns a selection of machines by their first rows: those with `met` true for all their points.
  std::vector<bool> machines_with_all_points(const std::vector<bool>& met) const;
};

/// Groups the points of a sweep into machines. `values`: axis values, by axis, then by point.
MachineSet group_points(std::span<const std::string> axes, const std::vector<std::vector<Value>>& values);

/// The function over workloads from which a column was computed, and its input.
struct Fold {
  sweep::SetMetric metric;
  Column points;  ///< the metric of each point
  bool larger_is_better = false;
};

/// Evaluates a metric over the workloads of each machine. Each point gets the value of its machine; none if a needed
/// point has no value. `larger_in_goal`: whether the goal that contains the metric prefers larger values; `worst` needs
/// it unless the metric has a known direction. Throws InputError for unknown workloads.
Column fold_column_over_workloads(const MachineSet& machines, sweep::SetMetric metric, Column points,
                                  std::optional<bool> larger_in_goal);
/// Evaluates the same function over workloads as `fold`, but on other values of the points.
Column fold_other_values(const MachineSet& machines, const Fold& fold, Column points);

/// Returns the report path of a column's metric, without the function over workloads.
const std::string& report_path(const Column& column);

/// The rows that a command ranks: points, or machines, each represented by the row of its first point.
struct RankedRows {
  bool by_machine = false;
  std::vector<bool> selected;

  const char* noun() const { return by_machine ? "machine" : "point"; }
  /// Returns the rows of all points of the ranked points or machines `rows`.
  std::vector<std::size_t> points_of(const Results& results, const std::vector<std::size_t>& rows) const;
  /// Returns the number of a row's machine if machines are ranked, otherwise of its point.
  std::int64_t number_of(const Results& results, std::size_t row) const;
  /// Returns the axes with more than one value, without the workload if machines are ranked.
  std::vector<Column> varying_axes(const Results& results) const;
  /// Returns a column with number_of() each row.
  Column numbers(const Results& results) const;
};
/// Selects the points or machines that can be ranked by the metrics of `columns`, among the points that meet `where`.
/// 1. If the sweep has a set of workloads, machines are ranked. A machine meets a condition if all its points do.
/// 2. If a condition compares the workload, the selected points are ranked instead. Throws InputError for such a
///    condition together with a function over workloads, and for a metric that differs between the workloads to rank.
RankedRows select_ranked(const Results& results, std::span<const Column* const> columns,
                         const std::vector<std::string>& where);
/// Returns the selected points as rows to rank, or their machines if the column is a function over workloads.
RankedRows rows_to_rank(const Results& results, const Column& column, const std::vector<bool>& points);

/// Returns a column with the status of each row's machine: "done", or if workloads have no result, "1 of 3 done".
Column machine_status(const Results& results);

}  // namespace tools::results
