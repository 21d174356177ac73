#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tools/noise/noise.h"
#include "tools/studies/optimise/search.h"
#include "tools/studies/optimise/task.h"
#include "tools/studies/sweep/launch/launcher.h"
#include "tools/studies/sweep/spec/plan.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::optimise {

using sweep::PointStatus;

/// A point proposed by the search, and its result.
struct Trial {
  sweep::Point point;
  Choice choice;
  PointStatus status = PointStatus::kDone;  ///< kDone, kFailed or kImpossible
  bool is_look = false;                     ///< approximate: simulated with tile sampling
  bool is_feasible = false;                 ///< it meets all constraints
  std::uint32_t batch = 0;                  ///< number of the batch in which it was simulated
  std::vector<double> metrics;              ///< per goal; means of the replicates, if any
  std::vector<MeasuredFigure> seen;         ///< the metrics with their noise
  std::string error;                        ///< reason that there are no metrics
  std::vector<std::string> extrapolations;  ///< warnings of its report about extrapolated metrics
};

/// Runs a search: has points proposed, simulates them and adds their results. It is deterministic for a task, a seed
/// and the results, so that an interrupted search continues from the simulations in the store.
class SearchRun {
 public:
  /// `folder`: where relative paths of the task begin. Throws InputError for an impossible task.
  SearchRun(const Task& task, const std::filesystem::path& folder);
  SearchRun(const SearchRun&) = delete;
  SearchRun& operator=(const SearchRun&) = delete;

  struct Hooks {
    /// Called before new points are simulated, with all points including the new ones.
    std::function<void(const std::vector<sweep::Point>& points)> announce;
    sweep::Launcher::PointWatch watch;  ///< called for each point of a batch
  };
  /// Runs the search until its budget is spent. Returns false if interrupted. Throws InputError for a metric that
  /// reports do not have.
  bool run(sweep::Launcher& launcher, const sweep::Store& store, const Hooks& hooks);

  const std::vector<Trial>& trials() const { return trials_; }
  /// Simulated points that meet all constraints.
  std::vector<const Trial*> feasible_trials() const;
  /// Feasible points on the Pareto front, the best in the first objective first.
  std::vector<const Trial*> pareto_front() const;
  /// Returns the simulated point with the smallest violation of the constraints; null if nothing could be simulated.
  const Trial* least_infeasible() const;
  /// Returns the goals. Their metrics are full report paths once a report has been read.
  const std::vector<Goal>& goals() const { return task_.goals; }
  std::uint64_t simulated_count() const { return simulated_; }  ///< excluding first looks
  std::uint64_t computed_count() const { return computed_; }    ///< trials that were not in the store
  std::uint64_t found_count() const { return found_; }          ///< trials that were in the store

 private:
  /// Simulates points and adds their results to the search. Returns false if interrupted.
  bool compute_points(const std::vector<Choice>& choices, bool looks, sweep::Launcher& launcher,
                      const sweep::Store& store, const Hooks& hooks);
  /// Simulates those points that are possible and reads their metrics. Returns false if interrupted.
  bool simulate_trials(std::vector<Trial>& fresh, sweep::Launcher& launcher, const sweep::Store& store,
                       const Hooks& hooks);
  /// Reads the metrics of a report. A missing metric sets the status to kFailed.
  void read_metrics(Trial& trial, const sweep::Store& store);
  void resolve_metrics(const std::vector<std::string>& paths);

  Task task_;
  sweep::Planner planner_;
  Search search_;
  std::vector<Trial> trials_;
  std::map<std::string, std::size_t> by_id_;
  std::map<Choice, bool> looked_;
  std::uint64_t simulated_ = 0, computed_ = 0, found_ = 0;
  std::uint32_t batches_ = 0;
  bool has_paths_ = false;
};

}  // namespace tools::optimise
