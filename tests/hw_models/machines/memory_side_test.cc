#include <gtest/gtest.h>

#include "hw_models/machines/memory_system.h"
#include "tests/hw_models/memory/harness.h"

namespace hw::test {
namespace {

GpuConfig machine(std::uint32_t cores) {
  GpuConfig config;
  config.cores = cores;
  return config;
}

/// Test harness for the whole memory system: cores with cache clients and a DMA client, L2 banks, DRAM channels.
struct MemorySide {
  static constexpr std::size_t kClients = 3;

  explicit MemorySide(const GpuConfig& c)
      : config(c), harness(c.clocks.synchroniser), memory(harness.machine(), config, MemorySystem::Dma::kYes) {
    for (std::uint32_t core = 0; core < config.cores; ++core) {
      memory.declare_ports();
      for (std::size_t i = 0; i <= kClients; ++i) {
        const sim::UnitId unit = harness.machine().unit({"requester", kClock, core + 1});
        const MemoryPort port = i == kClients ? memory.add_dma_client(core, unit)
                                              : memory.add_cache_client(core, {unit, config.interconnect.link_depth});
        harness.add_requester(unit, port.requests, port.responses, port.client);
      }
      memory.build_ports(core);
    }
    memory.build_banks_and_channels();
  }

  Requester& client(std::size_t core, std::size_t i) { return *harness.requesters[core * (kClients + 1) + i]; }
  Requester& dma(std::size_t core) { return client(core, kClients); }

  const GpuConfig config;
  Harness harness;
  MemorySystem memory;
};

void random_traffic(MemorySide& m, std::uint64_t requests, std::uint64_t lines, std::size_t cores) {
  for (std::uint64_t i = 0; i < requests; ++i) {
    const std::size_t core = i % cores;
    const Addr line = sim::hash(i, 3) % lines * 64;
    const std::uint64_t pause = i * 4 / requests * 3000;
    if (i % 5 == 0) {
      m.dma(core).send(line, pause, sim::hash(i, 4) % 2 == 0);
    } else {
      m.client(core, sim::hash(i, 5) % MemorySide::kClients).send(line, pause);
    }
  }
}

TEST(MemorySide, AnUncontendedL2MissCosts80To150Nanoseconds) {
  MemorySide m(machine(1));
  m.client(0, 0).send(64 * 5);
  m.client(0, 0).send(64 * 5, 1000);
  m.harness.run();
  const std::uint64_t miss = m.client(0, 0).script[0].latency() * 2;
  const std::uint64_t hit = m.client(0, 0).script[1].latency() * 2;
  RecordProperty("miss_ns", static_cast<int>(miss));
  EXPECT_GE(miss - hit, 80U);
  EXPECT_LE(miss, 150U);
  EXPECT_EQ(hit, 2 * (1 + 4 + 12 + 4 + 1U)) << "client's wire, up, bank, down, client's wire";
}

TEST(MemorySide, EveryRequestIsAnsweredAndCountedOnceAtEachLevel) {
  MemorySide m(machine(2));
  random_traffic(m, 8000, 20000, 2);
  m.harness.run();
  std::uint64_t requests = 0, lookups = 0, fills = 0, l2_misses = 0, bytes = 0, dma = 0;
  for (const Requester* r : m.harness.requesters) {
    EXPECT_TRUE(r->done());
    EXPECT_EQ(r->mistakes, 0);
  }
  for (const CorePort* p : m.memory.core_ports()) requests += p->stats().requests;
  for (const L2Bank* b : m.memory.l2_banks()) {
    lookups += b->stats().reads;
    fills += b->stats().fills;
    l2_misses += b->stats().misses - b->stats().merges;
  }
  for (const DramChannel* c : m.memory.dram_channels()) bytes += c->stats().bytes;
  for (std::size_t core : {0U, 1U}) dma += m.dma(core).script.size();
  EXPECT_EQ(requests, 8000U);
  EXPECT_EQ(lookups + dma, 8000U);
  EXPECT_EQ(fills, l2_misses);
  EXPECT_EQ(bytes, 64 * (fills + dma));
}

TEST(MemorySide, RandomTrafficDoesNotDependOnHowTheEngineVisitsIt) {
  for (const std::uint32_t depth : {1U, 4U}) {
    for (const std::uint32_t cores : {1U, 3U}) {
      std::string expected;
      for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
        GpuConfig config = machine(cores);
        config.l2.cache.size = {32 * 1024};
        config.dram.channels = cores == 1 ? 4 : 2;
        config.interconnect.link_depth = depth;
        MemorySide m(config);
        random_traffic(m, 3000, cores == 1 ? 1000 : 50000, cores);
        m.client(0, 1).pop_every = 9;
        const sim::Time end = m.harness.run(mode);
        const std::string all = m.harness.everything(end);
        if (mode == Mode::kSkip) expected = all;
        ASSERT_EQ(all, expected) << "depth " << depth << ", cores " << cores;
        for (const sim::UnitReport& r : m.harness.reports()) {
          const std::uint64_t period = r.block == "dram" ? config.dram.timing.ck.time : kClock.period();
          EXPECT_EQ(r.elapsed, end / period + 1) << r.path;
        }
      }
    }
  }
}

}  // namespace
}  // namespace hw::test
