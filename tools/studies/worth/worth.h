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

/// Options of `raywatt worth`. `search`: options of both searches; its file is the worth file.
struct Options {
  optimise::Options search;
  bool check = false;          ///< also simulate all machines of both spaces
  bool json = false;           ///< print JSON in place of the tables
  std::filesystem::path page;  ///< HTML page that compares both machines; empty: none
};

/// Distance of a metric of a machine from a constraint's limit.
struct LimitRoom {
  std::string constraint;  ///< "fps_margin >= 1"
  std::string text;        ///< "1.7 %"
  double value = 0;        ///< of the metric
  double room = 0;         ///< optimise::Goal::distance_to_limit()
};

/// Result of a machine on a workload.
struct WorkloadResult {
  std::string name;        ///< of the workload
  std::string resolution;  ///< of its picture: "512x256"
  std::string id;          ///< of its point in the store
  std::string command;     ///< that runs it again
  double fps = 0;
  double target_fps = 0;          ///< frame.fps; 0: none
  sim::Band energy_mj;            ///< per frame
  sim::Band power_w;              ///< at target_fps, or while frames follow each other
  std::optional<double> psnr_db;  ///< with a reference
  std::vector<LimitRoom> rooms;
};

/// The best machine of a side that meets all constraints.
struct Machine {
  std::vector<std::pair<std::string, std::string>> axes;  ///< name and value
  std::vector<WorkloadResult> workloads;                  ///< at least one
  std::vector<LimitRoom> rooms;                           ///< of constraints on functions of all workloads
  double objective = 0;
  sim::Band objective_band;  ///< under low, nominal and high tables; all equal for a metric without a band
};

/// Result of simulating all machines of a space.
struct Exhaustive {
  std::size_t machines = 0;
  std::optional<double> objective;  ///< of the best machine; none if no machine meets the constraints
};

/// A side's answer.
struct SideAnswer {
  std::optional<Machine> best;    ///< none if no machine meets the constraints
  std::size_t machines = 0;       ///< simulated
  std::size_t failed = 0;         ///< of these, simulations that failed
  std::filesystem::path folder;   ///< of the search
  std::optional<Exhaustive> all;  ///< with Options::check
};

/// What a feature is worth.
struct Answer {
  WorthFile file;
  std::array<SideAnswer, 2> sides;  ///< by Side
  const SideAnswer& operator[](Side side) const { return sides.at(static_cast<std::size_t>(side)); }
};

/// Share of the objective that the feature saves (min) or gains (max) under low, nominal and high tables.
sim::Band saved_share(const Machine& without, const Machine& with, bool is_minimised);

/// Difference of the search's optimum from that of all machines, as a share of it; none if one of them found no machine
/// that meets the constraints.
std::optional<double> search_error(const SideAnswer& side);
/// Largest error of the search's optimum that `--check` accepts.
inline constexpr double kSearchTolerance = 0.02;
/// True if the search of a side found what the exhaustive sweep found, or there was none.
bool is_confirmed(const SideAnswer& side);

/// Returns the answer in one sentence.
std::string worth_sentence(const Answer& answer);
/// Returns sentence, both machines side by side, and the commands that run them again.
std::string worth_text(const Answer& answer);
/// Returns the answer as JSON, schema raywatt-worth-result/1.
sim::Json worth_json(const Answer& answer);

/// Searches the best machine without and with a feature, and prints what the feature is worth. Returns kCheckFailed if
/// neither side has a machine that meets the constraints, simulations failed, or the check found a better machine.
int run(const Options& options);

}  // namespace tools::worth
