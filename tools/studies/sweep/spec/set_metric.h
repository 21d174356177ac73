#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/noise/noise.h"

namespace tools::sweep {

/// Name of the axis that the key `workloads` of a sweep's file defines. A machine is evaluated on all of its values.
inline constexpr std::string_view kWorkloadAxis = "workload";

/// A metric of a machine over a set of workloads: "fps", "worst(fps)", "mean(fps)", "geomean(fps)", "on(chess, fps)".
struct SetMetric {
  enum class Kind : std::uint8_t {
    kEach,     ///< each workload has its own value: a path without a function
    kWorst,    ///< the value of the workload on which the machine is worst
    kMean,     ///< arithmetic mean of the workloads
    kGeomean,  ///< geometric mean of the workloads
    kOn        ///< the value of one workload
  };
  Kind kind = Kind::kEach;
  std::string path;      ///< report path, or an unambiguous end of one
  std::string workload;  ///< name of the workload of kOn

  /// Returns the metric as an expression that parse_set_metric() accepts.
  std::string text() const;
  bool operator==(const SetMetric&) const = default;
};

/// Parses a metric over workloads, such as "worst(fps)". Throws InputError with the allowed forms for other text.
SetMetric parse_set_metric(std::string_view text);
/// Throws InputError if the metric names a workload that is not among `workloads`.
void check_workload(const SetMetric& metric, std::span<const std::string> workloads);
/// Throws InputError if the metric has a value per workload, so that machines cannot be ranked by it. Allowed are
/// metrics of the machine alone, such as the area, and a single workload. `path`: full path of the metric.
void check_ranks_machines(const SetMetric& metric, std::string_view path, std::span<const std::string> workloads);

/// Returns true if larger values of a metric are better, false if smaller values are better, nothing if unknown.
/// `path`: full path in a report, "totals.perf.fps".
std::optional<bool> is_larger_better(std::string_view path);
/// True if a report's metric has the same value on every workload, because it depends on the machine alone.
bool is_metric_of_machine(std::string_view path);
/// Returns whether larger values of a metric are better within a goal (objective or constraint).
/// 1. kEach has the direction of the goal, so that the worst workload is the one that may violate it.
/// 2. Other kinds have the direction of the metric if it is known, else of the goal.
bool is_larger_better_in(const SetMetric& metric, std::string_view path, bool larger_in_goal);

/// The value of a metric on one workload; nothing if the workload has no result.
struct WorkloadValue {
  std::string workload;
  std::optional<MeasuredMetric> seen;
};

/// Evaluates a metric over all workloads of a machine, with its noise. kEach is evaluated like kWorst. Returns nothing
/// if a workload that the metric needs has no value, or for the geometric mean of a negative value. The geometric mean
/// is 0 if a value is 0.
/// 1. Errors of workloads are independent: mean and geomean add their variances, with Welch-Satterthwaite degrees of
///    freedom.
/// 2. Let k workloads be within noise of the worst one. The variance of `worst` is the largest of their variances times
///    1 + ln k, because the smallest of k equal values is low by chance.
std::optional<MeasuredMetric> evaluate_set_metric(const SetMetric& metric, std::span<const WorkloadValue> values,
                                                  bool larger_is_better);
/// Evaluates a function over the values of all workloads, without noise; nothing if it has no value.
std::optional<double> fold_workloads(SetMetric::Kind kind, std::span<const double> values, bool larger_is_better);

/// Returns the names of workloads as a list for an error message.
std::string list_workloads(std::span<const std::string> workloads);

}  // namespace tools::sweep
