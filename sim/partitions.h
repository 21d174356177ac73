#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/wakes.h"

namespace sim {

struct ClusterTurn;

/// Units of one partition and one clock that their owner ticks himself, cycle after cycle: calls that the compiler
/// knows, and no look at all others between two cycles. It changes no result, as what other units do at a time is not
/// seen before the time after.
struct Cluster {
  Wakes::Groups units;  ///< in groups of their own, in the order in which they were named
  void* owner = nullptr;
  void (*run)(void* owner, const ClusterTurn& turn, Time now) = nullptr;
};

/// A partition: units whose links to other partitions all have a latency. An event at t can affect another partition
/// only after that latency, so each runs by itself up to that lookahead, and the host keeps its state at hand.
///
///   outer partitions --links--> [ the inner partition ] --links--> outer partitions
///
/// Outer partitions meet the inner one alone. It leads, as far as a lookahead, the outer ones follow. A pop is seen
/// before it comes, by the time that the slot is free again, but a partition whose links might be full cannot be sure
/// of room before the others have come up to its own time: it waits for them. All this changes no result.
struct Partition {
  Wakes::Groups units;            ///< their wake-up times, in groups of their own; without the cluster's
  std::uint32_t nearly_full = 0;  ///< links to others that a tick might fill up
  Cluster cluster;
};

/// How far a partition goes, if the others have done all that comes before `others` and it may go to `end`: no further
/// than it can be sure of room.
inline Time reach_of(const Partition& partition, Time others, Time end) {
  return std::min(end, partition.nearly_full == 0 ? end : others + 1);
}

/// How far a cluster goes in one go.
struct ClusterTurn {
  Time* wakes;               ///< wake-up times of its units, which it writes down
  std::span<Time> earliest;  ///< the earliest of each eight of them, which it writes down, too
  const Partition& partition;
  Time inner;                    ///< the inner partition has done all that comes before
  Time end;                      ///< ticks that are due here or later are left
  std::span<const Time> others;  ///< earliest wake-up times of the partition's other units, by groups

  /// True if the turn goes on with what is due at `at`: the partition reaches it, and no other unit is due earlier.
  bool reaches(Time at) const {
    // One comparison decides: which of them ends the turn no host foresees.
    Time over = reach_of(partition, inner, end) - 1;
    for (const Time& other : others) over = std::min(over, other);
    return at <= over;
  }
};

/// How far partitions that have all come to the same time may be run by themselves.
struct Reach {
  Time lead;  ///< the inner one before the others
  Time end;   ///< all
};

/// The partitions of a machine.
struct Partitions {
  std::vector<Partition> outer;
  Partition inner;
};

}  // namespace sim
