#pragma once
#include <string>

#include "hw_models/srp/schedule.h"

namespace hw::test {

/// Plays items through a schedule, one after the other, on an array that notes who uses what and when each value is
/// there; shares nothing with the scheduler but the latencies. Returns what is wrong, or nothing.
std::string wrong_with(const KernelSchedule& schedule, const kernels::Graph& graph, const SrpConfig& config);

}  // namespace hw::test
