#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hw_models/build/tree_builder.h"
#include "hw_models/dram/dram_config.h"
#include "hw_models/frame/dma.h"
#include "hw_models/frame/memory_interface.h"
#include "hw_models/frame/tile_dispatcher.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/machines/memory_system.h"
#include "hw_models/memory/observer.h"
#include "hw_models/raster/raster_unit.h"
#include "hw_models/srp/schedule.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/tni_core.h"
#include "sim/machine.h"
#include "sim/unit_report.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// Schedules and tile buffer bank conflicts of all kernels, by KernelId, for the shader cores of one configuration.
struct ScheduledKernels {
  std::vector<KernelSchedule> kernels;
  std::vector<BankConflicts> conflicts;
};
ScheduledKernels schedule_kernels(const GpuConfig& config);

/// Small change of a GPU's timing, to measure how much results depend on chance (docs/noise.md). Cores start a few
/// cycles later, the DRAM fabric latency may differ by one cycle, refreshes are shifted in time. The default is no
/// change. Method: Alameldeen and Wood, "Variability in Architectural Simulations of Multi-threaded Workloads", HPCA
/// 2003.
struct Perturbation {
  std::vector<std::uint32_t> starts;  ///< cycles for which each core waits before its first tile; empty: 0
  DramPerturbation dram;
};

/// Returns the pseudo-random timing perturbation of one repetition of a frame. Repetition 0 is unperturbed.
Perturbation random_perturbation(std::uint32_t cores, std::uint32_t frame, std::uint32_t replicate);

/// Contents of all caches of a GPU between two frames.
struct CacheContents {
  std::vector<CacheTags> first_level;  ///< first-level caches, core by core: TRVs, IST, data cache, rasteriser
  std::vector<L2Store> l2;             ///< contents of each L2 bank of the GPU
  std::vector<L2Store> slc;            ///< contents of each slice of the system cache; lines may be dirty
};

/// The simulated GPU: cores, the memory system that they share, and the tile dispatcher.
///
///   tile dispatcher --> core x n: SRP <--direct interface--> T&I unit        core ports       L2 banks    channels
///                        |  tile buffer --> DMA -------------------------------------------------------> LPDDR
///                        +-- L1s of TRVs and IST, data cache --------------> arbiter -------> L2 -------->
///
/// 1. If the frame needs rasterisers, each core has one, which is another client of the core's port.
/// 2. If the frame has trees to build, there is one tree builder, a client of core 0's port.
/// 3. Without the direct interface, rays and hits go through a memory interface, also a client of the core's port.
class Gpu {
 public:
  /// Properties of a frame that a GPU needs in addition to the tiles.
  struct Workload {
    const traces::MemoryImage& image;
    std::span<const std::uint32_t> parents;  ///< parent node of each node of the BVH
    traces::FrameRequirements needs{.tile_samples = 256};
    bool dma_encodes = false;  ///< the DMA engines sRGB-encode finished pixels
    Observer* observer = nullptr;
    /// Schedules of all kernels, computed for another GPU with the same shader core configuration. Null: the
    /// constructor schedules the kernels.
    std::shared_ptr<const ScheduledKernels> scheduled{};
  };

  Gpu(const GpuConfig& config, const Workload& workload, TileSource& tiles, const Perturbation& perturbation = {});
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  // Interface for the engine (sim/engine.h).
  sim::Machine& machine() { return machine_; }
  bool done() const { return stopped_ || (dispatcher_->is_done() && machine_.is_drained()); }
  sim::RunLimits run_limits(sim::Time now) const;
  sim::Time livelock_timeout() const { return livelock_timeout_; }

  /// Updates the counters and cycle reasons of all units to the end of the run. Call once, with the time that the
  /// engine returned.
  void finish(sim::Time last_edge);
  /// Returns the simulated time of the run, rounded up to whole T&I cycles. Call after finish().
  sim::Time elapsed_time() const { return elapsed_; }
  std::uint64_t elapsed_cycles() const { return tni_clock_.cycles(elapsed_); }

  /// Updates the counters of all units to time `now` during a run. A tile must be dispatched at `now`.
  void account_until(sim::Time now) { machine_.account_until(now); }
  /// Ends the run now; tiles in flight remain unfinished. Call at the dispatch of the last tile of the list.
  void stop_early() { stopped_ = true; }
  bool is_stopped() const { return stopped_; }

  /// Returns the number of T&I cycles up to the last tick of the tile dispatcher. Used to show the progress of a run.
  std::uint64_t cycles_so_far() const { return tni_clock_.cycles(dispatcher_->activity().accounted_until()); }

  /// Returns the reports (counters and cycle reasons) of all units, in a fixed order.
  std::vector<sim::UnitReport> unit_reports() const { return machine_.report(); }
  /// Returns the use of shader core time by each kernel, summed over the cores, by KernelId.
  std::vector<KernelUse> kernel_use() const;
  const std::vector<KernelSchedule>& kernel_schedules() const { return scheduled_->kernels; }
  const std::shared_ptr<const ScheduledKernels>& scheduled_kernels() const { return scheduled_; }
  std::uint32_t core_count() const { return static_cast<std::uint32_t>(cores_.size()); }

  /// Puts the cache lines that a tile reads into the first-level caches of a core and, if they miss there, into the L2
  /// and the system cache. Takes no simulated time and counts no accesses. Returns the number of lines put into the L2.
  std::uint64_t warm_caches(const traces::TileWork& work, std::uint32_t core);
  /// Returns the capacity of the L2 and the system cache together, in lines.
  std::uint64_t shared_line_count() const {
    return (config_.l2.cache.size.bytes + config_.slc.cache.size.bytes) / config_.l2.cache.line.bytes;
  }
  /// Returns the contents of all caches. Call before the first cycle or after the last.
  CacheContents cache_contents() const;
  /// Replaces the contents of all caches by those of a GPU with equal caches. Call before the first cycle.
  void set_cache_contents(const CacheContents& contents);
  /// Empties all first-level caches if the frame has trees to build, because they may hold lines of the old trees. If
  /// kernels build the tree, its lines are also removed from the L2. No ray is traced before the tree is complete, so
  /// the lines may be removed before the first cycle.
  void invalidate_first_level();

 private:
  struct Core {
    sim::UnitId srp_id;
    TniCore tni;
    sim::Link<TileJob>& tiles_in;
    sim::Link<TileDone>& tiles_out;
    Srp* srp = nullptr;
    Dma* dma = nullptr;
    RasterUnit* raster = nullptr;  ///< the core's rasteriser; null if there is none
  };
  /// Links for rays and hits between shader core and T&I unit. With a direct interface, both units use the same link;
  /// otherwise each unit has its own link to the memory interface.
  struct Interface {
    sim::Link<RayJob>&rays_from_srp, &rays_to_tni;
    sim::Link<RayDone>&hits_from_tni, &hits_to_srp;
  };

  /// Links of a rasteriser to its shader core and to memory.
  struct RasterWires {
    sim::UnitId unit;
    sim::Link<RasterJob>& jobs;
    sim::Link<RasterDone>& done;
    MemoryPort memory;
  };

  /// Links of the tree builder to the tile dispatcher and to memory.
  struct BuilderWires {
    sim::UnitId unit;
    sim::Link<TileJob>& jobs;
    sim::Link<TileDone>& done;
  };

  BuilderWires link_builder();
  void build_tree_builder(const Workload& workload, const MemoryPort& memory);
  Core& declare_core(std::uint32_t core_number, const TreeKind& tree);
  Interface link_interface(const Core& core, sim::UnitId memory_interface);
  RasterWires link_rasteriser(const Core& core, std::uint32_t core_number);
  void build_core(std::uint32_t core_number, const Workload& workload);
  Srp::Frame srp_frame_of(const Workload& workload, std::uint32_t core) const;
  sim::Time earliest_end_of_last_tile(sim::Time now) const;

  const GpuConfig config_;
  const traces::Layout& layout_;
  const Addr stored_samples_;  ///< address of region kSamples
  const sim::Clock tni_clock_, srp_clock_, l2_clock_;
  const Addr tree_bytes_;  ///< bytes of the tree that kernels write; 0: none
  const TilesInFlight in_flight_;
  const std::shared_ptr<const ScheduledKernels> scheduled_;
  sim::Time livelock_timeout_ = sim::kNever;

  sim::Machine machine_;
  MemorySystem memory_;
  const sim::UnitId dispatcher_id_;
  std::deque<Core> cores_;
  std::optional<BuilderWires> builder_wires_;  ///< present if the frame has trees to build
  TreeBuilder* builder_ = nullptr;
  TileDispatcher* dispatcher_ = nullptr;
  sim::Time elapsed_ = 0;
  bool stopped_ = false;
};

}  // namespace hw
