#pragma once
#include <cstddef>
#include <string>

#include "tools/studies/sweep/results/index/collection.h"
#include "tools/studies/sweep/store/folder.h"

namespace tools::results {

/// How many points are in which state.
struct Collected {
  std::size_t done = 0, failed = 0, missing = 0, damaged = 0;
  bool unchanged = false;  ///< nothing had happened since the last time, and nothing was written
  std::size_t points() const { return done + failed + missing + damaged; }
};

/// Makes index.sqlite and results.csv of a sweep anew from its points.jsonl and what its store holds of these points.
/// Both are replaced as a whole; another collector of the same sweep waits. InputError for a damaged list of points.
Collected collect(const sweep::SweepFolder& folder);

/// "200 points: 198 done, 2 failed"
std::string summary_text(const Collected& collected);

/// results.csv: a row a point with n, id, status, its axes and every metric that any point has. Nothing
/// of the host and no text of errors: equal sweeps have equal bytes.
std::string results_csv(const Collection& all);

}  // namespace tools::results
