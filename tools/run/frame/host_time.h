#pragma once
#include <cstdint>
#include <string_view>

#include "shader_kernels/programs/program_spec.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "tools/host/progress.h"
#include "tools/run/frame/run_job.h"
#include "traces/ray.h"

namespace tools {

/// Host processor seconds per traversal step.
struct HostRate {
  double functional = 0;  ///< tracing and shading
  double machine = 0;     ///< simulating the machine
};
/// Typical rate, used where none is measured.
inline constexpr HostRate kUsualRate{.functional = 12e-9, .machine = 100e-9};

/// Threads, replicates and slices of a run.
struct RunParallelism {
  std::uint32_t threads = 1;     ///< host threads; 0: all
  std::uint32_t replicates = 1;  ///< simulations of each frame
  std::uint32_t slices = 1;      ///< machines that simulate a frame concurrently
};

/// Estimates the traversal steps of the current frame from a picture of few pixels.
double estimate_steps(const Inputs& inputs, const kernels::ProgramSpec& spec);

/// Measures the rate of this host on a few tiles, spread over the current frame.
HostRate measure_rate(const Inputs& inputs, const kernels::ProgramSpec& spec);
/// The same for a given program of one pass. sim::Deadlock if the machine is stuck.
HostRate measure_rate(const Inputs& inputs, kernels::FrameProgram& program, const traces::Tracer& tracer);

/// True if this number of traversal steps may take minutes on a slow host, so that measuring the rate pays off.
bool may_take_minutes(double steps, const RunParallelism& plays);

/// Returns the host seconds of a frame of this number of steps.
double frame_seconds(double steps, const HostRate& rate, const RunParallelism& plays);

/// Estimates the host seconds of the current frame. Measures the rate only if the frame may take minutes.
double estimate_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec, const RunParallelism& plays);

/// Estimates the host seconds to trace and shade the current frame `times` times, without a machine.
double estimate_render_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec, double times,
                               std::uint32_t threads);

/// Prints a hint before work that takes minutes; `less`: how to reduce it, or empty.
void print_duration_hint(double seconds, std::string_view less, Progress& progress);

}  // namespace tools
