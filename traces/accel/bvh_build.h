#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "sim/stop.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/memory_image.h"

namespace traces {

/// A tree in its final placement: depth first, the child of larger surface area (child 0) right behind its parent.
struct PlacedBvh {
  std::vector<NodeRecord> nodes;
  std::vector<std::uint32_t> order;  ///< triangles as the leaves want them, by index into the input
};

PlacedBvh build_bvh(std::span<const TriangleRecord> triangles, const BvhConfig& config, unsigned threads,
                    sim::Stop stop = nullptr);

}  // namespace traces
