#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/io/json.h"
#include "sim/report/energy.h"
#include "tools/studies/optimise/optimise.h"
#include "tools/studies/worth/worth_file.h"

namespace tools::worth {

/// Options of `raywatt worth`, which compares machines without and with a feature. `search`: options of both searches;
/// its `file` is the worth file.
struct Options {
  optimise::Options search;
  bool check = false;          ///< also simulate all machines of both search spaces
  bool json = false;           ///< print JSON in place of the tables
  std::filesystem::path page;  ///< HTML page that compares both machines; empty: none
};

/// Distance of a machine's metric from the limit of a constraint.
struct LimitRoom {
  std::string constraint;  ///< "fps_margin >= 1"
  std::string text;        ///< "1.7 %"
  double value = 0;        ///< value of the metric
  double room = 0;         ///< optimise::Goal::distance_to_limit()
};

/// Results of a machine on one workload.
struct WorkloadResult {
  std::string name;        ///< name of the workload
  std::string resolution;  ///< resolution of the picture: "512x256"
  std::string id;          ///< id of the point in the store
  std::string command;     ///< command that runs it again
  double fps = 0;
  double target_fps = 0;          ///< frame.fps; 0: none
  sim::Band energy_mj;            ///< energy per frame
  sim::Band power_w;              ///< power at target_fps, or without a target while frames follow each other
  std::optional<double> psnr_db;  ///< only with a reference
  std::vector<LimitRoom> rooms;
};

/// The best machine of one side (without or with the feature) that meets all constraints.
struct Machine {
  std::vector<std::pair<std::string, std::string>> axes;  ///< name and value
  std::vector<WorkloadResult> workloads;                  ///< at least one
  std::vector<LimitRoom> rooms;                           ///< rooms of constraints on functions over all workloads
  double objective = 0;
  sim::Band objective_band;  ///< objective under low, nominal and high tables; all equal for a metric without a band
};

/// Result of simulating all machines of a search space.
struct ExhaustiveResult {
  std::size_t machines = 0;
  std::optional<double> objective;  ///< objective of the best machine; nothing if no machine meets the constraints
};

/// The result of one side of the comparison: machines without the feature, or with it.
struct SideAnswer {
  std::optional<Machine> best;          ///< none if no machine meets the constraints
  std::size_t machines = 0;             ///< number of simulated machines
  std::size_t failed = 0;               ///< number of machines whose simulation failed
  std::filesystem::path folder;         ///< folder of the search
  std::optional<ExhaustiveResult> all;  ///< only with Options::check
};

/// The result of `raywatt worth`: the best machines without and with a feature.
struct Answer {
  WorthFile file;
  std::array<SideAnswer, 2> sides;  ///< by Side
  const SideAnswer& operator[](Side side) const { return sides.at(static_cast<std::size_t>(side)); }
};

/// Returns the share of the objective that the feature saves (or gains, if maximised), under low, nominal and high
/// tables.
sim::Band saved_share(const Machine& without, const Machine& with, bool is_minimised);

/// Returns the difference between the search's best objective and that of all machines, relative to the latter. Returns
/// nothing if one of them found no machine that meets the constraints.
std::optional<double> search_error(const SideAnswer& side);
/// Largest search_error() that `--check` accepts.
inline constexpr double kSearchTolerance = 0.02;
/// True if the search of a side agrees with the simulation of all machines, or if these were not simulated.
bool is_confirmed(const SideAnswer& side);

/// Returns the result in one sentence: what the feature is worth.
std::string worth_sentence(const Answer& answer);
/// Returns the result as text: the sentence, both machines side by side, and the commands that run them again.
std::string worth_text(const Answer& answer);
/// Returns the result as JSON, schema raywatt-worth-result/1.
sim::Json worth_json(const Answer& answer);

/// Searches for the best machine without and with a feature, and prints what the feature is worth. Returns kCheckFailed
/// if neither side has a machine that meets the constraints, simulations failed, or the check found a better machine.
int run(const Options& options);

}  // namespace tools::worth
