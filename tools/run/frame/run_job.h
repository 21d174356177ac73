#pragma once
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
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
#include "tools/run/frame/sustained.h"
#include "traces/accel/memory_image.h"
#include "traces/accel/tree_builds.h"
#include "traces/scene/info.h"
#include "traces/scene/scene.h"

namespace hw {
class Observer;
struct CacheContents;
}  // namespace hw
namespace traces {
class TraceWriter;
}

namespace tools {

/// All inputs of a run, in the state of the current frame.
struct Inputs {
  RunConfig config;
  traces::SceneInfo scene;
  std::string scene_sha256, bvh_hash;  ///< hash of the scene file; hash of the BVH of the first frame
  std::vector<std::string> warnings;
  std::uint32_t frame = 0;
  float scene_size = 1;  ///< longest side of the scene's bounding box in frame 0
  traces::Camera camera;
  traces::MemoryImage image;
  std::uint64_t stored_triangles = 0;  ///< triangles in the memory image; triangles that instances share count once
  std::vector<std::uint32_t> parents;  ///< parent of each node of the tree
  traces::TreeBuilds builds;           ///< trees that the machine builds for this frame; empty if nothing moved
  /// SAH cost of each tree after its last build, and now (traces::tree_costs()); empty unless the machine builds trees
  /// or build.policy is cost.
  std::vector<double> built_costs, costs;
  bool refitted = false;  ///< the last update has refitted the tree
  double load_seconds = 0;
  double update_seconds = 0;  ///< host time to pose the scene and update the image for later frames
  traces::Scene moving;       ///< scene for later frames; empty if there are none
  std::uint32_t frames() const { return config.scene.last_frame - config.scene.first_frame + 1; }
};

/// Loads scene and configuration and builds the BVH of the first frame. Throws InputError or Interrupted.
Inputs load_inputs(const JobOptions& options, Progress* progress = nullptr);
Inputs load_inputs(const RunConfig& config, std::uint32_t threads, Progress* progress = nullptr);
/// Prints warnings to stderr, above a progress bar. No effect if `progress` is null.
void print_warnings(const std::vector<std::string>& lines, Progress* progress);
/// Returns a text of all keys and values on which the result of load_inputs() depends. Equal texts mean equal inputs.
std::string inputs_text(const RunConfig& config);
/// Moves camera, lights and geometry of the scene to frame `frame`. True if geometry moved, which the tree lacks until
/// update_tree().
bool pose_frame(Inputs& inputs, std::uint32_t frame);
/// Refits or rebuilds the tree for the geometry of the current frame. Throws Interrupted.
void update_tree(Inputs& inputs, std::uint32_t threads, Progress* progress = nullptr);
/// Poses the scene for frame `frame` of the sequence, then refits or rebuilds the tree if geometry moved. The machine
/// builds trees for the movement since frame `frame` - 1. Throws Interrupted.
void go_to_frame(Inputs& inputs, std::uint32_t frame, std::uint32_t threads, Progress* progress = nullptr);
/// Advances to the next frame: poses the scene, then refits or rebuilds the tree if geometry moved. False after the
/// last frame. Throws Interrupted if an interrupt is pending.
bool advance_frame(Inputs& inputs, std::uint32_t threads, Progress* progress = nullptr);
/// Calls `call()` for each frame, starting with the current one.
void for_each_frame(Inputs& inputs, std::uint32_t threads, Progress* progress, auto&& call) {
  do {
    call();
  } while (advance_frame(inputs, threads, progress));
}

/// An estimated value with its 95 % interval.
struct Interval {
  double estimate = 0;
  double random = 0;      ///< half-width of the random error
  double systematic = 0;  ///< half-width of the systematic error of the method
  double half_width() const { return std::hypot(random, systematic); }
  /// Adds the interval of another estimate: random errors add in quadrature, systematic errors linearly.
  void add_estimate(const Interval& other);
};

/// Statistics and estimates of one or several frames simulated with tile sampling (tile_sampling.h).
struct SampledFrame {
  std::uint64_t tiles = 0, timed = 0, measured = 0, warmed = 0, blocks = 0, rounds = 0;
  double asked = 0;  ///< requested share of the frame's work; 0: automatic
  Interval cycles, energy_pj;
  /// Counters summed over units of the same kind, by path; empty if all tiles were simulated.
  std::map<std::string, Interval> counters;
  double pilot_seconds = 0, warming_seconds = 0;  ///< host seconds of the pilot render and of warming caches
  void add(const SampledFrame& other);
};

/// Statistics and estimates of one or several frames simulated in slices (slices.h), all with the same number of
/// slices.
struct SlicedFrame {
  std::uint32_t slices = 1;
  /// Number of tiles of the frame, of tiles simulated again to fill a slice's machine, and of tiles that only warm
  /// caches.
  std::uint64_t tiles = 0, again = 0, warmed = 0;
  Interval cycles, energy_pj;
  std::vector<double> seconds;  ///< host CPU seconds of each slice's thread
  double timing_seconds = 0;    ///< host CPU seconds of all slices, without the execution of tiles
  void add(const SlicedFrame& other);
};

/// Statistics of a sequence, and totals estimated from its simulated frames (docs/sequences.md).
struct RepresentedFrames {
  std::uint32_t frames = 0, simulated = 0, rounds = 0;
  std::uint32_t asked = 0;                   ///< requested number of clusters; 0: automatic
  std::uint64_t draw = 1;                    ///< seed of clusters and of the choice of frames
  std::uint32_t first = 0;                   ///< number of the sequence's first frame
  std::vector<std::uint32_t> cluster_of;     ///< cluster of each frame of the sequence
  std::vector<std::uint32_t> cluster_sizes;  ///< number of frames of each cluster
  Interval cycles, energy_pj;
  std::map<std::string, Interval> counters;  ///< counters summed over units of the same kind, by path
  double counting_seconds = 0;               ///< host seconds of counting the work of all frames
};

/// Cost of the denoiser of one or several frames: of its passes after the frame's tiles, or of an external unit. The
/// costs of an external unit are in addition to those of the frame.
struct DenoiseCost {
  bool is_external = false;
  sim::Time time = 0;
  std::uint64_t dram_bytes = 0;
  double energy_pj = 0;
};

/// The tree of a frame of a moving scene.
struct MovedTree {
  bool refitted = false;  ///< the last update has refitted the tree, not rebuilt it
  double sah_cost = 0;
  double sah_growth = 1;  ///< factor by which the cost has grown since the last build
};

/// Results of one or several frames on the machine.
struct FrameResult {
  kernels::ProgramSpec program;
  MachineConfig machine;
  std::uint32_t frames = 1;
  RenderResult rendered;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernel_use;
  std::vector<hw::KernelSchedule> kernels;
  sim::EnergyReport energy;
  std::uint64_t cycles = 0;  ///< T&I clock cycles
  sim::Time elapsed = 0;
  double wall_seconds = 0;  ///< host time of rendering and simulation together
  /// Tiles of the last frame, and how many of them are finished: all, unless SimulateOptions::keep_part kept an
  /// interrupted frame.
  std::uint32_t tiles = 0, finished_tiles = 0;
  std::optional<SampledFrame> sampled;           ///< set if the results are estimated from sampled tiles
  std::optional<RepresentedFrames> represented;  ///< set if the results are estimated from some frames of a sequence
  std::optional<SlicedFrame> sliced;             ///< set if slices were requested
  std::optional<MovedTree> tree;                 ///< of the first frame; set if the frame's Inputs have its costs
  std::optional<DenoiseCost> denoise;            ///< set if a denoiser was configured
  std::vector<FrameResult> replicates;           ///< results of perturbed machines, without pictures
  std::vector<SustainStep> sustained;  ///< the same work at each of the governor's clocks, if thermal.minutes is set
  double replicate_seconds = 0;        ///< host time of the replicates
  std::vector<hw::TileAccount> tile_accounts;       ///< activity of each entry of the tile list, if costs are itemised
  std::shared_ptr<const hw::CacheContents> caches;  ///< cache contents after a whole frame, with frame.start warm
  hw::TileAccount rest;                             ///< activity that no tile requested, if costs are itemised
  std::uint64_t rays() const;
  double time_ms() const;
  double energy_mj() const;
  bool is_partial() const { return finished_tiles < tiles; }
  /// Adds the results of a later frame. The picture remains that of the first frame.
  void add(const FrameResult& frame);
};

/// Returns the render settings of a run's reference program, where all effects are rendered at the full rate.
kernels::RenderConfig reference_render(kernels::RenderConfig render);
/// Returns the keys of a run's reference program, which is not denoised.
kernels::ProgramConfig reference_programs(kernels::ProgramConfig programs);

/// Returns the number of tiles per row and column of the current frame.
kernels::TileGridSize tile_grid_size(const Inputs& inputs, const kernels::ProgramSpec& program);

/// A frame before the first cycle of its machine.
struct StartedFrame {
  const FrontEnd& front_end;
  std::vector<sim::UnitReport> units;  ///< the machine's units
  const sim::Intervals* intervals;     ///< receives the machine's counters over time; null: not recorded
};

/// Options of simulate_frame() and render_frame(): observers, recorded data and start state.
struct SimulateOptions {
  kernels::RateMap* rates = nullptr;  ///< sampling rates of tiles, carried from frame to frame; null: none
  /// History of the denoiser, carried from frame to frame; null: none.
  std::shared_ptr<const kernels::DenoiseHistory>* history = nullptr;
  bool marks = false;      ///< keep a mark of how each sample was made, for debug pictures
  bool keep_part = false;  ///< an interrupt keeps the finished tiles of the frame, if any
  Progress* progress = nullptr;
  traces::TraceWriter* trace = nullptr;  ///< trace file that receives the frame's work; null: none
  bool reference = false;  ///< the program is the reference: own section of the trace, settings of reference_render()
  sim::Intervals* intervals = nullptr;  ///< receives the machine's counters over time; null: not recorded
  std::function<void(const StartedFrame&)> on_start{};  ///< called before the machine's first cycle; may be empty
  std::uint32_t replicates = 1;                         ///< number of simulations; all but the first are perturbed
  const char* requested_by = "--replicates";            ///< option or verb to name if memory runs out
  bool itemised = false;                                ///< keep the costs of each tile and pixel
  hw::Observer* observer = nullptr;                     ///< observer of the machine; null: none
  std::shared_ptr<const hw::CacheContents> caches{};  ///< cache contents after the previous frame, for frame.start warm
  /// Used only if `caches` is null: program whose last tiles warm the caches. Null for the simulated program itself.
  kernels::FrameProgram* previous = nullptr;
};

/// Renders a frame and simulates it on the machine. One host thread simulates; the others render ahead.
/// Caches are empty at the start of the frame. With frame.start warm they contain what the previous frame left
/// (`extras.caches`), or what the last tiles of this frame leave.
/// An interrupted run that keeps a part has no replicates. Throws sim::Deadlock, and Interrupted if nothing is kept.
FrameResult simulate_frame(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                           const SimulateOptions& extras = {});

/// The recorded work of the current frame, for several machines.
class RecordedFrame {
 public:
  /// Renders the frame. `inputs` must outlive the object. Throws Interrupted, and InputError with the name
  /// `requested_by` if memory runs out.
  RecordedFrame(const Inputs& inputs, const kernels::ProgramSpec& program, const char* requested_by,
                std::uint32_t threads, Progress* progress = nullptr);
  ~RecordedFrame();
  RecordedFrame(const RecordedFrame&) = delete;
  RecordedFrame& operator=(const RecordedFrame&) = delete;

  /// Simulates the frame on the machine of each configuration, `threads` at a time. The configurations may differ from
  /// `inputs` only in keys that do not change the work. Returns results in the order of `configs`, without pictures.
  /// Throws sim::Deadlock, Interrupted.
  std::vector<FrameResult> simulate(std::span<const RunConfig> configs) const;

 private:
  struct Work;
  const Inputs& inputs_;
  const std::uint32_t threads_;
  Progress* const progress_;
  std::unique_ptr<Work> work_;
};

/// Simulates the tiles of a prepared frame program. simulate_frame() calls it after it has made the program and the
/// tracer.
FrameResult simulate_program(const Inputs& inputs, const kernels::ProgramSpec& program, kernels::FrameProgram& frame,
                             const traces::Tracer& tracer, std::uint32_t threads, const SimulateOptions& extras = {});

/// Renders a frame without a machine, and writes its work to the trace, if any.
RenderResult render_frame(const Inputs& inputs, const kernels::ProgramSpec& program, const traces::Tracer& tracer,
                          std::uint32_t threads, const SimulateOptions& extras = {});

/// Returns `wanted`, or the number of hardware threads of the host if `wanted` is 0.
std::uint32_t host_threads(std::uint32_t wanted);

}  // namespace tools
