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

/// All kernels as a machine's shader cores run them, by KernelId.
struct ScheduledKernels {
  std::vector<KernelSchedule> kernels;
  std::vector<BankConflicts> conflicts;
};
ScheduledKernels schedule_kernels(const GpuConfig& config);

/// Displacements that no architect would notice, but that make a frame another draw of the races in it: cores start
/// some cycles apart, the memory's fabric is a cycle of its command clock longer or shorter, refreshes come at another
/// phase. After Alameldeen and Wood, "Variability in Architectural Simulations of Multi-threaded Workloads", HPCA 2003
/// (docs/noise.md). None by default.
struct Perturbation {
  std::vector<std::uint32_t> starts;  ///< cycles of the tile dispatcher before a core gets its first tile; empty: none
  DramPerturbation dram;
};

/// Draws the perturbation of a replicate of a frame; replicate 0 has none.
Perturbation draw_perturbation(std::uint32_t cores, std::uint32_t frame, std::uint32_t replicate);

/// The machine: cores and what they share.
///
///   tile dispatcher --> core x n: SRP <--direct interface--> T&I unit        core ports       L2 banks    channels
///                        |  tile buffer --> DMA -------------------------------------------------------> LPDDR
///                        +-- L1s of TRVs and IST, data cache --------------> arbiter -------> L2 -------->
///
/// Frames that need it have a rasteriser in each core, beside the T&I unit and another client of the core's port.
///
/// Without the direct interface, rays and hits pass a memory interface, which is a client of the core's port, too.
class Gpu {
 public:
  /// Facts of the workload that the machine needs beside the stream itself.
  struct Workload {
    const traces::MemoryImage& image;
    std::span<const std::uint32_t> parents;  ///< the parent of each node of the tree
    traces::FrameRequirements needs{.tile_samples = 256};
    bool dma_encodes = false;  ///< the DMA sRGB-encodes finished pixels
    Observer* observer = nullptr;
    /// Kernels of a machine with the same shader cores; null: scheduled anew.
    std::shared_ptr<const ScheduledKernels> scheduled{};
  };

  Gpu(const GpuConfig& config, const Workload& workload, TileSource& tiles, const Perturbation& perturbation = {});
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  // As the engine sees it (sim/engine.h).
  sim::Machine& machine() { return machine_; }
  bool done() const { return stopped_ || (dispatcher_->done() && machine_.quiet()); }
  sim::Reach reach(sim::Time now) const;
  sim::Time patience() const { return patience_; }

  /// Charges every unit's time up to the end of the run. Call once, with what the engine returned.
  void finish(sim::Time last_edge);
  /// The time finish() was given, rounded up to whole T&I cycles.
  sim::Time elapsed() const { return elapsed_; }
  std::uint64_t cycles() const { return tni_clock_.cycles(elapsed_); }

  /// Brings all counters up to a time at which a tile is dispatched, while the machine runs.
  void bring_up_to(sim::Time now) { machine_.bring_up_to(now); }
  /// Leaves the rest undone, when a tile is dispatched behind which there are none: the run ends, and is not finished.
  void stop() { stopped_ = true; }
  bool stopped() const { return stopped_; }

  /// T&I cycles up to the last time at which the tile dispatcher had something to do, while the machine runs.
  std::uint64_t cycles_so_far() const { return tni_clock_.cycles(dispatcher_->activity().accounted()); }

  /// Every unit's counters, in a fixed order.
  std::vector<sim::UnitReport> report() const { return machine_.report(); }
  /// Per kernel, summed over the cores, by KernelId.
  std::vector<KernelUse> kernel_use() const;
  const std::vector<KernelSchedule>& kernels() const { return scheduled_->kernels; }
  const std::shared_ptr<const ScheduledKernels>& scheduled() const { return scheduled_; }
  std::uint32_t cores() const { return static_cast<std::uint32_t>(cores_.size()); }

  /// Puts what a tile reads into the caches of a core, and into the L2 what these do not hold, as if the tile had just
  /// been run: in no time, and uncounted.
  void warm(const traces::TileWork& work, std::uint32_t core);

 private:
  struct Core {
    sim::UnitId srp_id;
    TniCore tni;
    sim::Link<TileJob>& tiles_in;
    sim::Link<TileDone>& tiles_out;
    Srp* srp = nullptr;
    Dma* dma = nullptr;
  };
  /// A direct interface, or its halves between each end and the memory interface.
  struct Interface {
    sim::Link<RayJob>&rays_from_srp, &rays_to_tni;
    sim::Link<RayDone>&hits_from_tni, &hits_to_srp;
  };

  /// A rasteriser, and its wires to the core and to memory.
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
