#include "hw_models/machines/memory_net.h"

#include <algorithm>

#include "hw_models/machines/gpu.h"

namespace hw {

namespace {

constexpr std::uint32_t kIdealDepth = 256;  // of the links of an ideal interconnect: more than is under way at once

}  // namespace

/// Places in the wake array, and the links that meet at banks and channels.
struct MemoryNet::Wiring {
  const GpuConfig& config;
  sim::Wakes& wakes;
  const std::size_t first;
  sim::Clock l2 = config.clocks.l2.clock();
  std::vector<L2Bank::Links> banks{config.l2.banks};
  std::vector<DramChannel::Links> channels{config.dram.channels};

  sim::Waker port(std::uint32_t core) const { return wakes.of(first + core); }
  sim::Waker bank(std::uint32_t b) const { return wakes.of(first + config.cores + b); }
  sim::Waker channel(std::uint32_t k) const { return wakes.of(first + config.cores + config.l2.banks + k); }

  template <class T>
  sim::Link<T>* link(std::deque<sim::Link<T>>& links, std::uint32_t capacity, std::uint32_t latency, sim::Clock from,
                     sim::Clock to, sim::Waker producer, sim::Waker consumer) const {
    auto& link = links.emplace_back(capacity, latency, from, to, from == to ? 0 : config.clocks.synchroniser);
    link.wakes(producer, consumer);
    return &link;
  }
};

MemoryNet::MemoryNet(const GpuConfig& config, std::span<const Client> clients, sim::Wakes& wakes, std::size_t first,
                     const std::function<sim::Waker(std::uint32_t, std::uint32_t)>& wake_of)
    : clients_(static_cast<std::uint32_t>(clients.size())) {
  Wiring w{config, wakes, first};
  const IdealConfig& ideal = config.ideal;
  const std::uint32_t distance = ideal.interconnect ? 1 : config.interconnect.latency;
  const std::uint32_t link_depth = ideal.interconnect ? kIdealDepth : config.interconnect.link_depth;
  const std::uint32_t far_depth = link_depth + distance;
  const std::uint32_t request_depth = ideal.interconnect ? kIdealDepth : kRequestDepth;
  for (std::uint32_t core = 0; core < config.cores; ++core) {
    CorePort::Links port;
    for (std::uint32_t c = 0; c < clients_; ++c) {
      const sim::Waker wake = wake_of(core, c);
      const auto& [clock, lines] = clients[c];
      requests_of_.push_back(w.link(requests_, request_depth, 1, clock, w.l2, wake, w.port(core)));
      responses_of_.push_back(w.link(responses_, lines, 1, w.l2, clock, w.port(core), wake));
      port.clients_in.push_back(requests_of_.back());
      port.clients_out.push_back(responses_of_.back());
    }
    for (std::uint32_t b = 0; b < config.l2.banks; ++b) {
      auto* up = w.link(requests_, far_depth, distance, w.l2, w.l2, w.port(core), w.bank(b));
      auto* down = w.link(responses_, far_depth, distance, w.l2, w.l2, w.bank(b), w.port(core));
      port.targets_out.push_back(up);
      port.targets_in.push_back(down);
      w.banks[b].cores_in.push_back(up);
      w.banks[b].cores_out.push_back(down);
    }
    ports_.emplace_back(config.interconnect, port, config.l2.interleave(), w.l2, config.l2.cache.line.bytes,
                        ideal.interconnect);
  }
  const sim::Clock dram(config.dram.timing.ck.time);
  const std::uint32_t depth = link_depth + 1;
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
                        config.interconnect.arbitration, ideal.l2);
  }
  for (const DramChannel::Links& links : w.channels) channels_.emplace_back(config.dram, links, ideal.dram);
}

bool MemoryNet::quiet() const {
  const auto empty = [](const auto& link) { return link.empty(); };
  const auto idle = [](const auto& unit) { return unit.idle(); };
  return std::ranges::all_of(channels_, idle) && std::ranges::all_of(banks_, idle) &&
         std::ranges::all_of(requests_, empty) && std::ranges::all_of(responses_, empty);
}

std::string MemoryNet::state() const {
  std::string text;
  for (const CorePort& unit : ports_) text += unit.state() + "\n";
  for (const L2Bank& unit : banks_) text += unit.state() + "\n";
  for (const DramChannel& unit : channels_) text += unit.state() + "\n";
  return text;
}

}  // namespace hw
