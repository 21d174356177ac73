#pragma once
#include <span>
#include <string>

#include "sim/report/unit_report.h"

namespace tools {

/// Shares of time, 0 to 1.
struct Utilisation {
  double tni = 0;   ///< cycles in which a traversal unit put a node into its box pipe, over all of them
  double srp = 0;   ///< cycles in which a kernel ran on an array or was switched in
  double dram = 0;  ///< cycles in which data were on a channel's bus
};
Utilisation utilisation(std::span<const sim::UnitReport> units);

/// What holds the frame back, in words: the kind of unit that is busiest, and what it loses most time to.
std::string limiter(std::span<const sim::UnitReport> units);

}  // namespace tools
