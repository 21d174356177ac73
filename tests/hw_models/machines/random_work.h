#pragma once
#include <cstdint>
#include <vector>

#include "tests/hw_models/machines/gpu_harness.h"

namespace hw::test {

/// The tiles of a frame with additions drawn by hash from `seed`: transfers to and from all regions, between launches,
/// rays and each other; launches that wait for them; idle items; dependencies between tiles.
std::vector<traces::TileWork> random_work(const Frame& frame, std::uint64_t seed);

}  // namespace hw::test
