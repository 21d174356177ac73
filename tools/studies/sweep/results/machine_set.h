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
  std::vector<std::string> axes;       ///< axes that tell machines apart: all but those that the workload determines
  std::vector<std::vector<std::optional<std::size_t>>> rows;  ///< by machine and workload; nothing for a point left out
  std::vector<std::size_t> machine_of;                        ///< by row

  /// True if machines are evaluated on more than one workload.
  bool is_set() const { return workloads.size() > 1; }
  bool is_axis(std::string_view name) const;
  /// Returns the row of the first point of a machine. Columns and selections of machines use this row.
  std::size_t first_row(std::size_t machine) const;
  /// Returns the rows of all points of the machines of `of`, in order.
  std::vector<std::size_t> points_of(const std::vector<std::size_t>& of) const;
  /// Selects the first row of each machine whose points are all among `met`.
  std::vector<bool> with_all_points(const std::vector<bool>& met) const;
};

/// Groups points into machines. `values`: by axis, then by point.
MachineSet group_points(std::span<const std::string> axes, const std::vector<std::vector<Value>>& values);

/// Metric of a machine over a set of workloads, as the origin of a column.
struct Fold {
  sweep::SetMetric metric;
  Column points;  ///< the metric of each point
  bool larger_is_better = false;
};

/// Evaluates a metric over the workloads of each machine. Every point of a machine has the machine's value; it is
/// absent if a point that the metric needs has none. Throws InputError for unknown workloads. `larger_in_goal`:
/// direction of the goal that the metric is written in; worst needs it or a known direction.
Column fold_column(const MachineSet& machines, sweep::SetMetric metric, Column points,
                   std::optional<bool> larger_in_goal);
/// Evaluates the metric of a column again, over other values of the points.
Column refold(const MachineSet& machines, const Fold& fold, Column points);

/// Path in the report of the metric of a column, without the function over workloads.
const std::string& report_path(const Column& column);

/// The rows that a verb ranks: points, or machines in the rows of their first points.
struct RankedRows {
  bool by_machine = false;
  std::vector<bool> selected;

  const char* noun() const { return by_machine ? "machine" : "point"; }
  /// Rows of all points of these rows.
  std::vector<std::size_t> points_of(const Results& results, const std::vector<std::size_t>& rows) const;
  /// Number of a row: of the machine, or of the point.
  std::int64_t number_of(const Results& results, std::size_t row) const;
  /// Axes with several values, without the workload if machines are ranked.
  std::vector<Column> varying_axes(const Results& results) const;
  /// Column of number_of().
  Column numbers(const Results& results) const;
};
/// Selects what the metrics of `columns` can rank, among the points that meet `where`.
/// 1. Over a set of workloads machines are ranked; a condition holds if it holds for every point of the machine.
/// 2. A condition on the workload itself selects points of one workload. Throws InputError for a metric with a value
///    per workload, and for a function together with a condition on workloads.
RankedRows select_ranked(const Results& results, std::span<const Column* const> columns,
                         const std::vector<std::string>& where);
/// Rows of points, or of machines if the column is a metric over a set of workloads.
RankedRows rows_to_rank(const Results& results, const Column& column, const std::vector<bool>& points);

/// Returns "done" for machines with a result on every workload, otherwise "1 of 3 done", by row.
Column machine_status(const Results& results);

}  // namespace tools::results
