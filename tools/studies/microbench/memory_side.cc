#include "tools/studies/microbench/memory_side.h"

#include <algorithm>

#include "sim/engine.h"

namespace tools {
namespace {

struct CacheInClock {
  sim::Clock clock;
  const hw::CacheConfig& cache;
};

/// Returns the first-level caches of a core.
std::vector<CacheInClock> first_level_caches(const hw::GpuConfig& config) {
  const sim::Clock tni = config.clocks.tni.clock();
  std::vector<CacheInClock> all(config.tni.trvs, {tni, config.tni.trv.l1});
  all.push_back({tni, config.tni.ist.l1});
  all.push_back({config.clocks.srp.clock(), config.srp.data_cache});
  return all;
}

}  // namespace

MemorySide::MemorySide(const hw::GpuConfig& config)
    : clients_(config.tni.trvs + 2),
      machine_(config.clocks.synchroniser),
      memory_(machine_, config, hw::MemorySystem::Dma::kNo) {
  for (std::uint32_t core = 0; core < config.cores; ++core) {
    memory_.declare_ports();
    for (const auto& [clock, cache] : first_level_caches(config)) {
      const sim::UnitId unit = machine_.unit({hw::name_in_core("core.reader", core), clock, core + 1});
      const hw::MemoryPort port = memory_.add_cache_client(core, {unit, cache.mshrs});
      readers_.push_back(&machine_.build<Reader>(unit, clock, cache, port.client, port.requests, port.responses));
    }
    memory_.build_ports(core);
  }
  memory_.build_banks_and_channels();
}

void MemorySide::run() { sim::run(*this); }

bool MemorySide::done() const {
  return std::ranges::all_of(readers_, [](const Reader* reader) { return reader->done(); });
}

}  // namespace tools
