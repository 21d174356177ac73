#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hw_models/memory/tile_accounting.h"
#include "sim/report/energy.h"
#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"

namespace tools {

/// Share of each tile in a frame's time. At any time, the tiles in flight on a core (on all cores, if no core is given)
/// share the time equally. The rest is time without tiles in flight.
struct TileTimeShares {
  std::vector<double> tiles;  ///< share of each tile; 0 for tiles of other cores
  double rest = 0;
};
TileTimeShares tile_time_shares(std::span<const hw::TileAccount> tiles, sim::Time elapsed,
                                std::optional<std::uint32_t> core);

/// Energy of a frame by tile, in pJ.
struct TileEnergy {
  std::vector<sim::Band> tiles;
  sim::Band rest;  ///< energy of requests without a tile, and of time without tiles
};

/// Returns the energy of each tile of a frame with itemised costs, by these rules:
///
/// 1. The energy of a core's counter is shared by that core's tiles, the energy of a shared unit's counter by all
///    tiles.
/// 2. These tiles share it in proportion to the counts of each tile: rays, visits, tests, operations of its kernels,
///    lines requested, hits, misses, bursts.
/// 3. Where there is no count by tile, the nearest quantity is used: visits or tests for L1 hits, requested lines for
///    L1 misses and fills, array cycles for configuration words.
/// 4. A line is charged to the tile that requested it, even if others read it later.
/// 5. Time-dependent energy is shared by the tiles in flight.
TileEnergy tile_energy(const FrameResult& s, const RunConfig& config);

/// Returns the table of tiles of a frame with itemised costs. The table of a replay has no columns x, y, width and
/// height, because a trace has no picture.
TileFrame compute_tile_table(const FrameResult& s, const RunConfig& config, std::uint32_t frame);

}  // namespace tools
