#pragma once
#include <cstdint>
#include <vector>

#include "tests/hw_models/machines/gpu_harness.h"

namespace hw::test {

/// Returns the recorded tiles of a frame with random additions, determined by `seed`. Added are transfers to and from
/// all regions, launches that wait for transfers, idle items, and dependencies between tiles.
std::vector<traces::TileWork> random_work(const Frame& frame, std::uint64_t seed);

}  // namespace hw::test
