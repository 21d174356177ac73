#include "tools/microbench/memory_side.h"

#include <algorithm>

#include "hw_models/frame/gpu.h"
#include "sim/engine.h"

namespace tools {

/// Places in the wake array, and the links that meet at banks and channels.
struct MemorySide::Wiring {
  const hw::GpuConfig& config;
  const std::uint32_t clients;
  sim::Wakes& wakes;
  sim::Clock l2 = config.clocks.l2.clock();
  std::vector<hw::L2Bank::Links> banks{config.l2.banks};
  std::vector<hw::DramChannel::Links> channels{config.dram.channels};

  std::uint32_t readers() const { return config.cores * clients; }
  sim::Waker reader(std::uint32_t i) const { return wakes.of(i); }
  sim::Waker port(std::uint32_t core) const { return wakes.of(readers() + core); }
  sim::Waker bank(std::uint32_t b) const { return wakes.of(readers() + config.cores + b); }
  sim::Waker channel(std::uint32_t k) const { return wakes.of(readers() + config.cores + config.l2.banks + k); }
  std::size_t size() const { return readers() + config.cores + config.l2.banks + config.dram.channels; }

  template <class T>
  sim::Link<T>* link(std::deque<sim::Link<T>>& links, std::uint32_t capacity, std::uint32_t latency, sim::Clock from,
                     sim::Clock to, sim::Waker producer, sim::Waker consumer) const {
    auto& link = links.emplace_back(capacity, latency, from, to, from == to ? 0 : config.clocks.synchroniser);
    link.wakes(producer, consumer);
    return &link;
  }
};

MemorySide::MemorySide(const hw::GpuConfig& config) : clients_(config.tni.trvs + 2) {
  Wiring w{config, clients_, wakes_};
  wakes_.reset(w.size());
  for (std::uint32_t core = 0; core < config.cores; ++core) add_core(w, config, core);
  const sim::Clock dram(config.dram.timing.ck.time);
  const std::uint32_t depth = config.interconnect.link_depth + 1;
  for (std::uint32_t b = 0; b < config.l2.banks; ++b) {
    for (std::uint32_t k = 0; k < config.dram.channels; ++k) {
      auto* up = w.link(requests_, depth, 1, w.l2, dram, w.bank(b), w.channel(k));
      auto* down = w.link(responses_, depth, 1, dram, w.l2, w.channel(k), w.bank(b));
      w.banks[b].channels_out.push_back(up);
      w.banks[b].channels_in.push_back(down);
      w.channels[k].ports_in.push_back(up);
      w.channels[k].ports_out.push_back(down);
    }
    banks_.emplace_back(config.l2, static_cast<std::uint16_t>(b), w.banks[b], config.dram.interleave(), w.l2,
                        config.interconnect.arbitration);
  }
  for (const hw::DramChannel::Links& links : w.channels) channels_.emplace_back(config.dram, links);
}

void MemorySide::add_core(Wiring& w, const hw::GpuConfig& config, std::uint32_t core) {
  hw::CorePort::Links port;
  const auto client = [&](sim::Clock clock, const hw::CacheConfig& cache) {
    const auto place = static_cast<std::uint32_t>(readers_.size());
    auto* up = w.link(requests_, hw::kRequestDepth, 1, clock, w.l2, w.reader(place), w.port(core));
    auto* down = w.link(responses_, cache.mshrs, 1, w.l2, clock, w.port(core), w.reader(place));
    readers_.emplace_back(clock, cache, static_cast<std::uint16_t>(port.clients_in.size()), *up, *down);
    port.clients_in.push_back(up);
    port.clients_out.push_back(down);
  };
  for (std::uint32_t t = 0; t < config.tni.trvs; ++t) client(config.clocks.tni.clock(), config.tni.trv.l1);
  client(config.clocks.tni.clock(), config.tni.ist.l1);
  client(config.clocks.srp.clock(), config.srp.data_cache);
  const std::uint32_t distance = config.interconnect.latency;
  const std::uint32_t depth = config.interconnect.link_depth + distance;
  for (std::uint32_t b = 0; b < config.l2.banks; ++b) {
    auto* up = w.link(requests_, depth, distance, w.l2, w.l2, w.port(core), w.bank(b));
    auto* down = w.link(responses_, depth, distance, w.l2, w.l2, w.bank(b), w.port(core));
    port.targets_out.push_back(up);
    port.targets_in.push_back(down);
    w.banks[b].cores_in.push_back(up);
    w.banks[b].cores_out.push_back(down);
  }
  ports_.emplace_back(config.interconnect, port, config.l2.interleave(), w.l2, config.l2.cache.line.bytes);
}

void MemorySide::run() { sim::run(*this); }

bool MemorySide::done() const {
  return std::ranges::all_of(readers_, [](const Reader& reader) { return reader.done(); });
}

std::string MemorySide::state() const {
  std::string text;
  for (const hw::CorePort& unit : ports_) text += unit.state() + "\n";
  for (const hw::L2Bank& unit : banks_) text += unit.state() + "\n";
  for (const hw::DramChannel& unit : channels_) text += unit.state() + "\n";
  return text;
}

}  // namespace tools
