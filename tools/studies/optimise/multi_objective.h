#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "tools/studies/sweep/spec/spec.h"

namespace tools::optimise {

/// The score of a point: one number per objective, one or two of them. More is better.
using Score = std::vector<double>;

/// A problem for NSGA-II: one integer per gene, two objectives to minimise.
struct GeneticTask {
  std::vector<std::uint32_t> values;  ///< number of values of each gene, at least 2
  /// Returns both objectives of each point of a generation, penalties included: f1, f2, f1, f2, ...
  std::function<std::vector<double>(std::span<const sweep::Choice>)> fitness;
  std::vector<sweep::Choice> first_generation;  ///< a multiple of 4, at least 8
  std::uint32_t generations = 1;
  std::uint32_t seed = 0;
};

/// Algorithms of pagmo. They are in a module of their own (pagmo/), which is loaded at the first use.
class PagmoModule {
 public:
  virtual ~PagmoModule() = default;
  /// Returns the last generation of NSGA-II.
  virtual std::vector<sweep::Choice> run_nsga2(const GeneticTask& task) const = 0;
  /// Returns the indices of the points that no other dominates, in any order. All objectives are minimised.
  virtual std::vector<std::size_t> non_dominated(std::span<const std::vector<double>> points) const = 0;
  /// Returns the hypervolume between the points and a reference that all of them dominate. Two objectives, minimised.
  virtual double hypervolume(std::vector<std::vector<double>> points, const std::vector<double>& reference) const = 0;
};
using PagmoFactory = const PagmoModule* (*)();
constexpr const char* kPagmoSymbol = "raywatt_pagmo";

/// Loads the module if needed; throws IoError if it cannot be loaded.
const PagmoModule& pagmo_module();

/// Returns the indices of the Pareto front, the best in the first objective first. Of equal scores only the first
/// counts.
std::vector<std::size_t> pareto_front_of(std::span<const Score> scores);

/// Returns the area between `corner` and the Pareto front of scores of two objectives. Scores that are not better than
/// the corner in both add nothing.
double hypervolume(std::span<const Score> scores, const Score& corner);

/// A Pareto front of two objectives, and the area that another score would add to its hypervolume.
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
