#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/studies/sweep/spec/set_metric.h"
#include "tools/studies/sweep/spec/spec.h"

namespace tools::optimise {

/// A goal of a search: an objective or a constraint on a metric, or on a function of its values on all workloads.
struct Goal {
  enum class Kind : std::uint8_t { kMax, kMin, kBelow, kAtMost, kAbove, kAtLeast };
  Kind kind = Kind::kMax;
  std::string metric;  ///< a report path, or an unambiguous end of one
  double limit = 0;    ///< limit of a constraint; unused for an objective
  std::string at;      ///< "file:line:column", for messages
  sweep::SetMetric::Kind fold = sweep::SetMetric::Kind::kEach;
  std::string workload{};  ///< workload of kOn

  sweep::SetMetric set_metric() const { return {fold, metric, workload}; }
  /// Returns the metric as it is displayed: "worst(perf.fps)".
  std::string metric_text() const;
  /// True if larger values of the metric are better, so that `worst` is the smallest one.
  bool is_larger_better() const;
  /// Returns the value of the goal from those of its workloads; nothing if its function has no value.
  std::optional<double> combine(std::span<const double> values) const;
  bool is_objective() const { return kind == Kind::kMax || kind == Kind::kMin; }
  bool is_less_better() const { return kind == Kind::kMin || is_upper_limit(); }
  bool is_upper_limit() const { return kind == Kind::kBelow || kind == Kind::kAtMost; }
  /// True if the value meets the constraint. Always true for an objective.
  bool is_met(double value) const;
  /// True for a constraint that must be met on each workload separately: worst(fps) >= 60, but not worst(fps) < 100.
  bool applies_to_each_workload() const;
  /// True for a constraint that a workload meets or breaks by its own value.
  bool has_limit_per_workload() const;
  std::string text() const;
  /// Returns the title of the table column with distances to the limit: "room to < 1.4".
  std::string distance_title() const;
  /// Returns the distance of a value from the limit of this constraint, relative to the limit unless that is 0.
  /// Negative if the constraint is violated.
  double distance_to_limit(double value) const;
  /// Returns distance_to_limit() as text: "1.7 %", "-0.25".
  std::string distance_text(double value) const;
};
constexpr std::array<std::string_view, 6> names_of(Goal::Kind) { return {"max", "min", "<", "<=", ">", ">="}; }

/// How the machines of a search are simulated.
enum class Fidelity : std::uint8_t {
  kAuto,     ///< kTiles for large pictures of full:N, else kFull
  kFull,     ///< whole frames
  kSampled,  ///< approximate first looks by tile sampling, then whole frames of promising machines
  kTiles,    ///< tile sampling, then whole frames of the best machine
};
constexpr std::array<std::string_view, 4> names_of(Fidelity) { return {"auto", "full", "sampled", "tiles"}; }
/// Parses the name of a fidelity; returns nothing for other text.
std::optional<Fidelity> parse_fidelity(std::string_view text);

/// The task of `raywatt optimise` (docs/optimise.md): a sweep's axes, conditions and workloads, and the goals.
struct Task {
  std::string file;  ///< name, for messages
  sweep::Spec space;
  std::vector<std::string> workloads;  ///< names; they are the first axis of `space`. Empty: one, without an axis
  std::vector<Goal> goals;             ///< one or two objectives, then constraints
  std::uint64_t budget = 100;          ///< machines to simulate
  std::uint64_t seed = 1;              ///< seed of all random choices
  std::uint32_t population = 40;       ///< population of NSGA-II
  std::uint32_t batch = 8;             ///< machines simulated in parallel
  Fidelity fidelity = Fidelity::kAuto;
  std::string sampling;        ///< value of --tile-sampling
  double confidence = 0;       ///< required probability that each limit is met; 0: nominal values are compared
  bool simulates_all = false;  ///< simulate every machine of the space, without a search

  /// Returns the axes that distinguish machines: all but the axis of workloads.
  std::span<const sweep::Axis> machine_axes() const { return std::span(space.axes).subspan(workloads.empty() ? 0 : 1); }
};
inline constexpr std::string_view kConfidenceRange = "allowed: a probability of at least 0.5 and below 1";
/// True for a probability that a search can require for its limits. 0.5 nearly means nominal values.
constexpr bool is_confidence(double share) { return share >= 0.5 && share < 1; }
inline constexpr const char* kSearchFile = "search.json";  ///< file with the data for the HTML page of a search
inline constexpr std::uint64_t kLeastBudget = 4, kMostBudget = 1000;

inline constexpr std::string_view kSchema = "raywatt-optimise/1";

/// Reads a search's file. Throws InputError with file, line, column, key, error and allowed values.
Task read_task(const std::filesystem::path& file);
/// Reads a search's task from the parsed YAML of its file. `name`: the file's name, for messages.
Task parse_task(const sim::YamlNode& tree, const std::string& name);

}  // namespace tools::optimise
