#pragma once
#include <optional>
#include <string>

#include "tools/run_job.h"

namespace tools::reproduce {

/// What became of the samples of a run.
struct Samples {
  std::uint64_t wanted = 0, traced = 0;
  std::uint64_t background_wanted = 0, background_traced = 0;  ///< of these, where the picture shows no surface
  std::uint64_t tested = 0, similar = 0;                       ///< that a similarity check asked about; that it passed
};

/// One program on one view.
struct Outcome {
  Simulation simulation;
  Samples samples;
  std::uint64_t pixels = 0;
  bool machine = true;  ///< else `simulation` has nothing but what the frame program found out
};

/// What a frame program says of its samples.
Samples samples_of(const Simulation& simulation, std::uint64_t pixels);

}  // namespace tools::reproduce
