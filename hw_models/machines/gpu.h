#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hw_models/frame/dma.h"
#include "hw_models/frame/memory_interface.h"
#include "hw_models/frame/tile_dispatcher.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/dram_channel.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/tni.h"
#include "sim/partitions.h"
#include "sim/report/unit_report.h"
#include "sim/wakes.h"
#include "traces/accel/memory_image.h"

namespace hw {

/// A unit's requests on the wire to its core's port.
inline constexpr std::uint32_t kRequestDepth = 2;

/// The machine: cores, L2, memory, and the only place that wires them together.
///
///   tile dispatcher --> core x n: SRP <--direct interface--> T&I unit        core ports       L2 banks    channels
///                        |  tile buffer --> DMA -------------------------------------------------------> LPDDR
///                        +-- L1s of TRVs and IST, data cache --------------> arbiter -------> L2 -------->
///
/// Without the direct interface, rays and hits pass a memory interface, which is a client of the core's port, too.
class Gpu {
 public:
  /// What the machine must know of the workload beside the stream itself.
  struct Workload {
    const traces::MemoryImage& image;
    std::span<const std::uint32_t> parents;              ///< of each node of the tree
    std::uint32_t tile_samples = 256;                    ///< of a full tile
    std::array<std::uint64_t, kRegions> region_bytes{};  ///< of all tiles together, by traces::Region
    std::uint64_t attribute_bytes = 0;                   ///< of a full tile, set aside in the tile buffer
  };

  Gpu(const GpuConfig& config, const Workload& workload, TileSource& tiles);
  Gpu(const Gpu&) = delete;
  Gpu& operator=(const Gpu&) = delete;

  // The machine, as the engine sees it (sim/engine.h).
  template <class F>
  void each_unit(F&& f) {
    for (std::size_t c = 0; c < cores_.size(); ++c) {
      Core& core = cores_[c];
      std::size_t i = first_of_core(c);
      f(*core.srp, i++);
      f(core.tni->dispatcher(), i++);
      for (Trv& trv : core.tni->trvs()) f(trv, i++);
      f(core.tni->ist(), i++);
      f(*core.cache_port, i++);
      f(*core.dma, i++);
      f(*core.dma_port, i++);
      if (c < memory_interfaces_.size()) f(memory_interfaces_[c], i++);
    }
    std::size_t i = first_of_core(cores_.size());
    f(*dispatcher_, i++);
    for (L2Bank& bank : banks_) f(bank, i++);
    for (DramChannel& channel : channels_) f(channel, i++);
  }
  sim::Wakes& wakes() { return wakes_; }
  /// Each core, and in the middle what they share.
  sim::Partitions& partitions() { return partitions_; }
  sim::Time lookahead_end(sim::Time now) const;
  bool done() const { return dispatcher_->done() && memory_quiet(); }
  std::string state();

  /// Charges every unit's time up to the end of the run. Call once, with what the engine returned.
  void finish(sim::Time last_edge);
  /// The time finish() was given, rounded up to whole T&I cycles.
  sim::Time elapsed() const { return elapsed_; }
  std::uint64_t cycles() const { return tni_clock_.cycles(elapsed_); }

  /// T&I cycles up to the last time at which the tile dispatcher had something to do, while the machine runs.
  std::uint64_t cycles_so_far() const { return tni_clock_.cycles(dispatcher_->activity().accounted()); }

  /// Every unit's counters, in a fixed order.
  std::vector<sim::UnitReport> report() const;
  /// Per kernel, summed over the cores, by KernelId.
  std::vector<KernelUse> kernel_use() const;
  const std::vector<KernelSchedule>& kernels() const { return kernels_; }
  std::uint32_t cores() const { return static_cast<std::uint32_t>(cores_.size()); }

  /// Puts what a tile reads into the caches of a core, and into the L2 what these do not hold, as if the tile had just
  /// been run: in no time, and uncounted (warming.cc).
  void warm(const traces::TileWork& work, std::uint32_t core);

 private:
  struct Core {
    std::unique_ptr<Srp> srp;
    std::unique_ptr<Tni> tni;
    std::unique_ptr<Dma> dma;
    std::unique_ptr<CorePort> cache_port, dma_port;
  };
  struct Wiring;

  bool memory_quiet() const;
  /// Place of a core's first unit; behind the last core come the units that cores share.
  std::size_t first_of_core(std::size_t core) const { return core * places_of_core_; }
  void add_partitions(const Wiring& wiring);
  void add_core(Wiring& wiring, std::uint32_t core, const Workload& workload);
  void add_memory(Wiring& wiring);

  const GpuConfig config_;
  const traces::Layout& layout_;
  const sim::Clock tni_clock_, srp_clock_, l2_clock_, dram_clock_;
  std::vector<KernelSchedule> kernels_;
  std::vector<BankConflicts> conflicts_;  ///< of each kernel

  // Pinned links, by what they carry.
  std::deque<sim::Link<TileJob>> tile_jobs_;
  std::deque<sim::Link<TileDone>> tile_dones_;
  std::deque<sim::Link<RayJob>> ray_jobs_;
  std::deque<sim::Link<RayDone>> ray_dones_;
  std::deque<sim::Link<DmaJob>> dma_jobs_;
  std::deque<sim::Link<DmaDone>> dma_dones_;
  std::deque<sim::Link<MemRequest>> requests_;
  std::deque<sim::Link<MemResponse>> responses_;
  std::deque<sim::Link<Flush>> flushes_;  ///< to each L2 bank that keeps writes

  std::deque<Core> cores_;
  std::deque<L2Bank> banks_;
  std::deque<DramChannel> channels_;
  std::deque<MemoryInterface> memory_interfaces_;  ///< of each core, if there is no direct interface
  std::unique_ptr<TileDispatcher> dispatcher_;
  const std::size_t places_of_core_;  ///< among the wake-up times: whole groups
  sim::Wakes wakes_;                  ///< at the places that each_unit() names
  sim::Partitions partitions_;
  /// What a partition does at t does not matter to another before t + lookahead_, but for new tiles, and for lines that
  /// a DMA awaits, which may come at t + dma_lookahead_.
  sim::Time lookahead_ = 0, dma_lookahead_ = 0;
  sim::Time elapsed_ = 0;
};

}  // namespace hw
