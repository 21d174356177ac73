#pragma once
#include "tests/hw_models/memory/harness.h"

namespace hw::test {

/// Test harness for a core port between clients and memories that answer at once.
struct PortHarness {
  PortHarness(std::size_t clients, std::size_t targets, std::size_t capacity, std::uint64_t latency = 1,
              std::uint32_t width = 32, Arbitration arbitration = Arbitration::kRoundRobin, bool ideal = false) {
    InterconnectConfig config;
    config.width_bytes = width;
    config.arbitration = arbitration;
    const sim::UnitId port = harness.unit("port");
    CorePort::Links links;
    for (std::size_t i = 0; i < clients; ++i) {
      const sim::UnitId requester = harness.unit("requester");
      auto& up = harness.link<MemRequest>(capacity, 1, requester, port);
      auto& down = harness.link<MemResponse>(capacity, latency, port, requester);
      harness.add_requester(requester, up, down, static_cast<std::uint16_t>(i));
      links.clients_in.push_back(&up);
      links.clients_out.push_back(&down);
    }
    for (std::size_t i = 0; i < targets; ++i) {
      const sim::UnitId memory = harness.unit("memory");
      auto& up = harness.link<MemRequest>(capacity, latency, port, memory);
      auto& down = harness.link<MemResponse>(capacity, 1, memory, port);
      harness.add_echo(memory, up, down);
      links.targets_out.push_back(&up);
      links.targets_in.push_back(&down);
    }
    harness.add_port(port, config, links, Interleave(kLineBytes, static_cast<std::uint32_t>(targets)), kClock,
                     kLineBytes, ideal);
  }

  Requester& client(std::size_t i) { return *harness.requesters[i]; }
  const Echo& target(std::size_t i) { return *harness.echoes[i]; }
  const CorePort& port() { return *harness.ports.front(); }
  std::uint64_t why(CorePort::CycleReason w) { return kClock.cycles(port().activity().spent(w)); }
  std::uint64_t elapsed() { return kClock.cycles(port().activity().accounted_until()); }

  Harness harness;
};

}  // namespace hw::test
