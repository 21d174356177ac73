#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/optimise/search_run.h"

namespace tools::optimise {

/// What changes if the best machine of a search with one objective is replaced by a neighbour.
struct Trade {
  Neighbour neighbour;
  std::vector<std::optional<double>> values;  ///< by goal, nominal; nothing if unknown
  bool is_simulated = false;                  ///< false: the values are estimates
  bool is_feasible = false;
  double gain = 0;                    ///< by how much its objective is better, in the objective's unit
  std::optional<std::size_t> breaks;  ///< the constraint that it breaks most
  bool breaks_one = false;            ///< it is known to meet all other constraints on all workloads
  double reached = 0;                 ///< the value that is compared with the limit of `breaks`
  std::string broken_on;              ///< workload that breaks it, if there are several
};

/// Returns the trades of the best machine, those that gain most first.
std::vector<Trade> trades_of(SearchRun& search, const Trial& best);

/// Returns the constraint with the least distance to its limit; nothing without constraints.
std::optional<std::size_t> binding_limit(const SearchRun& search, const Trial& best);
/// Returns the workload that is nearest to the limit of a constraint; empty if there is one workload.
std::string binding_workload(const SearchRun& search, const Trial& trial, std::size_t goal);

/// Returns sentences: which limit binds, what a wider limit would buy, what a larger machine would buy, and which axes
/// can move without loss.
std::vector<std::string> trade_sentences(const SearchRun& search, const Trial& best, const std::vector<Trade>& trades);

}  // namespace tools::optimise
