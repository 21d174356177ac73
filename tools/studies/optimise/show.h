#pragma once
#include <string>

#include "tools/studies/optimise/search_run.h"

namespace tools::optimise {

/// The front, or the best point, as a table, and the commands that run its points again.
std::string front_text(const Course& course);
/// The front with all digits: axes, figures, command.
std::string front_csv(const Course& course);
/// A line of JSON for each point in the order of the search.
std::string history_jsonl(const Course& course);
/// Why there is no front.
std::string infeasible_text(const Course& course);

}  // namespace tools::optimise
