#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/io/json.h"
#include "sim/report/energy.h"
#include "tools/studies/optimise/optimise.h"
#include "tools/studies/optimise/task.h"

namespace tools::worth {

/// The two sides of a comparison: machines without the feature and machines with it.
enum class Side : std::uint8_t { kWithout, kWith };
inline constexpr std::array<Side, 2> kSides = {Side::kWithout, Side::kWith};
constexpr std::array<std::string_view, 2> names_of(Side) { return {"without", "with"}; }

/// A search, and the text of a search's file that describes it.
struct SideSearch {
  optimise::Task task;
  std::string text;
};

/// A worth file: a search, and the two variants of it that are compared (docs/worth.md).
struct WorthFile {
  std::string feature;  ///< name of the feature, as it is written within a sentence
  std::string question;
  std::array<SideSearch, 2> sides;  ///< by Side

  const SideSearch& operator[](Side side) const { return sides.at(static_cast<std::size_t>(side)); }
};

/// Reads a worth file: a search's file with `feature`, `without` and `with`.
///   1. Both sides start from the search. Without `objectives` it minimises area_mm2.
///   2. A value in `without` or `with` replaces the search's. Items of lists are added, axes are added or replaced.
/// Throws InputError with file, line, column, key, error and allowed values.
WorthFile read_worth_file(const std::filesystem::path& file);

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
