#pragma once
#include <vector>

#include "sim/report/energy.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// Energy of a frame by tile, in pJ.
struct TileEnergy {
  std::vector<sim::Spread> tiles;
  sim::Spread rest;  ///< energy of requests without a tile, and of time without tiles
};

/// Shares out the energy of an itemised frame.
///
/// 1. The energy of a core's counter is shared by that core's tiles, the energy of a shared unit's counter by all
///    tiles.
/// 2. Each tile pays in proportion to its counted part: rays, visits, tests, operations of its kernels, lines
///    requested, hits, misses, bursts.
/// 3. Where there is no count by tile, the nearest quantity is used: visits or tests for L1 hits, requested lines for
///    L1 misses and fills, array cycles for configuration words.
/// 4. A line is charged to the tile that requested it, even if others read it later.
/// 5. Time-dependent energy is shared by the tiles in flight.
/// itemised.
TileEnergy tile_energy(const FrameResult& s, const RunConfig& config);

}  // namespace tools
