#pragma once
#include "shader_kernels/programs/program_spec.h"
#include "tools/simulation/run_job.h"

namespace tools {

/// Seconds of the host that simulating the present frame may take, from a few rays all over the picture: right within a
/// factor of some.
double estimated_host_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec);

}  // namespace tools
