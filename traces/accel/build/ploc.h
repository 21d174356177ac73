#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "sim/error.h"
#include "traces/accel/build/binary_tree.h"
#include "traces/accel/bvh_config.h"

namespace traces {

/// Builds a tree by parallel locally-ordered clustering (Meister and Bittner 2018) and appends the number of clusters
/// at the start of each round to `clusters`. Polls `stop`.
///
/// 1. At first each item is a cluster, in Morton order.
/// 2. In a round each cluster finds the cluster at most `config.ploc_radius` positions away whose box together with its
///    own has the least area. Two clusters that find each other are merged, at the position of the first.
/// 3. Of equal areas, the nearer position wins, then pairs that begin at an even position, then the earlier position.
///    Therefore equal boxes merge in pairs.
/// 4. If 256 clusters or more have less than one pair per 64 clusters, as nested boxes do, clusters 2k and 2k + 1 are
///    merged instead. So the work of all rounds is at most proportional to the number of items.
BinaryTree build_ploc(std::span<const Bounds> boxes, const BvhConfig& config, sim::Stop stop,
                      std::vector<std::uint32_t>& clusters);

}  // namespace traces
