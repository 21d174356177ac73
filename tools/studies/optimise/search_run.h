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

/// A point that the search has asked for.
struct Trial {
  sweep::Point point;
  Choice choice;
  PointStatus status = PointStatus::kDone;  ///< kDone, kFailed or kImpossible
  bool is_look = false;                     ///< an estimate by tile sampling
  bool is_feasible = false;                 ///< it meets all constraints
  std::uint32_t batch = 0;                  ///< with which it was simulated
  std::vector<double> figures;              ///< for each goal; means of replicates, if there are any
  std::vector<SeenFigure> seen;             ///< the same with their noise
  std::string error;                        ///< why there are none
  std::vector<std::string> extrapolations;  ///< warnings of its report, if some of its figures are extrapolated
};

/// A search and the simulations that it asks for. What it does follows from the task, the seed and the results alone:
/// begun again after an interrupt it finds its simulations in the store and goes on.
class SearchRun {
 public:
  /// InputError for a task that cannot be done. Files that it names are seen from `folder`.
  SearchRun(const Task& task, const std::filesystem::path& folder);
  SearchRun(const SearchRun&) = delete;
  SearchRun& operator=(const SearchRun&) = delete;

  struct Hooks {
    /// Told all points so far before those that are new are computed.
    std::function<void(const std::vector<sweep::Point>& points)> announce;
    sweep::Launcher::PointWatch watch;  ///< told of each point of a batch
  };
  /// False if interrupted. InputError for a figure that reports do not have.
  bool run(sweep::Launcher& launcher, const sweep::Store& store, const Hooks& hooks);

  const std::vector<Trial>& trials() const { return trials_; }
  /// Those that were simulated and meet the constraints.
  std::vector<const Trial*> feasible() const;
  /// Those of them on the Pareto front: the best in the first objective first.
  std::vector<const Trial*> pareto_front() const;
  /// The simulated point that misses the constraints least; none if nothing could be simulated.
  const Trial* nearest() const;
  const std::vector<Goal>& goals() const { return task_.goals; }  ///< their figures in full, once there is a report
  std::uint64_t simulated() const { return simulated_; }          ///< without first looks
  std::uint64_t computed() const { return computed_; }            ///< trials that were not in the store
  std::uint64_t found() const { return found_; }                  ///< trials that were in the store

 private:
  /// Has points computed and tells the search; false if interrupted.
  bool compute(const std::vector<Choice>& choices, bool looks, sweep::Launcher& launcher, const sweep::Store& store,
               const Hooks& hooks);
  /// Has those computed that are possible, and reads their figures; false if interrupted.
  bool simulate(std::vector<Trial>& fresh, sweep::Launcher& launcher, const sweep::Store& store, const Hooks& hooks);
  /// Reads a report. Nothing, and why, if it lacks a figure.
  void read_figures(Trial& trial, const sweep::Store& store);
  void find_figures(const std::vector<std::string>& paths);

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
