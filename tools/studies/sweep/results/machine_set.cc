#include "tools/studies/sweep/results/machine_set.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_file.h"

namespace tools::results {
namespace {

/// Axes that a workload may determine.
constexpr std::array<std::string_view, 4> kWorkloadTexts = {"scene", "camera", "frames", "resolution"};

/// True if points with equal values of `axis` have equal values of `other`.
bool determines(const std::vector<Value>& axis, const std::vector<Value>& other) {
  std::map<std::string, const Value*> found;
  for (std::size_t row = 0; row < axis.size(); ++row) {
    const Value& value = *found.try_emplace(exact_text(axis[row]), &other[row]).first->second;
    if (value != other[row]) return false;
  }
  return true;
}

/// Returns the values of a metric on all workloads of a machine, or for kOn on one.
std::vector<const Value*> values_of(const MachineSet& machines, const Fold& fold, std::size_t machine) {
  std::vector<const Value*> values;
  for (std::size_t w = 0; w < machines.rows[machine].size(); ++w) {
    const bool is_named = fold.metric.kind == sweep::SetMetric::Kind::kOn;
    if (is_named && machines.workloads[w] != fold.metric.workload) continue;
    const std::optional<std::size_t> row = machines.rows[machine][w];
    values.push_back(row ? &fold.points.values[*row] : nullptr);
  }
  return values;
}

Value fold_values(const Fold& fold, const std::vector<const Value*>& values) {
  if (fold.metric.kind == sweep::SetMetric::Kind::kOn) {
    return values.empty() || values.front() == nullptr ? Value() : *values.front();
  }
  std::vector<double> numbers;
  for (const Value* value : values) {
    const auto number = value == nullptr ? std::nullopt : magnitude_of(*value);
    if (!number) return {};
    numbers.push_back(number->value);
  }
  const std::optional<double> folded = sweep::fold_workloads(fold.metric.kind, numbers, fold.larger_is_better);
  return folded ? Value(*folded) : Value();
}

}  // namespace

bool MachineSet::is_axis(std::string_view name) const { return std::ranges::find(axes, name) != axes.end(); }

std::size_t MachineSet::first_row(std::size_t machine) const {
  const auto has_row = [](const std::optional<std::size_t>& row) { return row.has_value(); };
  return **std::ranges::find_if(rows[machine], has_row);
}

std::vector<std::size_t> MachineSet::points_of(const std::vector<std::size_t>& of) const {
  std::set<std::size_t> all;
  for (const std::size_t row : of) {
    for (const std::optional<std::size_t>& point : rows[machine_of[row]]) {
      if (point) all.insert(*point);
    }
  }
  return {all.begin(), all.end()};
}

std::vector<bool> MachineSet::machines_with_all_points(const std::vector<bool>& met) const {
  std::vector<bool> out(met.size());
  for (std::size_t machine = 0; machine < rows.size(); ++machine) {
    out[first_row(machine)] = std::ranges::all_of(rows[machine], [&](const auto& row) { return !row || met[*row]; });
  }
  return out;
}

MachineSet group_points(std::span<const std::string> axes, const std::vector<std::vector<Value>>& values) {
  MachineSet set;
  const auto workload = static_cast<std::size_t>(std::ranges::find(axes, sweep::kWorkloadAxis) - axes.begin());
  const bool has_workloads = workload < axes.size();
  std::vector<std::size_t> identity;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const bool is_text = std::ranges::find(kWorkloadTexts, axes[a]) != kWorkloadTexts.end();
    if (has_workloads && (a == workload || (is_text && determines(values[workload], values[a])))) continue;
    identity.push_back(a);
    set.axes.push_back(axes[a]);
  }
  const std::size_t points = values.empty() ? 0 : values.front().size();
  std::map<std::vector<std::string>, std::size_t> machines;
  for (std::size_t row = 0; row < points; ++row) {
    std::size_t column = 0;
    if (has_workloads) {
      const std::string name = exact_text(values[workload][row]);
      column = static_cast<std::size_t>(std::ranges::find(set.workloads, name) - set.workloads.begin());
      if (column == set.workloads.size()) set.workloads.push_back(name);
    }
    std::size_t machine = set.rows.size();
    if (has_workloads) {
      std::vector<std::string> key;
      for (const std::size_t a : identity) key.push_back(exact_text(values[a][row]));
      machine = machines.try_emplace(std::move(key), machine).first->second;
    }
    if (machine == set.rows.size()) set.rows.emplace_back();
    std::vector<std::optional<std::size_t>>& of = set.rows[machine];
    if (of.size() <= column) of.resize(column + 1);
    of[column] = row;
    set.machine_of.push_back(machine);
  }
  for (auto& of : set.rows) of.resize(std::max<std::size_t>(1, set.workloads.size()));
  return set;
}

Column fold_other_values(const MachineSet& machines, const Fold& fold, Column points) {
  auto again = std::make_shared<Fold>(fold.metric, std::move(points), fold.larger_is_better);
  sweep::SetMetric shown = fold.metric;
  shown.path = fold.points.name;
  Column column{shown.text(), std::vector<Value>(machines.machine_of.size()), nullptr};
  for (std::size_t machine = 0; machine < machines.rows.size(); ++machine) {
    const Value value = fold_values(*again, values_of(machines, *again, machine));
    for (const std::optional<std::size_t>& row : machines.rows[machine]) {
      if (row) column.values[*row] = value;
    }
  }
  column.fold = std::move(again);
  return column;
}

Column fold_column_over_workloads(const MachineSet& machines, sweep::SetMetric metric, Column points,
                                  std::optional<bool> larger_in_goal) {
  sweep::check_workload(metric, machines.workloads);
  const std::optional<bool> known = sweep::is_larger_better(points.name);
  if (metric.kind == sweep::SetMetric::Kind::kWorst && !known && !larger_in_goal) {
    throw sim::InputError(
        fmt::format("'{}': it is not known whether more or less of {} is better; allowed: mean({}), on(WORKLOAD, {})",
                    sim::printable(metric.text()), shown_name(points), metric.path, metric.path));
  }
  const bool larger = known.value_or(larger_in_goal.value_or(false));
  return fold_other_values(machines, {std::move(metric), points, larger}, points);
}

const std::string& report_path(const Column& column) { return column.fold ? column.fold->points.name : column.name; }

std::vector<std::size_t> RankedRows::points_of(const Results& results, const std::vector<std::size_t>& rows) const {
  return by_machine ? results.machines().points_of(rows) : rows;
}

std::int64_t RankedRows::number_of(const Results& results, std::size_t row) const {
  return by_machine ? static_cast<std::int64_t>(results.machines().machine_of[row]) : results.rows()[row].n;
}

std::vector<Column> RankedRows::varying_axes(const Results& results) const {
  std::vector<Column> columns = results.varying_axes();
  if (by_machine) {
    std::erase_if(columns, [&](const Column& column) { return !results.machines().is_axis(column.name); });
  }
  return columns;
}

Column RankedRows::numbers(const Results& results) const {
  Column column{by_machine ? "machine" : "n", {}};
  for (std::size_t row = 0; row < results.rows().size(); ++row) column.values.emplace_back(number_of(results, row));
  return column;
}

RankedRows select_ranked(const Results& results, std::span<const Column* const> columns,
                         const std::vector<std::string>& where) {
  const MachineSet& machines = results.machines();
  RankedRows out{false, rows_meeting(results, where)};
  if (!machines.is_set()) return out;
  const auto is_of_workload = [&](const std::string& path) {
    return std::ranges::find(results.axes(), path) != results.axes().end() && !machines.is_axis(path);
  };
  std::vector<std::string> workloads = machines.workloads;
  const std::vector<std::string> compared = compared_paths(where);
  const auto selecting = std::ranges::find_if(compared, is_of_workload);
  if (selecting != compared.end()) {
    for (const Column* column : columns) {
      if (!column->fold) continue;
      throw sim::InputError(
          fmt::format("'{}' is evaluated on all workloads, so --where may not select by {}; allowed: on(NAME, {}) with "
                      "NAME one of {}",
                      shown_name(*column), sim::printable(*selecting), metric_name(report_path(*column)),
                      sweep::list_workloads(workloads)));
    }
    std::set<std::string> left;
    const Column names = results.column(sweep::kWorkloadAxis);
    for (std::size_t row = 0; row < out.selected.size(); ++row) {
      if (out.selected[row]) left.insert(exact_text(names.values[row]));
    }
    std::erase_if(workloads, [&](const std::string& name) { return !left.contains(name); });
  } else {
    out.by_machine = true;
    out.selected = machines.machines_with_all_points(out.selected);
  }
  for (const Column* column : columns) {
    if (column->fold || machines.is_axis(column->name)) continue;
    const sweep::SetMetric each{sweep::SetMetric::Kind::kEach, metric_name(column->name), {}};
    sweep::check_ranks_machines(each, column->name, workloads);
  }
  return out;
}

RankedRows rows_to_rank(const Results& results, const Column& column, const std::vector<bool>& points) {
  if (!column.fold || !results.machines().is_set()) return {false, points};
  return {true, results.machines().machines_with_all_points(points)};
}

Column machine_status(const Results& results) {
  const MachineSet& machines = results.machines();
  Column column{"status", std::vector<Value>(results.rows().size())};
  for (const auto& rows : machines.rows) {
    const auto is_done = [&](const auto& row) { return row && results.rows()[*row].is_done(); };
    const auto done = static_cast<std::size_t>(std::ranges::count_if(rows, is_done));
    const std::string text = done == rows.size() ? "done" : fmt::format("{} of {} done", done, rows.size());
    for (const auto& row : rows) {
      if (row) column.values[*row] = text;
    }
  }
  return column;
}

}  // namespace tools::results
