#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/studies/optimise/goal.h"
#include "tools/studies/sweep/spec/spec.h"

namespace tools::optimise {

/// The task of `raywatt optimise` (docs/optimise.md): a sweep's axes, conditions and workloads, and what of them
/// is best.
struct Task {
  std::string file;  ///< its name, for messages
  sweep::Spec space;
  std::vector<Goal> goals;        ///< one or two objectives, then constraints
  std::uint64_t budget = 100;     ///< different points that are simulated
  std::uint64_t seed = 1;         ///< starts all that is drawn
  std::uint32_t population = 40;  ///< NSGA-II's
  std::uint32_t batch = 8;        ///< points that are simulated at a time
  bool sampled = false;           ///< first looks by tile sampling
  std::string looks_sampling;     ///< how, as --tile-sampling says it
};
inline constexpr std::uint64_t kLeastBudget = 4, kMostBudget = 1000;

/// InputError of one line: file, line, column, key, what is wrong, what is allowed.
Task read_task(const std::filesystem::path& file);

}  // namespace tools::optimise
