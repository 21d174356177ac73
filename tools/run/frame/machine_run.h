#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hw_models/machines/gpu.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "sim/unit_report.h"
#include "tools/run/frame/replay_program.h"
#include "tools/run/frame/run_job.h"
#include "traces/accel/bvh_config.h"
#include "traces/ray.h"

namespace hw {
struct GpuConfig;
}

namespace tools {

/// Units that a machine has only if the frame needs them.
struct OptionalUnits {
  bool rasterisers = false, tree_builder = false;
};
OptionalUnits optional_units_of(const RunConfig& config);

/// Returns reports of all units of a machine before its first cycle: block, storage, cycle reasons, and counters with
/// their energy events. `bvh`: the trees for which its T&I units are built.
std::vector<sim::UnitReport> idle_unit_reports(const hw::GpuConfig& config, const OptionalUnits& units = {},
                                               const traces::BvhConfig& bvh = {});

/// Warms the caches of a machine, before its first cycle, with the last tiles of `frame`, as if it were the previous
/// frame. A frame of several passes is executed as a whole and must not have been executed before. `workers`: threads
/// in addition to the caller's. Throws Interrupted.
void warm_with_last_tiles(hw::Gpu& gpu, kernels::FrameProgram& frame, const traces::Tracer& tracer,
                          std::uint32_t workers);

/// Builds the machine that `inputs.config` describes.
std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                  hw::TileSource& tiles, const hw::Perturbation& perturbation = {},
                                  hw::Observer* observer = nullptr);
/// Builds a machine of another configuration for the work of `inputs`. `scheduled`: kernel schedules of a machine with
/// the same shader cores; null: computed.
std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const RunConfig& config,
                                  const kernels::FrameRequirements& requirements, hw::TileSource& tiles,
                                  const hw::Perturbation& perturbation = {}, hw::Observer* observer = nullptr,
                                  std::shared_ptr<const hw::ScheduledKernels> scheduled = nullptr);

/// Throws InputError if the machine's units and the tables of energy and area do not match.
void check_tables(const hw::Gpu& gpu, const RunConfig& config);

/// Runs the machine until all tiles are done or it is stopped. Throws sim::Deadlock if the machine is stuck.
void run_to_end(hw::Gpu& gpu);

/// Returns the energy that the machine has used so far.
sim::EnergyReport energy_of(const hw::Gpu& gpu, const RunConfig& config);

/// Returns the energy of units with these counts after the time `elapsed`.
sim::EnergyReport energy_of(std::span<const sim::UnitReport> units, sim::Time elapsed, const RunConfig& config);

/// Copies time, counters and energy of a finished machine into `s`.
void collect_results(const hw::Gpu& gpu, const RunConfig& config, FrameResult& s);

/// Configuration of a machine on which recorded work is simulated.
struct MachineVariant {
  RunConfig config;
  hw::Perturbation perturbation;
  std::shared_ptr<const hw::ScheduledKernels> scheduled{};  ///< kernel schedules of the shader cores; null: computed
  /// Contents of the machine's caches at the start; null: as frame.start of `config` states.
  std::shared_ptr<const hw::CacheContents> start{};
};

/// Simulates recorded work on several machines, `threads` at a time, and returns their results in the order of `plays`.
/// `plain`: a result from which everything that does not depend on the machine is copied. `what`: name of the work in
/// the progress display. An exception of one machine (sim::Deadlock, Interrupted) ends all.
std::vector<FrameResult> simulate_variants(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                           const InMemoryTrace& work, const FrameResult& plain,
                                           std::span<const MachineVariant> plays, const char* what,
                                           std::uint32_t threads, Progress* progress);

/// Result of the unperturbed simulation of a frame, and data that its replicates reuse.
struct UnperturbedRun {
  const FrameResult& result;
  std::shared_ptr<const hw::ScheduledKernels> scheduled;
  std::shared_ptr<const hw::CacheContents> start;  ///< lines in the machine's caches before its first cycle; null: none
};

/// Simulates recorded work on `count` machines that differ from `plain` only by perturbations 1 to `count`.
std::vector<FrameResult> simulate_replicates(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                             const InMemoryTrace& work, const UnperturbedRun& plain,
                                             std::uint32_t count, std::uint32_t threads, Progress* progress);

}  // namespace tools
