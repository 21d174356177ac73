#pragma once
#include "tests/hw_models/machines/gpu_harness.h"

namespace hw::test {

/// The part of expect_conserved() that holds of the machine alone, whatever it played.
void expect_machine_conserved(const Outcome& run, const GpuConfig& config);

/// Expects that whatever went into a unit came out of it, that what one unit says it sent another says it got, and that
/// every cycle of every unit has a reason.
void expect_conserved(const Outcome& run, const Frame& frame, const GpuConfig& config);

}  // namespace hw::test
