#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "tools/studies/sweep/spec/spec.h"

namespace tools::optimise {

/// The score of a point of the search space: a number for each of its one or two objectives. More is better.
using Score = std::vector<double>;

/// A problem for the genetic algorithm NSGA-II. A point has one integer per gene. Two objectives are minimised.
struct GeneticTask {
  std::vector<std::uint32_t> values;  ///< number of values of each gene, at least 2
  /// Returns both objectives of each point of a generation, with penalties, as f1, f2, f1, f2, ...
  std::function<std::vector<double>(std::span<const sweep::Choice>)> fitness;
  std::vector<sweep::Choice> first_generation;  ///< a multiple of 4, at least 8
  std::uint32_t generations = 1;
  std::uint32_t seed = 0;
};

/// Algorithms of the library pagmo, in a separate module (pagmo/) that is loaded at the first use.
class PagmoModule {
 public:
  virtual ~PagmoModule() = default;
  /// Runs NSGA-II and returns the last generation.
  virtual std::vector<sweep::Choice> run_nsga2(const GeneticTask& task) const = 0;
  /// Returns the indices of the points that no other dominates, in any order. All objectives are minimised.
  virtual std::vector<std::size_t> non_dominated(std::span<const std::vector<double>> points) const = 0;
  /// Returns the area between the points and a reference that all of them dominate. Two objectives, minimised.
  virtual double hypervolume(std::vector<std::vector<double>> points, const std::vector<double>& reference) const = 0;
};
using PagmoFactory = const PagmoModule* (*)();
constexpr const char* kPagmoSymbol = "raywatt_pagmo";

/// Returns the module; loads it at the first call. Throws IoError if it cannot be loaded.
const PagmoModule& pagmo_module();

/// Returns the indices of the Pareto front, from the best first objective on. Of equal scores only the first is
/// included.
std::vector<std::size_t> pareto_front_of(std::span<const Score> scores);

/// Returns the area between `corner` and the Pareto front of two objectives. Scores not better than `corner` in both
/// are ignored.
double hypervolume(std::span<const Score> scores, const Score& corner);

/// A Pareto front of two objectives, to compute how much a further score would add to its hypervolume.
class HypervolumeGain {
 public:
  explicit HypervolumeGain(Score corner) : corner_(std::move(corner)) {}
  double gain_of(const Score& score) const;
  void add(const Score& score);

 private:
  std::vector<Score> front_;
  Score corner_;
  double hypervolume_ = 0;
};

}  // namespace tools::optimise
