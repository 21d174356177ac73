#pragma once
#include <string>

#include "hw_models/srp/schedule.h"

namespace hw::test {

/// Runs items through a schedule on an array that tracks the use of units and the time of each value. Shares only the
/// latencies with the scheduler. Returns the first error, or an empty string.
std::string wrong_with(const KernelSchedule& schedule, const kernels::Graph& graph, const SrpConfig& config);

}  // namespace hw::test
