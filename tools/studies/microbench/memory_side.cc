#include "tools/studies/microbench/memory_side.h"

#include <algorithm>

#include "sim/engine.h"

namespace tools {

namespace {

struct Place {
  sim::Clock clock;
  const hw::CacheConfig& cache;
};

/// Where a core has first-level caches.
std::vector<Place> caches(const hw::GpuConfig& config) {
  const sim::Clock tni = config.clocks.tni.clock();
  std::vector<Place> all(config.tni.trvs, {tni, config.tni.trv.l1});
  all.push_back({tni, config.tni.ist.l1});
  all.push_back({config.clocks.srp.clock(), config.srp.data_cache});
  return all;
}

std::vector<hw::MemoryNet::Client> clients(const hw::GpuConfig& config) {
  std::vector<hw::MemoryNet::Client> all;
  for (const auto& [clock, cache] : caches(config)) all.push_back({clock, cache.mshrs});
  return all;
}

}  // namespace

MemorySide::MemorySide(const hw::GpuConfig& config)
    : clients_(config.tni.trvs + 2),
      wakes_(std::size_t{config.cores} * clients_ + hw::MemoryNet::units(config)),
      net_(config, clients(config), wakes_, std::size_t{config.cores} * clients_,
           [this](std::uint32_t core, std::uint32_t client) { return wakes_.of(core * clients_ + client); }) {
  const std::vector<Place> places = caches(config);
  for (std::uint32_t core = 0; core < config.cores; ++core) {
    for (std::uint32_t c = 0; c < clients_; ++c) {
      readers_.emplace_back(places[c].clock, places[c].cache, static_cast<std::uint16_t>(c), net_.requests(core, c),
                            net_.responses(core, c));
    }
  }
}

void MemorySide::run() { sim::run(*this); }

bool MemorySide::done() const {
  return std::ranges::all_of(readers_, [](const Reader& reader) { return reader.done(); });
}

}  // namespace tools
