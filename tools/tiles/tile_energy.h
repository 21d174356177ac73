#pragma once
#include <vector>

#include "sim/report/energy.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// Energy of a frame by tile, in pJ.
struct TileEnergy {
  std::vector<sim::Spread> tiles;
  sim::Spread rest;  ///< energy of requests that no tile made, and of time in which no tile was there
};

/// Shares out energy. What a counter of a core's unit took is shared by that core's tiles, what one of a shared unit
/// took by all, each as much as it is known to have had of it: rays, visits, tests, operations of its kernels, lines it
/// asked for, hits, misses, bursts. Where nobody counts by tile, it is what comes nearest: hits of an L1 by visits or
/// tests, its misses and fills by lines asked for, configuration words by cycles of the array. Who asks is charged,
/// whoever else reads the line later. What time brings is shared by those who are there. `s` is of a frame that was
/// itemised.
TileEnergy tile_energy(const FrameResult& s, const RunConfig& config);

}  // namespace tools
