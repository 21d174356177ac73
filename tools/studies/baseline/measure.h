#pragma once
#include <functional>
#include <string>

#include "tools/studies/baseline/stored.h"
#include "tools/studies/baseline/suite.h"

namespace tools {

/// The result of a run of a suite.
struct Measured {
  Facts facts;
  Values all;          ///< every number of its report; of replicates those in `draws` alone
  StoredDraws draws;   ///< empty without replicates
  std::string error;   ///< why there is no report; empty if there is
  double seconds = 0;  ///< host time
};

/// Computes every run of a suite, `jobs` at once, each in a process of its own, and hands them over in their order.
/// InputError if one of them cannot be begun, e.g. for a scene file that is broken.
void measure(const Suite& suite, std::uint32_t jobs, const std::function<void(const SuiteRun&, Measured)>& take);

}  // namespace tools
