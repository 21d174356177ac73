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

/// An estimate for every resource, from the counters of one run.
///
/// A core is two stages that work side by side: the shader core (kernels, and stalls for its data cache) and the T&I
/// unit (rays inside). How well they overlap is taken from the run itself: with S and F the time of each alone and T
/// the time they took together, p solves S^p + F^p = T^p (1: one after the other; large: the longer one hides the
/// shorter). An ideal resource shortens S or F by what it was charged with, p stays, and memory that is still needed
/// sets a floor: the data buses, and the MSHRs, which are never all in use all the time.
std::vector<Estimate> estimate(const CoreTime& time);

/// The resource that would be worth most if it were ideal.
const Estimate& most(const std::vector<Estimate>& estimates);

/// The resource that limits the frame, in a line of words.
std::string limiter(std::vector<Estimate> estimates);

}  // namespace tools
