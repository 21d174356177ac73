#pragma once
#include <cstdint>

#include "tools/simulation/run_job.h"

namespace tools::reproduce {

/// One program on one view.
struct Outcome {
  Simulation simulation;
  std::uint64_t pixels = 0;
  std::uint64_t box_bytes = 0, node_bytes = 0;  ///< of the tree in the GPU's memory: boxes alone, and whole nodes
  bool machine = true;                          ///< else `simulation` has nothing but what the frame program found out
  const kernels::Sampling& sampling() const { return simulation.function.sampling; }
};

}  // namespace tools::reproduce
