#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/noise/noise.h"

namespace tools::sweep {

/// Name of the axis that the key `workloads` of a sweep's file makes. A machine is evaluated on all its values.
inline constexpr std::string_view kWorkloadAxis = "workload";

/// A metric of a machine over a set of workloads: "fps", "worst(fps)", "mean(fps)", "geomean(fps)", "on(chess, fps)".
struct SetMetric {
  enum class Kind : std::uint8_t {
    kEach,     ///< the metric of each workload by itself: a path without a function
    kWorst,    ///< the value of the workload on which the machine is worst
    kMean,     ///< arithmetic mean of the workloads
    kGeomean,  ///< geometric mean of the workloads
    kOn        ///< the value of one workload
  };
  Kind kind = Kind::kEach;
  std::string path;      ///< report path, or an unambiguous end of one
  std::string workload;  ///< name of the workload of kOn

  /// Returns the expression as it is typed.
  std::string text() const;
  bool operator==(const SetMetric&) const = default;
};

/// Parses an expression. Throws InputError for anything else, with the forms that are allowed.
SetMetric parse_set_metric(std::string_view text);
/// Throws InputError if the metric names a workload that is not among `workloads`.
void check_workload(const SetMetric& metric, std::span<const std::string> workloads);
/// Throws InputError if the metric has one value per workload, so that machines cannot be ranked by it. Metrics of the
/// machine alone, such as the area, and sets of one workload are allowed. `path`: full path of the metric.
void check_ranks_machines(const SetMetric& metric, std::string_view path, std::span<const std::string> workloads);

/// True if a metric is better when it is larger, false if it is better when smaller, nothing if neither is known.
/// `path`: full path in a report, "totals.perf.fps".
std::optional<bool> is_larger_better(std::string_view path);
/// True if a metric of a report has the same value on every workload, because it depends on the machine alone.
bool is_metric_of_machine(std::string_view path);
/// Returns whether larger values are better where the metric is evaluated.
/// 1. kEach has the direction of the goal or constraint that it is written in, so that worst is what the goal rules
///    out.
/// 2. Others have the direction of the metric if it is known, else of the goal.
bool is_larger_better_in(const SetMetric& metric, std::string_view path, bool larger_in_goal);

/// A metric of one workload; nothing if the workload has no result.
struct WorkloadValue {
  std::string workload;
  std::optional<MeasuredFigure> seen;
};

/// Evaluates a metric over all workloads of a machine, with its noise. kEach is evaluated like kWorst. Returns nothing
/// if a workload that the metric needs has no value, or for the geometric mean of values that are not above 0.
/// 1. Errors of workloads are independent: mean and geomean add their variances, with Welch-Satterthwaite degrees of
///    freedom.
/// 2. worst takes the largest error of the workloads that noise does not separate from the worst one. The variance
///    grows by the factor 1 + ln k for k such workloads, because the smallest of k equal values is low by chance.
std::optional<MeasuredFigure> evaluate_set_metric(const SetMetric& metric, std::span<const WorkloadValue> values,
                                                  bool larger_is_better);
/// Evaluates a function over the values of all workloads, without noise; nothing if it has no value.
std::optional<double> fold_workloads(SetMetric::Kind kind, std::span<const double> values, bool larger_is_better);

/// Returns the names of workloads for an error message.
std::string list_workloads(std::span<const std::string> workloads);

}  // namespace tools::sweep
