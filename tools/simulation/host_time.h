#pragma once
#include <cstdint>
#include <string_view>

#include "shader_kernels/programs/program_spec.h"
#include "tools/host/progress.h"
#include "tools/simulation/run_job.h"

namespace tools {

/// Seconds of the host that a machine may take for so many traversal steps: right within a factor of some.
double host_seconds(double steps);

/// Seconds for the present frame, from a few rays all over the picture.
double estimated_host_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec);

/// Seconds to record that frame on so many threads, without a machine.
double estimated_recording_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec, std::uint32_t threads);

/// Says so before work that takes minutes; `less` tells how it takes less, or is empty.
void tell_long(double seconds, std::string_view less, Progress& progress);

}  // namespace tools
