#pragma once
#include <algorithm>

#include "hw_models/dram/dram_measurements.h"
#include "tests/hw_models/memory/harness.h"

namespace hw::test {

/// Test harness for one DRAM channel without fabric latency. Requesters have its clock and links of one cycle.
struct DramHarness {
  /// Latency of request link and response link together, in cycles.
  static constexpr std::uint64_t kWires = 2;

  static DramConfig quiet() {
    DramConfig c;
    c.channels = 1;
    c.fabric = {0};
    c.timing.refi_pb = 0;
    c.controller.bank_xor = false;
    return c;
  }

  explicit DramHarness(DramConfig c = quiet(), std::size_t requesters = 1, std::size_t capacity = 64,
                       bool ideal = false)
      : config(c) {
    const sim::Clock clock(c.timing.ck.time);
    const sim::UnitId unit = harness.unit("dram", clock);
    DramChannel::Links links;
    for (std::size_t i = 0; i < requesters; ++i) {
      const sim::UnitId requester = harness.unit("requester", clock);
      auto& up = harness.link<MemRequest>(capacity, 1, requester, unit);
      auto& down = harness.link<MemResponse>(capacity, 1, unit, requester);
      harness.add_requester(requester, up, down);
      links.ports_in.push_back(&up);
      links.ports_out.push_back(&down);
    }
    harness.add_channel(unit, c, links, ideal);
  }

  Requester& requester(std::size_t i = 0) { return *harness.requesters[i]; }
  std::uint64_t latency(std::size_t request) { return requester().script[request].latency(); }
  DramChannel& channel() { return *harness.channels.front(); }
  const DramChannel::Stats& stats() { return channel().stats(); }
  std::uint64_t why(DramCycleReason reason) { return channel().clock().cycles(channel().activity().spent(reason)); }
  /// Simulates all requests and returns the elapsed cycles.
  std::uint64_t run(Mode mode = Mode::kSkip) {
    end = harness.run(mode);
    return channel().clock().cycles(end) + 1;
  }

  /// Returns the address of the first line of DRAM row `index` in a bank.
  Addr row(std::uint32_t bank, std::uint32_t index) const {
    const Addr page = config.organisation.page.bytes;
    return (Addr{index} * config.organisation.all_banks() + bank) * page;
  }

  DramConfig config;
  Harness harness;
  sim::Time end = 0;
};

/// Timing of the default DRAM device, and closed forms of its latencies.
inline const DramTiming kT;
inline const DramClosedForms kForm{DramHarness::quiet()};

/// Returns the first cycle at or after `now` at which a command to a bank of a rank can start.
inline DramDevice::Cycle earliest_start(const DramDevice& d, DramCommand command, std::uint32_t bank, bool write,
                                        DramDevice::Cycle now, std::uint32_t rank = 0) {
  const auto bank_ready = [&] {
    switch (command) {
      case DramCommand::kColumn:
        return d.first_ready_cycle<DramCommand::kColumn>(1U << bank, write);
      case DramCommand::kActivate:
        return d.first_ready_cycle<DramCommand::kActivate>(1U << bank, write);
      default:
        return d.first_ready_cycle<DramCommand::kPrecharge>(1U << bank, write);
    }
  };
  const DramDevice::Cycle rank_ready = d.earliest_rank_cycle(command, rank, write, d.first_awake_cycle(now));
  return d.first_bus_slot(command, rank, std::max(rank_ready, bank_ready()));
}

/// A list of DRAM requests, and the result of simulating them. Times are in cycles.
struct Script {
  explicit Script(DramConfig c = DramHarness::quiet()) : config(std::move(c)) {}

  void read(std::uint32_t bank, Addr row, std::uint64_t cycle = 0, Addr line = 0) {
    const Addr page = row * config.organisation.all_banks() + bank;
    requests.push_back({page * config.organisation.page.bytes + 64 * line, false, cycle * config.timing.ck.time});
  }
  void go() { result = run_dram_requests(config, requests, 32); }
  double latency(std::size_t i) const {
    return static_cast<double>(result.request_latency(i)) / static_cast<double>(config.timing.ck.time);
  }
  std::uint64_t done(std::size_t i) const { return result.done[i] / config.timing.ck.time; }
  std::uint64_t why(DramCycleReason reason) const { return result.why[static_cast<std::size_t>(reason)].second; }

  DramConfig config;
  std::vector<DramRequest> requests;
  DramRun result;
};

inline DramConfig with(auto&& change) {
  DramConfig c = DramHarness::quiet();
  change(c);
  return c;
}

}  // namespace hw::test
