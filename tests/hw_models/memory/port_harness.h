#pragma once
#include "tests/hw_models/memory/harness.h"

namespace hw::test {

/// Clients, a port, and memories that answer at once.
struct PortHarness {
  PortHarness(std::size_t clients, std::size_t targets, std::size_t capacity, std::uint64_t latency = 1,
              std::uint32_t width = 32, Arbitration arbitration = Arbitration::kRoundRobin, bool ideal = false) {
    InterconnectConfig config;
    config.width_bytes = width;
    config.arbitration = arbitration;
    CorePort::Links links;
    for (std::size_t i = 0; i < clients; ++i) {
      auto& up = harness.link<MemRequest>(capacity, 1, kClock, kClock);
      auto& down = harness.link<MemResponse>(capacity, latency, kClock, kClock);
      harness.requesters.emplace_back(kClock, up, down).source = static_cast<std::uint16_t>(i);
      harness.connect(up, i, clients);
      harness.connect(down, clients, i);
      links.clients_in.push_back(&up);
      links.clients_out.push_back(&down);
    }
    for (std::size_t i = 0; i < targets; ++i) {
      auto& up = harness.link<MemRequest>(capacity, latency, kClock, kClock);
      auto& down = harness.link<MemResponse>(capacity, 1, kClock, kClock);
      harness.echoes.emplace_back(kClock, up, down);
      harness.connect(up, clients, clients + 1 + i);
      harness.connect(down, clients + 1 + i, clients);
      links.targets_out.push_back(&up);
      links.targets_in.push_back(&down);
    }
    harness.ports.emplace_back(config, links, Interleave(64, static_cast<std::uint32_t>(targets)), kClock, 64, ideal);
  }

  Requester& client(std::size_t i) { return *std::next(harness.requesters.begin(), static_cast<long>(i)); }
  const Echo& target(std::size_t i) { return *std::next(harness.echoes.begin(), static_cast<long>(i)); }
  const CorePort& port() { return harness.ports.front(); }
  std::uint64_t why(CorePort::CycleReason w) { return kClock.cycles(port().activity().spent(w)); }
  std::uint64_t elapsed() { return kClock.cycles(port().activity().accounted()); }

  Harness harness;
};

}  // namespace hw::test
