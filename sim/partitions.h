#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "sim/wakes.h"

namespace sim {

/// How far a cluster goes in one go.
struct ClusterTurn {
  Time* wakes;                   ///< wake-up times of its units
  Time now;                      ///< the earliest of them
  Time until;                    ///< ticks that are due here or later are left
  std::span<const Time> others;  ///< earliest wake-up times of the partition's other units, by groups

  /// True if the turn goes on with what is due at `at`: it lies before `until`, and no other unit is due earlier.
  bool reaches(Time at) const {
    if (at >= until) return false;
    for (const Time& other : others) {
      if (other < at) return false;
    }
    return true;
  }
};

/// Units of one partition and one clock that their owner ticks himself, cycle after cycle: calls that the compiler
/// knows, and no look at all others between two cycles. It changes no result, as what other units do at a time is not
/// seen before the time after.
struct Cluster {
  Wakes::Groups units;  ///< in groups of their own, in the order in which they were named
  void* owner = nullptr;
  void (*run)(void* owner, const ClusterTurn& turn) = nullptr;
};

/// A partition: units whose links to other partitions all have a latency. An event at t can affect another partition
/// only after that latency, so each runs by itself up to that lookahead, and the host keeps its state at hand.
///
///   outer partitions --links--> [ the inner partition ] --links--> outer partitions
///
/// Outer partitions meet the inner one alone. They go first, as far as a lookahead, the inner one follows. Where an
/// outer partition cannot be sure of room in a link that leads inward, since the inner one may have popped meanwhile,
/// it waits for the inner one to come up to its own time, and all go on together until it can. All this changes no
/// result.
struct Partition {
  Wakes::Groups units;            ///< their wake-up times, in groups of their own; without the cluster's
  std::uint32_t nearly_full = 0;  ///< links that lead inward with room for one item at most
  Cluster cluster;
};

/// The partitions of a machine.
struct Partitions {
  std::vector<Partition> outer;
  Partition inner;
};

}  // namespace sim
