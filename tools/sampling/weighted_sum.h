#pragma once
#include <span>
#include <vector>

#include "hw_models/srp/srp_stats.h"
#include "sim/unit_report.h"

namespace tools {

/// Activity of a machine in a part of its work: reports of its units, and use of its kernels.
struct Activity {
  std::span<const sim::UnitReport> units;
  std::span<const hw::KernelUse> kernels;
};

/// Replaces the counters and cycle reasons of `whole` by weighted sums over parts. Keeps elapsed times and counters of
/// the kind kPeak. Cycle reasons are scaled so that they add up to the unit's elapsed time. Sums below 0 become 0.
void set_weighted_units(std::vector<sim::UnitReport>& whole, std::span<const Activity> parts,
                        std::span<const double> weights);

/// Returns the weighted sums of the use of each kernel over parts.
std::vector<hw::KernelUse> weighted_kernels(std::span<const Activity> parts, std::span<const double> weights);

}  // namespace tools
