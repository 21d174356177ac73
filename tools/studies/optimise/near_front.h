#pragma once
#include <string>
#include <vector>

#include "tools/studies/optimise/search_run.h"

namespace tools::optimise {

/// Feasible points beside the front that noise does not tell from it. Of one objective: those that a one-sided test
/// does not hold to be worse than the best (Holm, 5 % for all together). Of two: those that no point dominates by more
/// than the noise in one of them (Bonferroni). The best in the first objective first.
std::vector<const Trial*> near_front(const SearchRun& search);

/// Where the noise of the objectives comes from: "noise measured by 5 replicates a point"; empty if they have none.
std::string noise_text(const SearchRun& search);

}  // namespace tools::optimise
