#pragma once
#include <cstdint>
#include <string_view>

#include "shader_kernels/programs/program_spec.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "tools/host/progress.h"
#include "tools/run/frame/run_job.h"
#include "traces/ray.h"

namespace tools {

/// Processor seconds of the host per traversal step of a frame.
struct HostRate {
  double functional = 0;  ///< to trace and shade it
  double machine = 0;     ///< to play it on the machine
};
/// Rate of a usual scene on a usual host, where none is measured.
inline constexpr HostRate kUsualRate{.functional = 12e-9, .machine = 100e-9};

/// Threads, replicates and slices of a run.
struct Plays {
  std::uint32_t threads = 1;     ///< of the host; 0: all it has
  std::uint32_t replicates = 1;  ///< plays of each frame
  std::uint32_t slices = 1;      ///< machines that play a frame side by side
};

/// Returns the traversal steps of the present frame, scaled up from a thin picture.
double estimated_steps(const Inputs& inputs, const kernels::ProgramSpec& spec);

/// Renders and plays a few tiles, spread over the present frame, and returns the rate of this host.
HostRate measured_rate(const Inputs& inputs, const kernels::ProgramSpec& spec);
/// The same for tiles of a program of one pass. sim::Deadlock if the machine is stuck.
HostRate measured_rate(const Inputs& inputs, kernels::FrameProgram& program, const traces::Tracer& tracer);

/// True if this number of traversal steps may take minutes on a slow host. Then measured_rate() is worth its time.
bool may_be_long(double steps, const Plays& plays);

/// Returns the seconds of a frame with this number of steps.
double frame_seconds(double steps, const HostRate& rate, const Plays& plays);

/// Returns the seconds of the present frame. The rate is measured only where the frame may take minutes.
double estimated_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec, const Plays& plays);

/// Returns the seconds to trace and shade the present frame `times` times, without a machine.
double estimated_functional_seconds(const Inputs& inputs, const kernels::ProgramSpec& spec, double times,
                                    std::uint32_t threads);

/// Prints a hint before work that takes minutes; `less` is a way to take less, or empty.
void tell_long(double seconds, std::string_view less, Progress& progress);

}  // namespace tools
