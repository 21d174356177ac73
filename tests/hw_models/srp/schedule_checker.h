#pragma once
#include <string>

#include "hw_models/srp/schedule.h"

namespace hw::test {

/// Returns the first error in a kernel schedule; empty if it is valid. The checker executes loop items and tracks units
/// and times of values. The scheduler and the checker share only the latencies.
std::string first_schedule_error(const KernelSchedule& schedule, const kernels::Graph& graph, const SrpConfig& config);

}  // namespace hw::test
