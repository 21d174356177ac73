#pragma once
#include <cstdint>
#include <vector>

#include "sim/wakes.h"

namespace sim {

/// A partition: units whose links to other partitions all have a latency. An event at t can affect another partition
/// only after that latency, so each runs by itself up to that lookahead, and the host keeps its state at hand.
///
///   outer partitions --links--> [ the inner partition ] --links--> outer partitions
///
/// Outer partitions meet the inner one alone. They go first, as far as a lookahead, the inner one follows. Where an
/// outer partition cannot be sure of room in a link that leads inward, since the inner one may have popped meanwhile,
/// it waits for the inner one to come up to its own time. All this changes no result.
struct Partition {
  Wakes::Groups units;            ///< their wake-up times, in groups of their own
  std::uint32_t nearly_full = 0;  ///< links that lead inward with room for one item at most
};

/// The partitions of a machine.
struct Partitions {
  std::vector<Partition> outer;
  Partition inner;
};

}  // namespace sim
