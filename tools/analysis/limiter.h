#pragma once
#include <span>
#include <string>
#include <vector>

#include "sim/unit_report.h"
#include "tools/analysis/top_down.h"

namespace tools {

/// Shares of time, 0 to 1.
struct Utilisation {
  double tni = 0;   ///< cycles in which a traversal unit put a node into its box pipe, over all of them
  double srp = 0;   ///< cycles in which a kernel ran on an array or was switched in
  double dram = 0;  ///< cycles in which data were on a channel's bus
};
Utilisation utilisation(std::span<const sim::UnitReport> units);

/// Speed-up that making a resource ideal would bring, as far as one run's counters tell.
struct Estimate {
  std::string resource;  ///< as in hw::IdealConfig
  double speedup = 1;
};

/// Estimates the speed-up by each resource from the counters of one run.
///
/// A core is three stages that work side by side: the shader core (kernels, and stalls for its data cache), the T&I
/// unit (rays inside) and the DMA with ray slots that do not fit. With the times S, F and D of each alone and T of all
/// together, p solves S^p + F^p + D^p = T^p (1: one after the other; large: the longest hides the others).
/// 1. An ideal resource shortens a stage by what that resource is charged with; p stays.
/// 2. A queue is charged to what it waits for: in front of an L2 without a free MSHR it is charged to memory, too.
/// 3. What is still needed sets the least time of the frame: data buses, MSHRs, wires, tests.
/// 4. Time without a tile shrinks with the time of tiles.
/// Not modelled: other hit rates or another deal of tiles in the faster machine.
std::vector<Estimate> estimate(const CoreTime& time);

/// The resource that would be worth most if it were ideal.
const Estimate& most(const std::vector<Estimate>& estimates);

/// The resource that limits the frame, in a line of words.
std::string limiter(std::vector<Estimate> estimates);

}  // namespace tools
