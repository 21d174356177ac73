#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tools/studies/sweep/spec/spec.h"

namespace tools::optimise {

/// An objective or a constraint on a metric.
struct Goal {
  enum class Kind : std::uint8_t { kMax, kMin, kBelow, kAtMost, kAbove, kAtLeast };
  Kind kind = Kind::kMax;
  std::string metric;  ///< a report path, or an unambiguous end of one
  double limit = 0;    ///< limit of a constraint; unused for an objective
  std::string at;      ///< "file:line:column", for messages

  bool is_objective() const { return kind == Kind::kMax || kind == Kind::kMin; }
  bool is_upper() const { return kind == Kind::kBelow || kind == Kind::kAtMost; }
  /// True if the value meets the constraint. Objectives are always met.
  bool is_met(double value) const;
  std::string text() const;
  /// Returns the title of the table column with distances to the limit: "room to < 1.4".
  std::string distance_title() const;
  /// Returns the distance of a value from the goal's limit, divided by the limit if the limit is not 0. Negative if the
  /// constraint is violated.
  double distance_to_limit(double value) const;
  /// Returns distance_to_limit() as text: "1.7 %", "-0.25".
  std::string distance_text(double value) const;
};
constexpr std::array<std::string_view, 6> names_of(Goal::Kind) { return {"max", "min", "<", "<=", ">", ">="}; }

/// The task of `raywatt optimise` (docs/optimise.md): axes, conditions and workload as of a sweep, and goals.
struct Task {
  std::string file;  ///< name, for messages
  sweep::Spec space;
  std::vector<Goal> goals;        ///< one or two objectives, then constraints
  std::uint64_t budget = 100;     ///< points to simulate
  std::uint64_t seed = 1;         ///< seed of all random choices
  std::uint32_t population = 40;  ///< population of NSGA-II
  std::uint32_t batch = 8;        ///< points simulated in parallel
  bool sampled = false;           ///< use first looks by tile sampling
  std::string looks_sampling;     ///< value of --tile-sampling for first looks
};
inline constexpr std::uint64_t kLeastBudget = 4, kMostBudget = 1000;

/// Reads a task; throws InputError with file, line, column, key, error, allowed values.
Task read_task(const std::filesystem::path& file);

}  // namespace tools::optimise
