#pragma once
#include <cstdint>
#include <vector>

#include "tests/hw_models/machines/gpu_harness.h"

namespace hw::test {

/// Number of regions to which tiles transfer: picture, samples and rates. The others are for building trees.
inline constexpr std::size_t kTileRegions = static_cast<std::size_t>(traces::Region::kBuild);

/// Returns the recorded tiles of a frame with random additions, determined by `seed`. Added are transfers to and from
/// the regions of tiles, launches that wait for transfers, idle items, and dependencies between tiles.
std::vector<traces::TileWork> random_work(const Frame& frame, std::uint64_t seed);

}  // namespace hw::test
