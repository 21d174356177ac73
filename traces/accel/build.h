#pragma once
#include "sim/stop.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// Flattens the scene's instances to world space, builds the BVH and places everything in memory. The image is the same
/// for any number of threads (0: all there are). With mip maps a scene that has textures gets all their levels.
/// Triangles without area are kept, drawn together to a point: nothing can hit them. Throws sim::InputError for a scene
/// that names what it does not have or is too large, and sim::Cancelled if `stop` ends it.
MemoryImage build_memory_image(const Scene& scene, const BvhConfig& config = {}, unsigned threads = 0,
                               sim::Stop stop = nullptr, MipMaps mip_maps = MipMaps::kOff);

}  // namespace traces
