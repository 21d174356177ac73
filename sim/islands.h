#pragma once
#include <cstdint>
#include <vector>

#include "sim/wakes.h"

namespace sim {

/// Parts of a machine that meet others at links alone which take a while. So what one of them does at t cannot matter
/// to another before t + that while, and until then each can be run by itself: the host keeps what it works on at hand.
///
///   outer islands --links--> [ the inner island ] --links--> outer islands
///
/// Outer islands meet the inner one alone. They go first, as far as a horizon, the inner one follows. Where an outer
/// island cannot be sure of room in a link that leads inward, since the inner one may have popped meanwhile, it waits
/// for the inner one to come up to its own time. All this changes no result.
struct Island {
  Wakes::Groups units;            ///< their wake-up times, in groups of their own
  std::uint32_t nearly_full = 0;  ///< links that lead inward with room for one item at most
};

/// The islands of a machine.
struct Islands {
  std::vector<Island> outer;
  Island inner;
};

}  // namespace sim
