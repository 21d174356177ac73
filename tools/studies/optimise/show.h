#pragma once
#include <string>

#include "tools/studies/optimise/search_run.h"

namespace tools::optimise {

/// The front, or the best point, as a table, and the commands that run its points again.
std::string pareto_front_text(const SearchRun& search);
/// The front with all digits: axes, figures, command.
std::string pareto_front_csv(const SearchRun& search);
/// A line of JSON for each point in the order of the search.
std::string history_jsonl(const SearchRun& search);
/// The reason that there is no Pareto front.
std::string infeasible_text(const SearchRun& search);

}  // namespace tools::optimise
