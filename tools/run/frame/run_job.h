#pragma once
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hw_models/memory/tile_accounting.h"
#include "hw_models/srp/schedule.h"
#include "hw_models/srp/srp_stats.h"
#include "shader_kernels/programs/adaptive/rate_map.h"
#include "shader_kernels/programs/program_spec.h"
#include "sim/intervals.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"
#include "tools/host/progress.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/load_config.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/info.h"
#include "traces/scene/scene.h"

namespace hw {
class Observer;
}
namespace traces {
class TraceWriter;
}

namespace tools {

class RunWatcher;

/// Everything a run reads, read, as it is in one frame.
struct Inputs {
  RunConfig config;
  traces::SceneInfo scene;
  std::string scene_sha256, bvh_hash;  ///< the tree's: of the first frame
  std::vector<std::string> warnings;
  std::uint32_t frame = 0;
  float scene_size = 1;  ///< longest side of the scene's bounds in frame 0
  traces::Camera camera;
  traces::MemoryImage image;
  std::uint64_t stored_triangles = 0;  ///< in the image: each that is shared once
  std::vector<std::uint32_t> parents;  ///< the parent of each node of the tree
  double load_seconds = 0;
  double update_seconds = 0;  ///< host: posing the scene and bringing the image up to date, later frames
  traces::Scene moving;       ///< what later frames are posed from; empty if there are none
  std::uint32_t frames() const { return config.scene.last_frame - config.scene.first_frame + 1; }
};

/// Reads scene and configuration and builds the tree of the first frame. InputError, or Interrupted.
Inputs load_inputs(const JobOptions& options, Progress* progress = nullptr);
Inputs load_inputs(const RunConfig& config, std::uint32_t threads, Progress* progress = nullptr);
/// Says warnings on standard error, above the bar if there is one. Without `progress` nobody is told.
void tell_warnings(const std::vector<std::string>& lines, Progress* progress);
/// Keys on which load_inputs() depends, with their values: equal texts, equal inputs.
std::string inputs_key(const RunConfig& config);
/// Goes to the next frame: poses the scene, then refits or rebuilds the tree if anything in it has moved. False after
/// the last frame. Interrupted if an interrupt waits.
bool advance(Inputs& inputs, std::uint32_t threads, Progress* progress = nullptr);
/// Calls `call()` for each frame from the present one on, with the inputs as they are in it.
void for_each_frame(Inputs& inputs, std::uint32_t threads, Progress* progress, auto&& call) {
  do {
    call();
  } while (advance(inputs, threads, progress));
}

/// An estimate and its 95 % interval.
struct Interval {
  double estimate = 0;
  double chance = 0;  ///< half of what the interval would be if only chance were at work
  double method = 0;  ///< likewise what the method is off, whichever parts are drawn
  double half_width() const { return std::hypot(chance, method); }
  /// Adds another interval: chance evens out, the method's error does not.
  void add(const Interval& other);
};

/// Tile sampling of a frame, or of several (tile_sampling.h).
struct SampledFrame {
  std::uint64_t tiles = 0, timed = 0, measured = 0, warmed = 0, blocks = 0, rounds = 0;
  double asked = 0;  ///< share of the frame's work that was to be measured; 0: as much as it takes
  Interval cycles, energy_pj;
  std::map<std::string, Interval> counters;       ///< sums over like units, by path; none if all tiles were timed
  double pilot_seconds = 0, warming_seconds = 0;  ///< host
  void add(const SampledFrame& other);
};

/// Slices of a frame, or of several that were cut alike (slices.h).
struct SlicedFrame {
  std::uint32_t slices = 1;
  std::uint64_t tiles = 0, again = 0, warmed = 0;  ///< all; those that fill a machine, or warm its caches
  Interval cycles, energy_pj;
  std::vector<double> seconds;  ///< host: processor time of each slice's thread
  double timing_seconds = 0;    ///< host: of all of them, without making tiles
  void add(const SlicedFrame& other);
};

/// A frame on the machine, or several added up.
struct FrameResult {
  kernels::ProgramSpec program;
  MachineConfig machine;
  std::uint32_t frames = 1;
  FrontEnd::Result function;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernel_use;
  std::vector<hw::KernelSchedule> kernels;
  sim::EnergyReport energy;
  std::uint64_t cycles = 0;  ///< cycles of the T&I clock
  sim::Time elapsed = 0;
  double wall_seconds = 0;  ///< host, functional and timing together
  std::uint32_t tiles = 0,
                finished_tiles = 0;  ///< tiles of the last frame; all are finished, but for SimulateOptions::keep_part
  std::optional<SampledFrame> sampled;         ///< if most of this is estimated
  std::optional<SlicedFrame> sliced;           ///< if it was to be cut into slices
  std::vector<FrameResult> replicates;         ///< the same work, perturbed; without pictures
  double replicate_seconds = 0;                ///< host, for these
  std::vector<hw::TileAccount> tile_accounts;  ///< with SimulateOptions::itemised: of each entry of the tile list
  hw::TileAccount rest;                        ///< likewise: what no tile has asked for
  std::uint64_t rays() const;
  bool is_part() const { return finished_tiles < tiles; }
  /// Adds a later frame's figures; the picture stays.
  void add(const FrameResult& frame);
};

/// Render settings of what a run of `render` is compared with: effects are at the full rate.
kernels::RenderConfig reference_render(kernels::RenderConfig render);

/// Tiles that the picture is cut into, for the frame that `inputs` stand at.
kernels::TileCounts tile_counts(const Inputs& inputs, const kernels::ProgramSpec& program);

/// Options that go with a frame program.
struct SimulateOptions {
  kernels::RateMap* rates = nullptr;  ///< rates of its tiles, if they go on from frame to frame
  bool marks = false;                 ///< how all samples came about is kept, for pictures
  bool keep_part = false;             ///< an interrupt leaves the finished tiles, if there are any
  Progress* progress = nullptr;
  traces::TraceWriter* trace = nullptr;  ///< gets the frame's work, if somebody wants it
  bool reference = false;  ///< this is what others are compared with: a part of the trace, by reference_render()
  sim::Intervals* intervals = nullptr;    ///< gets what the machine did over time, if somebody wants it
  RunWatcher* watcher = nullptr;          ///< looks at the frame while it is played
  std::uint32_t replicates = 1;           ///< plays of the work, of which the first is not perturbed
  const char* kept_for = "--replicates";  ///< option or verb that wants them, for who runs out of memory
  bool itemised = false;                  ///< what each tile and pixel took is kept
  hw::Observer* observer = nullptr;       ///< of the machine
};

/// Runs a frame program on the machine.
/// `threads` of the host: one plays the machine, the others run ahead of it. sim::Deadlock if the machine is stuck,
/// Interrupted if an interrupt waits and nothing is kept. Every frame begins with cold caches. What is kept of a run
/// that was interrupted has no replicates.
FrameResult simulate(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                     const SimulateOptions& extras = {});

/// Records a frame once and plays it on the machine of each configuration, as many at once as there are threads. The
/// configurations may differ from that of `inputs` in what does not change the work. Results in their order, without
/// pictures. sim::InputError, which names `kept_for`, where the work takes too much memory; sim::Deadlock, Interrupted.
std::vector<FrameResult> simulate_on(const Inputs& inputs, const kernels::ProgramSpec& program,
                                     std::span<const RunConfig> configs, const char* kept_for, std::uint32_t threads,
                                     Progress* progress = nullptr);

/// Plays what a frame program makes with `tracer` on the machine that `inputs` name; the last half of simulate().
FrameResult play(const Inputs& inputs, const kernels::ProgramSpec& program, kernels::FrameProgram& frame,
                 const traces::Tracer& tracer, std::uint32_t threads, const SimulateOptions& extras = {});

/// The picture alone, traced by `tracer`, and if a trace is wanted the work.
FrontEnd::Result render(const Inputs& inputs, const kernels::ProgramSpec& program, const traces::Tracer& tracer,
                        std::uint32_t threads, const SimulateOptions& extras = {});

/// 0 means all the host has.
std::uint32_t host_threads(std::uint32_t wanted);

}  // namespace tools
