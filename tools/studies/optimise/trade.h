#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/optimise/search_run.h"

namespace tools::optimise {

/// What changes if the best machine of a search (one objective) is replaced by a neighbour, which differs in one axis.
struct Trade {
  Neighbour neighbour;
  std::vector<std::optional<double>> values;  ///< by goal, nominal value; nothing if unknown
  bool is_simulated = false;                  ///< false: the values are estimates
  bool is_feasible = false;
  double gain = 0;                    ///< improvement of the objective, in its unit; negative if it is worse
  std::optional<std::size_t> breaks;  ///< constraint that the neighbour breaks most
  bool breaks_one = false;            ///< the neighbour breaks only this constraint; all others are known to be met
  double reached = 0;                 ///< the value that is compared with the limit of `breaks`
  std::string broken_on;              ///< workload on which it breaks this constraint; empty if binding_workload() is
};

/// Returns the trades from the best machine to its neighbours, by gain in descending order.
std::vector<Trade> trades_of(SearchRun& search, const Trial& best);

/// Returns the constraint to whose limit the best machine is nearest; nothing without constraints.
std::optional<std::size_t> binding_limit(const SearchRun& search, const Trial& best);
/// Returns the workload on which a machine is nearest to a constraint's limit; of `worst` the workload with the worst
/// value. Empty for a mean, for a metric of the machine alone, and if there is only one workload.
std::string binding_workload(const SearchRun& search, const Trial& trial, std::size_t goal);

/// Returns sentences: which limit is nearest, which change a wider limit would allow, which change buys distance to the
/// limit most cheaply, and which changes cost nothing.
std::vector<std::string> trade_sentences(const SearchRun& search, const Trial& best, const std::vector<Trade>& trades);

}  // namespace tools::optimise
