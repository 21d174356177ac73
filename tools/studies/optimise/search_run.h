#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tools/studies/optimise/evaluation.h"
#include "tools/studies/optimise/search.h"
#include "tools/studies/optimise/task.h"
#include "tools/studies/sweep/launch/launcher.h"
#include "tools/studies/sweep/spec/plan.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::optimise {

/// A machine that differs from the best machine of a search in one axis.
struct Neighbour {
  Choice choice;
  std::string axis, from, to;  ///< the axis, its value in the best machine, and its value in this one
  std::vector<std::optional<Estimate>> estimates;  ///< by goal: value estimated by the surrogates
  const Trial* trial = nullptr;                    ///< result of its simulation; null if not simulated
};

/// Runs a search: simulates the machines that Search proposes (a run is the simulation of a machine on one workload)
/// and returns the results to it. Same task, seed and results give the same search, so that an interrupted one
/// continues from the simulations in the store.
///
/// 1. A machine is simulated on one workload after the other, first on those that ruled out most machines. After a
///    workload that breaks a limit by more than the noise, the others are skipped.
/// 2. With one objective, up to a quarter of the budget goes to machines that differ from the best one in one axis.
/// 3. If frames were sampled, the best machine is simulated whole, and so are up to four better ones that break limits
///    by less than the noise. If the best machine then breaks a limit, the search continues with the rest of its
///    budget, until a best machine is confirmed.
class SearchRun {
 public:
  /// Relative paths in the task begin at `folder`. Throws InputError for an impossible task, and for a goal with a
  /// metric that reports will lack.
  SearchRun(const Task& task, const std::filesystem::path& folder);
  SearchRun(const SearchRun&) = delete;
  SearchRun& operator=(const SearchRun&) = delete;

  struct Hooks {
    /// Called before runs are simulated, with the points of all runs of the search including these.
    std::function<void(const std::vector<sweep::Point>& points)> announce;
    sweep::Launcher::PointWatch watch;  ///< called when a run of a batch has ended
  };
  /// Runs the search until its budget is spent. Returns false if interrupted. Throws InputError for a metric that
  /// reports do not have.
  bool run(sweep::Launcher& launcher, const sweep::Store& store, const Hooks& hooks);
  /// Simulates whole frames until all machines on the Pareto front have them. Returns false if interrupted.
  bool check_front(sweep::Launcher& launcher, const sweep::Store& store, const Hooks& hooks);

  const std::vector<Trial>& trials() const { return trials_; }
  /// Returns the simulated machines that meet all constraints.
  std::vector<const Trial*> feasible_trials() const;
  /// Returns the feasible machines on the Pareto front, from the best in the first objective on.
  std::vector<const Trial*> pareto_front() const;
  /// Returns the simulated machine with the smallest violation of the constraints, if possible one that ran on all
  /// workloads; null if none could be simulated.
  const Trial* least_infeasible() const;
  /// Returns the machines that differ from this one in one axis, with estimates and simulations.
  std::vector<Neighbour> neighbours_of(const Trial& trial);

  const Evaluator& evaluator() const { return evaluator_; }
  const std::vector<Goal>& goals() const { return evaluator_.goals(); }
  const std::vector<std::string>& workloads() const { return evaluator_.workloads(); }
  const Task& task() const { return task_; }
  /// Returns the points of all runs; those of first looks only if `with_looks`.
  std::vector<sweep::Point> points(bool with_looks) const;
  /// Describes how machines are simulated: "tile sampling of 5 % at 1920x1080", "whole frames of 512x256".
  /// A second line warns of small pictures.
  std::string fidelity_text() const;
  /// True if the frames of some workload are simulated by sampled tiles only.
  bool is_tiled() const { return std::ranges::find(tiled_, true) != tiled_.end(); }
  std::uint64_t simulated_count() const { return simulated_; }      ///< machines, excluding first looks
  std::uint64_t computed_count() const { return computed_; }        ///< simulations that were not in the store
  std::uint64_t stored_simulation_count() const { return found_; }  ///< simulations that were in the store
  std::uint64_t skipped_count() const { return skipped_; }  ///< simulations of machines that were ruled out earlier

 private:
  struct Machines {
    sweep::Launcher& launcher;
    const sweep::Store& store;
    const Hooks& hooks;
  };
  std::string frames_text() const;
  std::vector<std::string> probe_machine(const Choice& machine);
  std::vector<Goal> resolve_goals();
  Space make_space() const;
  Search::Options make_search_options();
  double exact_area(const Choice& choice, double quantile);
  Choice choice_on_workload(const Choice& machine, std::size_t workload) const;
  /// Returns the tile sampling with which a run is simulated; empty for whole frames.
  std::string tile_sampling_of(const sweep::Point& point, std::size_t workload);
  Trial make_trial(const Choice& choice, bool is_first_look);
  std::vector<std::size_t> workload_order() const;

  /// Simulates machines and adds their results to the search. Returns false if interrupted.
  bool compute_machines(const std::vector<Choice>& choices, bool is_first_look, const Machines& with);
  /// Simulates new machines, except impossible ones, workload by workload. Returns false if interrupted.
  bool simulate_trials(std::vector<Trial>& fresh, const Machines& with);
  /// Simulates runs on one workload and reads their results.
  bool simulate_runs(const std::vector<WorkloadRun*>& runs, const std::vector<sweep::Point>& others,
                     const Machines& with);
  void add_to_search(const Trial& trial, const Choice& choice);
  MetricValues figure_values(const std::vector<WorkloadRun>& runs, std::vector<double>& errors,
                             bool& are_assumed) const;
  bool simulate_proposed_until(std::uint64_t until, const Machines& with);
  std::vector<Choice> unknown_neighbours();
  bool refine_best(const Machines& with);
  bool simulate_space(const Machines& with);
  bool simulate_whole(const Trial& sampled, const Machines& with);
  /// Returns the best machine that breaks limits within noise only and would be on the front; null if there is none.
  const Trial* find_doubtful() const;
  bool simulate_whole_front(const Machines& with);
  bool has_one_objective() const;
  Score score_of(const Trial& trial) const;
  std::size_t index_of(const Trial& trial) const { return static_cast<std::size_t>(&trial - trials_.data()); }

  Task task_;
  sweep::Planner planner_;
  sweep::PointKeys keys_;
  Evaluator evaluator_;
  std::vector<bool> tiled_;                        ///< by workload: true if frames are simulated by sampled tiles
  bool has_small_picture_ = false;                 ///< a workload's picture has fewer pixels than kLargePicture
  std::vector<std::string> resolutions_;           ///< by workload
  std::set<std::string> starts_;                   ///< values of frame.start
  std::vector<std::vector<std::size_t>> figures_;  ///< by goal, then workload: index of the figure in `search_`
  std::size_t figure_count_ = 0;
  Search search_;
  std::vector<Trial> trials_;
  std::map<std::string, std::size_t> by_id_;
  std::map<Choice, std::size_t> by_choice_;
  std::set<Choice> looked_;
  std::vector<std::uint64_t> ruled_out_;  ///< by workload: number of machines that it ruled out
  std::uint64_t simulated_ = 0, computed_ = 0, found_ = 0, skipped_ = 0, proposed_ = 0;
  std::uint32_t batches_ = 0;
  int doubtful_ = 0;  ///< number of doubtful machines whose whole frames were simulated
  bool has_metrics_ = false;
};

}  // namespace tools::optimise
