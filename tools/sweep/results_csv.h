#pragma once
#include "tools/sweep/folder.h"

namespace tools::sweep {

/// Writes results.csv: a row for each point in its order, whatever became of it; nothing of the host. Equal sweeps give
/// equal bytes.
void write_results_csv(const SweepFolder& folder);

}  // namespace tools::sweep
