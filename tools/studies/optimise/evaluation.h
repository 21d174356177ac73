#pragma once
#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tools/analysis/report_file.h"
#include "tools/noise/noise.h"
#include "tools/pricing/priced_run.h"
#include "tools/studies/optimise/task.h"
#include "tools/studies/sweep/spec/point.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::optimise {

using sweep::Choice;
using sweep::PointStatus;

inline constexpr std::uint64_t kTableDraws = 1000;  ///< number of random draws of the energy and area tables

/// A simulated metric with its uncertainty: its noise, and its values under random draws of the energy and area tables.
struct MetricUncertainty {
  MeasuredMetric seen;
  std::vector<double> factors;  ///< by draw: value divided by the nominal one; empty: the tables do not affect it

  double factor(std::size_t draw) const { return factors.empty() ? 1 : factors[draw]; }
  /// Returns the metric, with noise, as computed with the energy and area tables of random draw number `draw`.
  MeasuredMetric at(std::size_t draw) const;
  /// Returns the value that the metric does not exceed with probability `share`.
  double quantile(double share) const;
};

/// Returns the probability that the true value of a noisy metric meets a constraint.
double probability_met(const Goal& goal, const MeasuredMetric& seen);

/// Makes random draws of a report's energy and area tables. In draw N an entry has the same quantile in every report,
/// so that reports can be compared draw by draw.
///
/// 1. Entries of energy tables are drawn independently of each other (EnergyDraw).
/// 2. The whole area has one random quantile per draw.
class TableDraws {
 public:
  explicit TableDraws(const ReportFile& report) : report_(report) {}
  /// Returns the uncertainty of a metric. `path`: full report path. Throws InputError if energy cannot be computed.
  MetricUncertainty uncertainty_of(const std::string& path, const MeasuredMetric& seen);

 private:
  const ReportFile& report_;
  std::unique_ptr<PricedRun> priced_;
  std::map<std::string, std::vector<double>> factors_;  ///< by block (EnergyMetric::block), and of the area
};

/// Returns the band of a report's metric. The report must have low, nominal and high below `path`.
sim::Band band_at(const ReportFile& report, const std::string& path);
/// Returns a quantile of the area: 0 gives the low end of the band, 1 the high end.
double area_at(const sim::Band& band, double quantile);

/// The simulation of a machine on one workload.
struct WorkloadRun {
  std::size_t workload = 0;  ///< index
  sweep::Point point{};
  PointStatus status = PointStatus::kMissing;  ///< kMissing: not simulated
  /// By goal: value of the goal's metric on this workload, with its noise; NaN if neither the goal needs the workload
  /// nor the report has the metric.
  std::vector<MeasuredMetric> seen{};
  /// By goal: the value that is compared with the limit. If the task requires a confidence, it is a quantile of `seen`.
  std::vector<double> compared{};
  std::string error{};                        ///< reason that there are no metrics
  std::vector<std::string> extrapolations{};  ///< warnings of the report about extrapolated metrics

  bool is_done() const { return sweep::is_done(status) && !seen.empty(); }
};

/// A machine proposed by the search, and its results.
struct Trial {
  Choice choice;                                          ///< values of the machine's axes
  std::vector<std::pair<std::string, std::string>> axes;  ///< names and values
  std::string id;                                         ///< id of the machine's point on the first workload
  PointStatus status = PointStatus::kDone;                ///< kDone, kFailed or kImpossible
  bool is_first_look = false;                             ///< a first look: simulated approximately, with tile sampling
  bool is_feasible = false;                               ///< it meets all constraints
  std::uint32_t batch = 0;                                ///< number of the batch in which it was simulated
  std::vector<WorkloadRun> runs;                          ///< by workload
  std::vector<WorkloadRun> whole;                         ///< by workload: whole frames; empty if not simulated
  std::vector<std::optional<MeasuredMetric>> seen;  ///< by goal: value with noise; nothing if a workload has no result
  std::vector<std::optional<double>> compared;      ///< by goal: the value that is compared with its limit
  std::optional<std::size_t> ruled_out_by;  ///< workload that broke a limit beyond noise; later ones are skipped
  std::string error;                        ///< reason that there are no metrics

  const std::vector<WorkloadRun>& best_runs() const { return whole.empty() ? runs : whole; }
  /// Returns the value of a goal. The goal must have a value.
  double value(std::size_t goal) const { return seen[goal]->value; }
  /// True if all its goals have values.
  bool is_complete() const;
  /// True if every workload has a result.
  bool is_on_all_workloads() const { return std::ranges::all_of(best_runs(), &WorkloadRun::is_done); }
  /// True if a workload was simulated by sampled tiles.
  bool is_sampled() const {
    return std::ranges::any_of(best_runs(), [](const WorkloadRun& run) { return !run.point.tile_sampling.empty(); });
  }
  std::vector<std::string> extrapolations() const;  ///< warnings of all workloads, without duplicates
};

/// Probabilities that a machine meets its limits.
struct LimitProbabilities {
  std::vector<double> met;  ///< by goal; 1 for objectives
  double all = 0;           ///< probability that all limits are met
  /// By goal: its 10 % and 90 % quantile over random draws of the energy and area tables, without noise.
  std::vector<std::pair<double, double>> bands;
};

/// Returns the full path of a goal's metric. Throws InputError for a metric that is not among `paths`, or an objective
/// that cannot rank machines.
std::string resolve_metric(const Goal& goal, std::span<const std::string> paths,
                           std::span<const std::string> workloads);

/// Computes the values of a search's goals from the results of simulations.
class Evaluator {
 public:
  /// `workloads`: names of the workloads, at least one.
  Evaluator(std::vector<Goal> goals, std::vector<std::string> workloads, double confidence, std::string file)
      : goals_(std::move(goals)),
        workloads_(std::move(workloads)),
        confidence_(confidence),
        file_(std::move(file)),
        is_resolved_(goals_.size()) {}

  /// The goals. All their metrics are full report paths after the first report is read.
  const std::vector<Goal>& goals() const { return goals_; }
  const std::vector<std::string>& workloads() const { return workloads_; }

  /// Reads the goals' metrics from the report of a finished run. A missing metric that the goal needs of this workload
  /// sets the run's status to kFailed; in the first report that the goal needs it throws InputError.
  void read_run(WorkloadRun& run, const sweep::Store& store);
  /// True if the value of a goal depends on this workload.
  bool needs_workload(const Goal& goal, std::size_t workload) const;
  /// Returns the first constraint that the result on this workload alone breaks by more than the noise.
  std::optional<std::size_t> find_broken_limit(const WorkloadRun& run, std::size_t workload) const;
  /// True if a machine has results on all workloads and breaks limits, but none by more than the noise.
  bool is_doubtful(const Trial& trial) const;
  /// Sets `seen` and `is_feasible` of a machine from its runs.
  void set_goal_values(Trial& trial) const;

  /// Returns the probabilities that a machine meets its limits, given noise and random draws of energy and area tables.
  LimitProbabilities limit_probabilities_of(const Trial& trial, const sweep::Store& store) const;

 private:
  /// Gives goals that need this workload the full paths of their metrics. Throws InputError for a missing metric.
  void resolve_goals(std::size_t workload, const ReportFile& report);
  std::vector<sweep::WorkloadValue> values_of(const std::vector<WorkloadRun>& runs, std::size_t goal) const;

  std::vector<Goal> goals_;
  const std::vector<std::string> workloads_;
  const double confidence_;
  const std::string file_;
  std::vector<bool> is_resolved_;  ///< by goal: its metric is a full path of a report
};

}  // namespace tools::optimise
