#include <cmath>
#include <utility>

#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/batch_evaluators/member_bfe.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <pagmo/utils/hypervolume.hpp>
#include <pagmo/utils/multi_objective.hpp>

#include "tools/studies/optimise/multi_objective.h"

namespace tools::optimise {
namespace {

using pagmo::vector_double;
using sweep::Choice;

constexpr double kCrossover = 0.9, kCrossoverSpread = 10, kMutationSpread = 20;

/// An optimisation problem in the form that pagmo requires. Copies refer to the same task.
struct Problem {
  const GeneticTask* task = nullptr;

  Choice choice_at(const vector_double& genes, std::size_t begin) const {
    Choice choice;
    for (std::size_t g = 0; g < task->values.size(); ++g) {
      choice.push_back(static_cast<std::uint32_t>(std::lround(genes.at(begin + g))));
    }
    return choice;
  }

  // NOLINTBEGIN(readability-identifier-naming): pagmo's names
  vector_double fitness(const vector_double& genes) const { return batch_fitness(genes); }
  vector_double batch_fitness(const vector_double& genes) const {
    std::vector<Choice> choices;
    for (std::size_t g = 0; g < genes.size(); g += task->values.size()) choices.push_back(choice_at(genes, g));
    return task->fitness(choices);
  }
  std::pair<vector_double, vector_double> get_bounds() const {
    vector_double most;
    for (const std::uint32_t values : task->values) most.push_back(values - 1);
    return {vector_double(most.size(), 0), most};
  }
  vector_double::size_type get_nobj() const { return 2; }
  vector_double::size_type get_nix() const { return task->values.size(); }
  // NOLINTEND(readability-identifier-naming)
};

class PagmoAlgorithms final : public PagmoModule {
 public:
  std::vector<Choice> run_nsga2(const GeneticTask& task) const override {
    const Problem problem{&task};
    pagmo::population population{pagmo::problem(problem), 0, task.seed};
    const std::vector<double> fitness = task.fitness(task.first_generation);
    for (std::size_t i = 0; i < task.first_generation.size(); ++i) {
      population.push_back({task.first_generation[i].begin(), task.first_generation[i].end()},
                           {fitness.at(2 * i), fitness.at(2 * i + 1)});
    }
    const double mutation = 1.0 / static_cast<double>(task.values.size());
    pagmo::nsga2 nsga2(task.generations, kCrossover, kCrossoverSpread, mutation, kMutationSpread, task.seed);
    nsga2.set_bfe(pagmo::bfe(pagmo::member_bfe()));
    population = pagmo::algorithm(std::move(nsga2)).evolve(population);
    std::vector<Choice> last;
    for (const vector_double& genes : population.get_x()) last.push_back(problem.choice_at(genes, 0));
    return last;
  }

  std::vector<std::size_t> non_dominated(std::span<const std::vector<double>> points) const override {
    if (points.size() < 2) return std::vector<std::size_t>(points.size(), 0);
    const auto front = std::get<0>(pagmo::fast_non_dominated_sorting({points.begin(), points.end()})).front();
    return {front.begin(), front.end()};
  }

  double hypervolume(std::vector<std::vector<double>> points, const std::vector<double>& reference) const override {
    return pagmo::hypervolume(std::move(points), false).compute(reference);
  }
};

}  // namespace

extern "C" __attribute__((visibility("default"))) const PagmoModule* raywatt_pagmo() {
  static const PagmoAlgorithms algorithms;
  return &algorithms;
}

}  // namespace tools::optimise
