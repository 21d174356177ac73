#pragma once
#include <functional>
#include <string>

#include "tools/studies/baseline/suite.h"

namespace tools {

/// The result of a run of a suite.
struct Measured {
  Facts facts;
  Values all;          ///< all numbers of its report except replicates
  StoredDraws draws;   ///< statistics of replicates, if any
  std::string error;   ///< reason that there is no report; empty if there is one
  double seconds = 0;  ///< host time
};

/// Simulates the runs of a suite, `jobs` at once, each in its own process, and calls `take` for each in order.
/// InputError if a run cannot start, e.g. because of a broken scene file.
void simulate_suite(const Suite& suite, std::uint32_t jobs, const std::function<void(const SuiteRun&, Measured)>& take);

}  // namespace tools
