#pragma once
#include "sim/stop.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// Builds the memory image: flattens the scene's instances to world space, builds the BVH and lays out all arrays. The
/// result does not depend on the number of threads (0: all). With mip maps, textures get all their levels. A triangle
/// without area is kept as a point that no ray can hit. Throws sim::InputError for invalid references or a scene that
/// is too large, and sim::Cancelled if `stop` returns true.
MemoryImage build_memory_image(const Scene& scene, const BvhConfig& config = {}, unsigned threads = 0,
                               sim::Stop stop = nullptr, MipMaps mip_maps = MipMaps::kOff);

}  // namespace traces
