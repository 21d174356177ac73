#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/wakeups.h"

namespace sim {

struct ClusterTurn;

/// A cluster: units of one partition and one clock, which their owner ticks by direct calls instead of the engine. An
/// optimisation: results do not change, because an action at time t is not visible at time t.
struct Cluster {
  WakeupTable::Groups units;  ///< groups of the wake-up table that contain the cluster's units
  void* owner = nullptr;
  void (*run)(void* owner, const ClusterTurn& turn, Time now) = nullptr;
};

/// A partition of a machine: a set of units. It may run without the other partitions for the latency of the links
/// between them (the lookahead), which keeps its state in the host's caches.
///
///   outer partitions --links--> [ the inner partition ] --links--> outer partitions
///
/// 1. An outer partition has links only to the inner partition.
/// 2. The inner partition runs first, up to the lookahead. The outer partitions follow.
/// 3. A partition with an outgoing link that may become full waits until the others have reached its time, because
/// their pops free slots.
/// 4. Results do not depend on the division into partitions.
struct Partition {
  WakeupTable::Groups units;      ///< groups of the wake-up table with the partition's units, without those of its
                                  ///< cluster
  std::uint32_t nearly_full = 0;  ///< number of links to other partitions that one tick may fill
  Cluster cluster;
};

/// Returns the time before which a partition of the machine must stop. `others_reached`: time before which the other
/// partitions have finished all work. `end`: limit for all partitions. While a link to another partition is nearly
/// full, the partition may run only up to time `others_reached`, inclusive.
inline Time run_limit(const Partition& partition, Time others_reached, Time end) {
  return std::min(end, partition.nearly_full == 0 ? end : others_reached + 1);
}

/// Argument of a cluster's run function: limits of the run, and the wake-up times that the cluster's owner updates.
struct ClusterTurn {
  Time* wakeup_times;            ///< wake-up times of the cluster's units, updated by the owner
  std::span<Time> group_minima;  ///< minimum of each group of eight of these times, updated by the owner
  const Partition& partition;
  Time inner;                    ///< time that the inner partition has reached
  Time end;                      ///< time before which the cluster's run ends
  std::span<const Time> others;  ///< earliest wake-up time in each group of the partition's other units

  /// True if the cluster may tick at time `at`: the partition may run to that time, and none of the partition's units
  /// outside the cluster is due before.
  bool includes_time(Time at) const {
    // A single comparison, because it is unpredictable which limit ends the turn.
    return at <= std::min(run_limit(partition, inner, end) - 1, WakeupTable::min_of(others));
  }
};

/// Times up to which the partitions of a machine may run one after the other when all have reached the same time.
struct RunLimits {
  Time lead;  ///< limit of the inner partition, which runs first
  Time end;   ///< limit of all partitions; no partition may run beyond it
};

/// All partitions of a machine: the inner one and the outer ones.
struct Partitions {
  std::vector<Partition> outer;
  Partition inner;
};

}  // namespace sim
