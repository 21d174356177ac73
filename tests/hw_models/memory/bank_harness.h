#pragma once
#include "tests/hw_models/memory/harness.h"

namespace hw::test {

/// Test harness for one L2 bank with requesters and a memory of fixed latency. `memory`: latency of the memory in
/// cycles.
struct BankHarness {
  explicit BankHarness(L2Config config = small(), std::size_t cores = 2, std::size_t capacity = 64,
                       std::uint64_t memory = 50, Arbitration arbitration = Arbitration::kRoundRobin,
                       bool ideal = false, Observer* observer = nullptr)
      : flush(1, kFlushAt, kClock) {
    const sim::UnitId bank = harness.unit("l2");
    L2Bank::Links links;
    for (std::size_t i = 0; i < cores; ++i) {
      const sim::UnitId requester = harness.unit("requester");
      auto& up = harness.link<MemRequest>(capacity, 1, requester, bank);
      auto& down = harness.link<MemResponse>(capacity, 1, bank, requester);
      harness.add_requester(requester, up, down);
      links.cores_in.push_back(&up);
      links.cores_out.push_back(&down);
    }
    const sim::UnitId echo = harness.unit("memory");
    auto& up = harness.link<MemRequest>(capacity, 1, bank, echo);
    auto& down = harness.link<MemResponse>(capacity, memory, echo, bank);
    harness.add_echo(echo, up, down);
    links.channels_out.push_back(&up);
    links.channels_in.push_back(&down);
    links.flush_in = &flush;
    links.observer = observer;
    flush.push(0, Flush{});
    harness.add_bank(bank, config, std::uint16_t{0}, links, Interleave(64, 1), kClock, arbitration, ideal);
  }

  static L2Config small() {
    L2Config c;
    c.cache.size = {8192};
    c.banks = 1;
    c.cache.mshrs = 4;
    return c;
  }

  Requester& core(std::size_t i) { return *harness.requesters[i]; }
  const L2Bank::Stats& stats() { return harness.banks.front()->stats(); }
  std::uint64_t fetched() { return harness.echoes.front()->requests; }
  std::uint64_t written() { return harness.echoes.front()->written; }
  std::uint64_t why(L2Bank::CycleReason w) { return kClock.cycles(harness.banks.front()->activity().spent(w)); }

  static constexpr std::uint64_t kFlushAt = 100'000;  ///< cycle of the message to write back all dirty lines
  Harness harness;
  sim::Link<Flush> flush;
};

inline constexpr std::uint64_t kHit = 1 + 12 + 1;               // Cycles of an L2 hit: wire, hit_cycles, wire.
inline constexpr std::uint64_t kMiss = 1 + 4 + 1 + 50 + 1 + 1;  // Cycles of an L2 miss: wire, lookup, wire, memory,
                                                                // fill, wire.

}  // namespace hw::test
