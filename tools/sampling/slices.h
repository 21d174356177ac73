#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hw_models/machines/gpu.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "sim/io/json.h"
#include "tools/host/process.h"
#include "tools/host/progress.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/run_job.h"
#include "tools/sampling/timed_tiles.h"

namespace tools {

/// Time and counters of a machine between two points in time.
struct MachineSpan {
  sim::Time time = 0;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernels;

  MachineSpan() = default;
  explicit MachineSpan(const hw::Gpu& gpu)
      : time(gpu.elapsed_time()), units(gpu.unit_reports()), kernels(gpu.kernel_use()) {}
  explicit MachineSpan(const Mark& mark) : time(mark.time), units(mark.units), kernels(mark.kernels) {}
  void subtract_mark(const Mark& earlier);
  void add(const MachineSpan& other);
};

/// Time and energy that one machine has measured for probe tiles. The machines of two neighbouring slices both simulate
/// these tiles.
struct Probe {
  double time = 0, energy_pj = 0;
};

/// Results of simulating one slice of a frame.
struct SliceResult {
  Slice slice;
  MachineSpan own;
  /// Measurements of the probe tiles at the end of the slice's lead (`before`) and at the end of the slice (`after`). 0
  /// at the start and end of the frame, where there is no neighbouring slice.
  Probe before, after;
  /// Host CPU time of the slice's thread: total, and without the execution of tiles.
  double seconds = 0, timing_seconds = 0;
};

/// Results of one slice that was simulated in a process of its own.
struct SlicePart {
  SliceResult played;
  RenderResult rendered;
  double wall_seconds = 0;  ///< elapsed host time
};

/// Serialises the results of a slice without loss, for join_slices(). Names of units and the structure of the machine
/// are left out.
sim::Json slice_json(const SlicePart& part);

/// Parses the results of a slice. `initial_state`: reports of the same machine before its first cycle, from which the
/// names of units are copied. Throws InputError if the JSON does not match the machine.
SlicePart read_slice(const sim::Json& json, MachineSpan initial_state);

/// Special number of slices: the number is chosen automatically, from the frame and the machine.
inline constexpr std::uint32_t kAutoSlices = 0;

/// Parses the number of slices: "8", or "auto" for kAutoSlices; throws InputError for other texts.
std::uint32_t parse_slices(const std::string& text);

/// Throws InputError for a program whose frames cannot be split.
void check_slices(const kernels::ProgramSpec& program);

/// Returns the number of slices of a frame. With kAutoSlices the number depends only on frame and machine. Throws
/// InputError if the frame cannot be split into `requested` slices.
std::uint32_t slice_count(const RunConfig& config, const kernels::ProgramSpec& program, std::uint32_t requested);

/// Simulates a frame like simulate_frame(), but split into slices, each on a machine of its own, `threads` at a time
/// (docs/slices.md). The result does not depend on `threads`.
FrameResult simulate_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                            std::uint32_t slices, Progress* progress = nullptr);

/// Simulates slice `index` (from 0) of `slices` alone. Returns its results for join_slices().
sim::Json simulate_slice(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                         std::uint32_t slices, std::uint32_t index);
/// Joins the results of all slices of a frame, first slice first. Returns the result of simulate_slices() without the
/// picture. Throws InputError if they are not the slices of this frame.
FrameResult join_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::span<const sim::Json> slices);

/// Describes a frame that was simulated as a whole as a frame with one slice.
SlicedFrame to_single_slice(const FrameResult& s);

}  // namespace tools
