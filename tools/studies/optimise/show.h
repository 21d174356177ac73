#pragma once
#include <string>

#include "tools/studies/optimise/search_run.h"

namespace tools::optimise {

/// Returns the Pareto front, or the best point, as a table, and the commands that rerun its points.
std::string pareto_front_text(const SearchRun& search);
/// Returns the Pareto front with all digits: axes, metrics, command.
std::string pareto_front_csv(const SearchRun& search);
/// Returns a line of JSON per point in the order of the search.
std::string history_jsonl(const SearchRun& search);
/// Explains why no point is feasible.
std::string infeasible_text(const SearchRun& search);

}  // namespace tools::optimise
