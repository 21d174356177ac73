#pragma once
#include <span>

#include "sim/error.h"
#include "traces/accel/build/binary_tree.h"
#include "traces/accel/bvh_config.h"

namespace traces {

/// Builds a linear BVH (Karras 2012): a range of items in Morton order splits where the highest bit of their codes
/// changes. Of items with equal codes, the positions in Morton order are the codes. Polls `stop`.
BinaryTree build_lbvh(std::span<const Bounds> boxes, const BvhConfig& config, sim::Stop stop);

}  // namespace traces
