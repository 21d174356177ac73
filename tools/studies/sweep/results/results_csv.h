#pragma once
#include <string>

#include "tools/studies/sweep/results/collection.h"

namespace tools::results {

/// results.csv: a row a point with n, id, status, its axes and every metric that any point has. Nothing
/// of the host and no text of errors: equal sweeps have equal bytes.
std::string results_csv(const Collection& all);

}  // namespace tools::results
