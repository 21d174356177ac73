#pragma once
#include "tests/hw_models/machines/gpu_harness.h"

namespace hw::test {

/// Does only those checks of expect_conserved() that hold for any workload.
void expect_machine_conserved(const Outcome& run, const GpuConfig& config);

/// Checks conservation in a finished run: all that entered a unit has left it, counters of senders and receivers agree,
/// and every cycle of every unit has a reason.
void expect_conserved(const Outcome& run, const Frame& frame, const GpuConfig& config);

}  // namespace hw::test
