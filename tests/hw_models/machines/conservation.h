#pragma once
#include "tests/hw_models/machines/gpu_harness.h"

namespace hw::test {

/// The part of expect_conserved() that holds for any workload.
void expect_machine_conserved(const Outcome& run, const GpuConfig& config);

/// Expects that all inputs of a unit left it, that counts of senders and receivers agree, and that every cycle of every
/// unit has a reason.
void expect_conserved(const Outcome& run, const Frame& frame, const GpuConfig& config);

}  // namespace hw::test
