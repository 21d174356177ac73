#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/memory/background_source.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/l2_bank.h"
#include "hw_models/memory/observer.h"
#include "hw_models/memory/system_cache.h"
#include "sim/machine.h"

namespace hw {

/// Capacity of the link that carries memory requests from a unit to its core's port.
inline constexpr std::uint32_t kRequestDepth = 2;

/// The memory system of a GPU: the ports of each core, the L2 banks, the DRAM channels, and the links between them.
///
///   clients x n of each core --> cache port --> L2 banks --> channels
///   DMA of each core ----------> DMA port -----------------> channels
///
/// If there is a system cache, requests to a channel go through its slice of that cache. Background sources send
/// requests directly to the channels.
///
/// A core's ports are declared before its units, so that links can connect to them, and built after its units.
class MemorySystem {
 public:
  enum class Dma : bool { kNo, kYes };  ///< selects whether cores have a DMA port

  /// `config` must outlive the memory system.
  MemorySystem(sim::Machine& machine, const GpuConfig& config, Dma dma, const DramPerturbation& shift = {},
               Observer* observer = nullptr);

  /// Declares the cache port and the DMA port of the next core, without building them.
  void declare_ports();
  /// Adds a client to a core's cache port and returns the links between them.
  MemoryPort add_cache_client(std::uint32_t core, const MemoryClient& client);
  std::vector<MemoryPort> add_cache_clients(std::uint32_t core, std::span<const MemoryClient> clients);
  /// Links a core's DMA engine to the core's DMA port and returns the links. The request link holds dma.depth requests.
  MemoryPort add_dma_client(std::uint32_t core, sim::UnitId dma);
  /// Creates one link from the unit `from` to each L2 bank, for Flush messages. Returns the links.
  std::vector<sim::Link<Flush>*> create_flush_links(sim::UnitId from);

  /// If background.rate is above 0, adds a source of background traffic to each DRAM channel. Returns one link from the
  /// unit `from` to each source; a Flush message stops the source.
  std::vector<sim::Link<Flush>*> add_background_sources(sim::UnitId from);

  /// Builds the ports of a core and returns its cache port.
  CorePort& build_ports(std::uint32_t core);
  sim::UnitId cache_port_id(std::uint32_t core) const { return cache_ports_[core].unit; }
  void build_banks_and_channels();

  const std::vector<CorePort*>& core_ports() const { return built_ports_; }
  const std::vector<L2Bank*>& l2_banks() const { return banks_; }
  /// Returns the slices of the system cache, by DRAM channel; empty without a system cache.
  const std::vector<SystemCacheSlice*>& system_cache_slices() const { return slices_; }
  const std::vector<DramChannel*>& dram_channels() const { return channels_; }

 private:
  struct Port {
    sim::UnitId unit;
    CorePort::Links links{};
  };
  struct Bank {
    sim::UnitId unit;
    L2Bank::Links links{};
  };
  struct Channel {
    sim::UnitId unit;
    DramChannel::Links links{};
  };
  struct Source {
    sim::UnitId unit;
    BackgroundSource::Links links;
  };

  bool has_slices() const { return !declared_slices_.empty(); }
  void link_to_memory(Bank& bank);
  void link_slices_to_channels();
  void build_background_sources();
  void link_to_banks(Port& cache);
  void link_to_channels(Port& dma);
  MemoryPort add_client(Port& port, const MemoryClient& client, std::uint32_t request_depth);

  sim::Machine& machine_;
  const GpuConfig& config_;
  const Dma dma_;
  const DramPerturbation shift_;
  Observer* const observer_;
  const sim::Clock clock_;
  const std::uint32_t distance_, link_depth_;  ///< cycles and capacity of links from ports to banks and channels
  std::vector<Port> cache_ports_, dma_ports_;  ///< ports of each core; `dma_ports_` is empty if cores have no DMA
  std::vector<Bank> declared_banks_;
  std::vector<Bank> declared_slices_;     ///< slices of the system cache, by DRAM channel, or empty
  std::vector<Source> declared_sources_;  ///< background sources, by DRAM channel, or empty
  std::vector<Channel> declared_channels_;
  std::vector<CorePort*> built_ports_;
  std::vector<L2Bank*> banks_;
  std::vector<SystemCacheSlice*> slices_;
  std::vector<DramChannel*> channels_;
};

}  // namespace hw
