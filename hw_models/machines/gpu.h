#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "hw_models/dram/dram_config.h"
#include "hw_models/frame/dma.h"
#include "hw_models/frame/memory_interface.h"
#include "hw_models/frame/tile_dispatcher.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/machines/memory_system.h"
#include "hw_models/memory/observer.h"
#include "hw_models/raster/raster_unit.h"
#include "hw_models/srp/bank_conflicts.h"
#include "hw_models/srp/schedule.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/tni_core.h"
#include "sim/machine.h"
#include "sim/unit_report.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// The schedules of all kernels for a machine's shader cores, by KernelId.
struct ScheduledKernels {
  std::vector<KernelSchedule> kernels;
  std::vector<BankConflicts> conflicts;
};
ScheduledKernels schedule_kernels(const GpuConfig& config);

/// Timing perturbation of a replicate, far below design significance (docs/noise.md). Cores start a few cycles later,
/// the memory's fabric is a command clock cycle longer or shorter, refreshes have another phase. After Alameldeen and
/// Wood, "Variability in Architectural Simulations of Multi-threaded Workloads", HPCA 2003. None by default.
struct Perturbation {
  std::vector<std::uint32_t> starts;  ///< for each core, the dispatcher's cycles before its first tile; empty: 0
  DramPerturbation dram;
};

/// Draws the perturbation of a replicate of a frame; replicate 0 has none.
Perturbation draw_perturbation(std::uint32_t cores, std::uint32_t frame, std::uint32_t replicate);

/// The whole machine: cores, shared memory side and tile dispatcher.
///
///   tile dispatcher --> core x n: SRP <--direct interface--> T&I unit        core ports       L2 banks    channels
///                        |  tile buffer --> DMA -------------------------------------------------------> LPDDR
///                        +-- L1s of TRVs and IST, data cache --------------> arbiter -------> L2 -------->
///
/// Frames that need one have a rasteriser in each core, which is another client of the core's port.
///
/// Without the direct interface, rays and hits go through a memory interface, also a client of the core's port.
class Gpu {
 public:
  /// Properties of the workload that the machine needs in addition to its tiles.
  struct Workload {
    const traces::MemoryImage& image;
    std::span<const std::uint32_t> parents;  ///< the parent of each node of the tree
    traces::FrameRequirements needs{.tile_samples = 256};
    bool dma_encodes = false;  ///< the DMA sRGB-encodes finished pixels
    Observer* observer = nullptr;
    /// Schedules from a machine with the same shader cores; null: the machine schedules the kernels.
    std::shared_ptr<const ScheduledKernels> scheduled{};
  };

  Gpu(const GpuConfig& config, const Workload& workload, TileSource& tiles, const Perturbation& perturbation = {});
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  // Interface for the engine (sim/engine.h).
  sim::Machine& machine() { return machine_; }
  bool done() const { return stopped_ || (dispatcher_->is_done() && machine_.is_drained()); }
  sim::RunLimits run_limits(sim::Time now) const;
  sim::Time patience() const { return patience_; }

  /// Charges every unit's time up to the end of the run. Called once, with the time that the engine returned.
  void finish(sim::Time last_edge);
  /// Returns the end of the run, rounded up to whole T&I cycles; after finish().
  sim::Time elapsed_time() const { return elapsed_; }
  std::uint64_t elapsed_cycles() const { return tni_clock_.cycles(elapsed_); }

  /// Brings all counters up to a time at which a tile is dispatched, while the machine runs.
  void account_until(sim::Time now) { machine_.account_until(now); }
  /// Ends the run early, when the last tile of the list is dispatched. The tiles in flight are not finished.
  void stop_early() { stopped_ = true; }
  bool is_stopped() const { return stopped_; }

  /// Returns the T&I cycles up to the last tick of the tile dispatcher, while the machine runs.
  std::uint64_t cycles_so_far() const { return tni_clock_.cycles(dispatcher_->activity().accounted_until()); }

  /// Returns the counters of all units, in a fixed order.
  std::vector<sim::UnitReport> unit_reports() const { return machine_.report(); }
  /// Returns the cost of each kernel, summed over the cores, by KernelId.
  std::vector<KernelUse> kernel_use() const;
  const std::vector<KernelSchedule>& kernel_schedules() const { return scheduled_->kernels; }
  const std::shared_ptr<const ScheduledKernels>& scheduled_kernels() const { return scheduled_; }
  std::uint32_t core_count() const { return static_cast<std::uint32_t>(cores_.size()); }

  /// Warms the caches of a core with the lines that a tile reads, and the L2 with the lines that these caches miss.
  /// Takes no time and counts nothing.
  void warm_caches(const traces::TileWork& work, std::uint32_t core);

 private:
  struct Core {
    sim::UnitId srp_id;
    TniCore tni;
    sim::Link<TileJob>& tiles_in;
    sim::Link<TileDone>& tiles_out;
    Srp* srp = nullptr;
    Dma* dma = nullptr;
  };
  /// The links of a direct interface, or those between each end and a memory interface.
  struct Interface {
    sim::Link<RayJob>&rays_from_srp, &rays_to_tni;
    sim::Link<RayDone>&hits_from_tni, &hits_to_srp;
  };

  /// A rasteriser's links to its core and to memory.
  struct RasterWires {
    sim::UnitId unit;
    sim::Link<RasterJob>& jobs;
    sim::Link<RasterDone>& done;
    MemoryPort memory;
  };

  Core& declare_core(std::uint32_t core);
  Interface link_interface(const Core& core, sim::UnitId between);
  RasterWires link_rasteriser(const Core& core, std::uint32_t number);
  void build_core(std::uint32_t core, const Workload& workload);
  Srp::Frame frame_of(const Workload& workload, std::uint32_t core) const;
  sim::Time last_tile_may_end(sim::Time now) const;

  const GpuConfig config_;
  const traces::Layout& layout_;
  const sim::Clock tni_clock_, srp_clock_, l2_clock_;
  const TilesInFlight in_flight_;
  const std::shared_ptr<const ScheduledKernels> scheduled_;
  sim::Time patience_ = sim::kNever;

  sim::Machine machine_;
  MemorySystem memory_;
  const sim::UnitId dispatcher_id_;
  std::deque<Core> cores_;
  TileDispatcher* dispatcher_ = nullptr;
  sim::Time elapsed_ = 0;
  bool stopped_ = false;
};

}  // namespace hw
