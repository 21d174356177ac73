#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/memory/messages.h"
#include "hw_models/memory/observer.h"
#include "hw_models/memory/unit_names.h"
#include "sim/config/field.h"
#include "sim/link.h"
#include "sim/machine.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// A unit that requests memory lines, and the maximum number of its outstanding requests.
struct MemoryClient {
  sim::UnitId unit;
  std::uint32_t lines = 1;
  RequesterKind requester = RequesterKind::kNodes;
};

/// The links between a unit and its core's port to memory.
struct MemoryPort {
  sim::Link<MemRequest>& requests;
  sim::Link<MemResponse>& responses;
  std::uint16_t client = 0;  ///< the unit's client number at the port, for MemRequest::source
};

/// Configuration of the interconnect between the cores and the memory system that they share.
struct InterconnectConfig {
  std::uint32_t latency = 4;
  std::uint32_t width_bytes = 32;
  std::uint32_t link_depth = 4;
  Arbitration arbitration = Arbitration::kRoundRobin;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.latency), "cycles", "latency between a core and an L2 bank or memory controller, in each direction",
          sim::between(1, 100), Affects::kTiming);
    field(c.width_bytes, "width", "bytes", "bytes of a line carried per cycle in each direction",
          sim::power_of_two(8, 256), Affects::kTiming);
    field(NAMED(c.link_depth), "entries", "slots of each link", sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.arbitration), "", "order in which requesters are served at a core's ports and at an L2 bank",
          sim::any(), Affects::kTiming);
  }
  std::uint32_t cycles_of(std::uint64_t bytes) const {
    return static_cast<std::uint32_t>((bytes + width_bytes - 1) / width_bytes);
  }
};

/// A core's port to the memory system: carries requests of the core's units (clients) up to the L2 or memory, and lines
/// down to the units. A core has two ports: one from its caches to the L2 banks, and one from its DMA to the DRAM
/// channels, bypassing the L2.
///
///   clients_in  --> arbiter, one request per cycle -------> targets_out (chosen by the line's address)
///   clients_out <-- arbiter, line / width cycles a line <-- targets_in
///
/// 1. A client's number is its index in clients_out. A client writes its number into `source` of its requests.
/// 2. A write carries its sectors up. It occupies the upward wires for as many cycles as the same sectors would occupy
/// the downward wires. A read of some sectors returns the whole line.
/// 3. The distance to the targets is modelled as latency of the links.
/// 4. An ideal port has unlimited bandwidth: each cycle it forwards all messages that have arrived and whose receivers
/// have room.
///
/// Not modelled: the topology between port and targets. All targets are at the same distance and have their own wires.
class CorePort {
 public:
  static constexpr const char *kCachePort = "core.cache_port",
                              *kDmaPort = "core.dma_port";  ///< names of a core's two ports
  static constexpr Block kBlock = Block::kInterconnect;
  enum class CycleReason : std::uint8_t { kIdle, kRequest, kLine, kTargetFull, kClientFull, kCount };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle_reason("idle", "nothing to carry")},
      {CycleReason::kRequest, sim::working_reason("request", "a request was sent up")},
      {CycleReason::kLine, sim::working_reason("line", "a line was transferred, up or down")},
      {CycleReason::kTargetFull, sim::waiting_reason("target_full", "requests wait for a target's queue")},
      {CycleReason::kClientFull, sim::waiting_reason("client_full", "a line waits for room at its client")},
  });
  struct Stats {
    std::uint64_t requests = 0, lines_down = 0, lines_up = 0;
    std::uint64_t request_wait = 0, line_wait = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.requests), "requests carried up", "interconnect.request");
      counter(NAMED(s.lines_down), "lines carried down to a client", "interconnect.line");
      counter(NAMED(s.lines_up), "whole or partial lines carried up by writes", "interconnect.line");
      counter(NAMED(s.request_wait), "cycles that requests waited for arbitration and room, summed over requests", "",
              sim::CounterKind::kAtEnd);
      counter(NAMED(s.line_wait), "cycles that lines waited for arbitration and room, summed over lines", "",
              sim::CounterKind::kAtEnd);
    }
  };
  struct Links {
    std::vector<sim::Link<MemRequest>*> clients_in;
    std::vector<sim::Link<MemResponse>*> clients_out;
    std::vector<sim::Link<MemRequest>*> targets_out;
    std::vector<sim::Link<MemResponse>*> targets_in;
    std::vector<RequesterKind> requesters;  ///< kind of each client of the port; used only with an observer
    Observer* observer = nullptr;
  };

  CorePort(const InterconnectConfig& config, Links links, Interleave targets, sim::Clock clock,
           std::uint64_t line_bytes = kLineBytes, bool ideal = false);
  CorePort(const CorePort&) = delete;
  CorePort& operator=(const CorePort&) = delete;

  sim::Time tick(sim::Time now);
  void finish(sim::Time end);

  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  std::string state() const;

 private:
  bool send_requests_to_memory(sim::Time now);
  void send_lines_to_clients(sim::Time now);
  void send_request(std::uint32_t client, sim::Time now);
  void send_line(std::uint32_t target, sim::Time now);
  bool can_send_request(std::uint32_t client, sim::Time now) const {
    return clients_in_.can_pop(client, now) && target_of(clients_in_[client].front()).can_push(now);
  }
  bool can_send_line(std::uint32_t target, sim::Time now) const {
    return targets_in_.can_pop(target, now) && clients_out_[targets_in_[target].front().source]->can_push(now);
  }
  void account_until(sim::Time until);
  sim::Time find_next_wake(sim::Time now);

  sim::Link<MemRequest>& target_of(const MemRequest& request) const {
    return *targets_out_[targets_.index_of(request.line)];
  }

  const std::vector<sim::Link<MemResponse>*> clients_out_;
  const std::vector<sim::Link<MemRequest>*> targets_out_;
  const sim::Inputs<MemRequest> clients_in_;
  const sim::Inputs<MemResponse> targets_in_;
  const std::vector<RequesterKind> requesters_;
  Observer* const observer_;
  Interleave targets_;
  sim::Clock clock_;
  const bool ideal_;
  std::array<sim::Time, 9> carry_time_;  ///< time for which a transfer occupies the port's wires, by number of sectors

  Arbiter up_, down_;
  sim::Time request_wait_ = 0, line_wait_ = 0;
  sim::Time up_free_ = 0;
  sim::Time down_free_ = 0;
  sim::Time line_transfer_end_ = 0;  ///< end of the last line transfer in either direction
  CycleReason waiting_{};
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
