#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tools/studies/sweep/spec/spec.h"

namespace tools::optimise {

/// The task of NSGA-II: integers, one for each gene, with two objectives that shall be low.
struct GeneticTask {
  std::vector<std::uint32_t> values;  ///< the number that each gene may take, at least 2
  /// Objectives of each of a generation, one after the other; penalties included.
  std::function<std::vector<double>(std::span<const sweep::Choice>)> fitness;
  std::vector<sweep::Choice> begin;  ///< the first generation; a multiple of 4, at least 8
  std::uint32_t generations = 1;
  std::uint32_t seed = 0;
};

/// pagmo's NSGA-II, in a module that is loaded when it is first used.
class Nsga2 {
 public:
  virtual ~Nsga2() = default;
  /// The last generation.
  virtual std::vector<sweep::Choice> run(const GeneticTask& task) const = 0;
};
using Nsga2Factory = const Nsga2* (*)();
constexpr const char* kNsga2Symbol = "raywatt_nsga2";

/// IoError if the module cannot be loaded.
const Nsga2& nsga2();

}  // namespace tools::optimise
