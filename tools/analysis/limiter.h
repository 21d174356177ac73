#pragma once
#include <span>
#include <string>
#include <vector>

#include "sim/unit_report.h"
#include "tools/analysis/top_down.h"

namespace tools {

/// Shares of time, 0 to 1.
struct Utilisation {
  double tni = 0;   ///< cycles in which a TRV issues a node to its box pipe, over all TRVs
  double srp = 0;   ///< cycles in which a kernel runs or is switched in
  double dram = 0;  ///< cycles with data on a channel's bus
};
Utilisation utilisation_of(std::span<const sim::UnitReport> units);

/// Estimated speed-up if a resource were ideal.
struct Estimate {
  std::string resource;  ///< as in hw::IdealConfig
  double speedup = 1;
};

/// Estimates the speed-up by each resource from the counters of one run.
///
/// A core is modelled as three concurrent stages: the shader core (kernels and data cache stalls), the T&I unit (rays
/// inside) and the DMA with spilled ray slots. With the stage times S, F and D and the total time T, the exponent p
/// solves S^p + F^p + D^p = T^p (1: sequential; large: the longest stage hides the others).
/// 1. An ideal resource shortens a stage by the time charged to that resource; p stays.
/// 2. A queue is charged to what it waits for: a queue before an L2 without a free MSHR is also charged to memory.
/// 3. Remaining work bounds the frame time from below: data buses, MSHRs, wires, tests.
/// 4. Time without a tile shrinks in proportion to tile times.
///
/// Not modelled: changes of hit rates and of the tile-to-core assignment.
std::vector<Estimate> estimate_speedups(const CoreTime& time);

/// Returns the resource with the largest speed-up.
const Estimate& largest_speedup(const std::vector<Estimate>& estimates);

/// Returns one line on the resource that limits the frame.
std::string limiter_text(std::vector<Estimate> estimates);

}  // namespace tools
