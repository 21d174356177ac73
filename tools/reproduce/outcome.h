#pragma once
#include <cstdint>

#include "tools/run_job.h"

namespace tools::reproduce {

/// One program on one view.
struct Outcome {
  Simulation simulation;
  std::uint64_t pixels = 0;
  bool machine = true;  ///< else `simulation` has nothing but what the frame program found out
  const kernels::Sampling& sampling() const { return simulation.function.sampling; }
};

}  // namespace tools::reproduce
