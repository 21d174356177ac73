#pragma once
#include <cstdint>
#include <string_view>

#include "shader_kernels/programs/program_spec.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "tools/host/progress.h"
#include "tools/run/frame/run_job.h"
#include "traces/ray.h"

namespace tools {

/// Speed of the host, as CPU seconds per traversal step.
struct HostRate {
  double functional = 0;  ///< CPU seconds per step for tracing and shading
  double machine = 0;     ///< CPU seconds per step for simulating the machine
};
/// Typical speed of a host, used where none is measured.
inline constexpr HostRate kUsualRate{.functional = 12e-9, .machine = 100e-9};

/// Settings of a run that change its host time: threads, replicates and slices.
struct RunParallelism {
  std::uint32_t threads = 1;     ///< host threads; 0: all
  std::uint32_t replicates = 1;  ///< simulations of each frame
  std::uint32_t slices = 1;      ///< machines that simulate a frame concurrently
};

/// Estimates the traversal steps of the current frame from a picture of few pixels.
double estimate_steps(const Inputs& inputs, const kernels::ProgramSpec& spec);

/// Measures the speed of this host on a few tiles, spread over the current frame.
HostRate measure_rate(const Inputs& inputs, const kernels::ProgramSpec& spec);
/// Measures the speed of this host on a given frame program of one pass. Throws sim::Deadlock if the machine is stuck.
HostRate measure_rate(const Inputs& inputs, kernels::FrameProgram& program, const traces::Tracer& tracer);

/// True if this number of traversal steps may take minutes on a slow host, so that it is worth measuring the speed.
bool may_take_minutes(double steps, const RunParallelism& parallelism);

/// Returns the estimated host seconds to render and simulate a frame of this number of traversal steps.
double host_seconds_of_frame(double steps, const HostRate& rate, const RunParallelism& parallelism);

/// Estimates the host seconds to render and simulate the current frame. Measures the speed only if the frame may take
/// minutes.
double estimate_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec, const RunParallelism& parallelism);

/// Estimates the host seconds to render the current frame `times` times, without simulating a machine.
double estimate_render_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec, double times,
                               std::uint32_t threads);

/// Prints a hint if the work will take minutes. `less`: advice on how to shorten it, or empty.
void print_duration_hint(double seconds, std::string_view less, Progress& progress);

}  // namespace tools
