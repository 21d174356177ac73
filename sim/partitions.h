#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/wakeups.h"

namespace sim {

struct ClusterTurn;

/// Units of one partition and one clock that their owner ticks through direct calls, without the engine between cycles.
/// This is an optimisation. Results do not change, because an action at time t is not visible at t.
struct Cluster {
  WakeupTable::Groups units;  ///< separate groups, in the order of declaration
  void* owner = nullptr;
  void (*run)(void* owner, const ClusterTurn& turn, Time now) = nullptr;
};

/// A partition of a machine: units whose links to other partitions all have a latency. It may run on its own up to that
/// lookahead, which keeps its state in the host's caches.
///
///   outer partitions --links--> [ the inner partition ] --links--> outer partitions
///
/// 1. Outer partitions have links to the inner one only.
/// 2. The inner partition runs ahead by the lookahead; the outer ones follow.
/// 3. A pop frees a slot at a later time, so it is visible early enough. A partition whose outgoing links may be full
/// waits until the others have reached its own time.
/// 4. Results do not depend on partitions.
struct Partition {
  WakeupTable::Groups units;      ///< groups of wake-up times, without those of the cluster
  std::uint32_t nearly_full = 0;  ///< number of outgoing links to other partitions that one tick may fill
  Cluster cluster;
};

/// Returns the time before which a partition must stop, if the others have finished the work before `others_reached`
/// and the limit for all is `end`. A partition with a nearly full link must not pass the others.
inline Time run_limit(const Partition& partition, Time others_reached, Time end) {
  return std::min(end, partition.nearly_full == 0 ? end : others_reached + 1);
}

/// Limits of one call of a cluster's owner, and the wake-up times that the owner updates.
struct ClusterTurn {
  Time* wakeup_times;            ///< wake-up times of the cluster's units, updated by the owner
  std::span<Time> group_minima;  ///< minimum of each group of eight of them, updated by the owner
  const Partition& partition;
  Time inner;                    ///< time up to which the inner partition has run
  Time end;                      ///< exclusive end of the turn
  std::span<const Time> others;  ///< minima of the groups of the partition's other units

  /// True if the cluster may tick at time `at`: the partition may run that far, and no other unit of it is due earlier.
  bool includes_time(Time at) const {
    // A single comparison, because the limit that ends the turn is unpredictable.
    Time over = run_limit(partition, inner, end) - 1;
    for (const Time& other : others) over = std::min(over, other);
    return at <= over;
  }
};

/// Times up to which the partitions may run on their own, once all of them have reached the same time.
struct RunLimits {
  Time lead;  ///< of the inner partition, which runs first
  Time end;   ///< of all partitions
};

/// All partitions of a machine.
struct Partitions {
  std::vector<Partition> outer;
  Partition inner;
};

}  // namespace sim
