#include <gtest/gtest.h>

#include "tests/hw_models/memory/harness.h"

namespace hw::test {
namespace {

/// The whole memory side: cores with cache clients and a DMA client each, L2 banks, DRAM channels.
struct MemorySide {
  static constexpr std::size_t kClients = 3;

  MemorySide(std::size_t cores, const L2Config& l2, const DramConfig& dram, const InterconnectConfig& net)
      : dram_clock_(dram.timing.ck.time), depth_(net.link_depth) {
    const std::size_t requesters = cores * (kClients + 1);
    const auto cache_port = [&](std::size_t core) { return requesters + 2 * core; };
    const auto bank = [&](std::size_t b) { return requesters + 2 * cores + b; };
    const auto channel = [&](std::size_t c) { return requesters + 2 * cores + l2.banks + c; };

    std::vector<L2Bank::Links> banks(l2.banks);
    std::vector<DramChannel::Links> channels(dram.channels);
    for (std::size_t core = 0; core < cores; ++core) {
      CorePort::Links cache, dma;
      for (std::size_t i = 0; i <= kClients; ++i) {
        const bool is_dma = i == kClients;
        const std::size_t requester = core * (kClients + 1) + i;
        const std::size_t port = cache_port(core) + is_dma;
        auto& up = request(kClock, kClock, 1, requester, port);
        auto& down = response(kClock, kClock, net.latency, port, requester);
        harness.requesters.emplace_back(kClock, up, down).source = static_cast<std::uint16_t>(is_dma ? 0 : i);
        (is_dma ? dma : cache).clients_in.push_back(&up);
        (is_dma ? dma : cache).clients_out.push_back(&down);
      }
      for (std::size_t b = 0; b < l2.banks; ++b) {
        cache.targets_out.push_back(&request(kClock, kClock, net.latency, cache_port(core), bank(b)));
        cache.targets_in.push_back(&response(kClock, kClock, 1, bank(b), cache_port(core)));
        banks[b].cores_in.push_back(cache.targets_out.back());
        banks[b].cores_out.push_back(cache.targets_in.back());
      }
      for (std::size_t c = 0; c < dram.channels; ++c) {
        dma.targets_out.push_back(&request(kClock, dram_clock_, net.latency, cache_port(core) + 1, channel(c)));
        dma.targets_in.push_back(&response(dram_clock_, kClock, 1, channel(c), cache_port(core) + 1));
        channels[c].ports_in.push_back(dma.targets_out.back());
        channels[c].ports_out.push_back(dma.targets_in.back());
      }
      harness.ports.emplace_back(net, cache, l2.interleave(), kClock);
      harness.ports.emplace_back(net, dma, dram.interleave(), kClock);
    }
    for (std::size_t b = 0; b < l2.banks; ++b) {
      for (std::size_t c = 0; c < dram.channels; ++c) {
        banks[b].channels_out.push_back(&request(kClock, dram_clock_, 1, bank(b), channel(c)));
        banks[b].channels_in.push_back(&response(dram_clock_, kClock, 1, channel(c), bank(b)));
        channels[c].ports_in.push_back(banks[b].channels_out.back());
        channels[c].ports_out.push_back(banks[b].channels_in.back());
      }
      harness.banks.emplace_back(l2, static_cast<std::uint16_t>(b), banks[b], dram.interleave(), kClock);
    }
    for (const auto& links : channels) harness.channels.emplace_back(dram, links);
  }

  Requester& client(std::size_t core, std::size_t i) {
    return *std::next(harness.requesters.begin(), static_cast<long>(core * (kClients + 1) + i));
  }
  Requester& dma(std::size_t core) { return client(core, kClients); }

  Harness harness;

 private:
  sim::Link<MemRequest>& request(sim::Clock from, sim::Clock to, std::uint64_t latency, std::size_t a, std::size_t b) {
    auto& link = harness.link<MemRequest>(depth_, latency, from, to);
    harness.connect(link, a, b);
    return link;
  }
  sim::Link<MemResponse>& response(sim::Clock from, sim::Clock to, std::uint64_t latency, std::size_t a,
                                   std::size_t b) {
    auto& link = harness.link<MemResponse>(depth_, latency, from, to);
    harness.connect(link, a, b);
    return link;
  }

  sim::Clock dram_clock_;
  std::size_t depth_;
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
  MemorySide m(1, L2Config{}, DramConfig{}, InterconnectConfig{});
  m.client(0, 0).send(64 * 5);
  m.client(0, 0).send(64 * 5, 1000);
  m.harness.run();
  const std::uint64_t miss = m.client(0, 0).script[0].latency() * 2;
  const std::uint64_t hit = m.client(0, 0).script[1].latency() * 2;
  RecordProperty("miss_ns", static_cast<int>(miss));
  EXPECT_GE(miss - hit, 80U);
  EXPECT_LE(miss, 150U);
  EXPECT_EQ(hit, 2 * (1 + 4 + 12 + 1 + 4U)) << "client wire, up, bank, bank's wire, down";
}

TEST(MemorySide, WhatIsAskedForIsAnsweredAndCountedOnceAtEachLevel) {
  MemorySide m(2, L2Config{}, DramConfig{}, InterconnectConfig{});
  random_traffic(m, 8000, 20000, 2);
  m.harness.run();
  std::uint64_t requests = 0, lookups = 0, fills = 0, l2_misses = 0, bytes = 0, dma = 0;
  for (const Requester& r : m.harness.requesters) {
    EXPECT_TRUE(r.done());
    EXPECT_EQ(r.mistakes, 0);
  }
  for (const CorePort& p : m.harness.ports) requests += p.stats().requests;
  for (const L2Bank& b : m.harness.banks) {
    lookups += b.stats().reads;
    fills += b.stats().fills;
    l2_misses += b.stats().misses - b.stats().merges;
  }
  for (const DramChannel& c : m.harness.channels) bytes += c.stats().bytes;
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
        L2Config l2;
        l2.cache.size = {32 * 1024};
        DramConfig dram;
        dram.channels = cores == 1 ? 4 : 2;
        InterconnectConfig net;
        net.link_depth = depth;
        MemorySide m(cores, l2, dram, net);
        random_traffic(m, 3000, cores == 1 ? 1000 : 50000, cores);
        m.client(0, 1).pop_every = 9;
        const sim::Time end = m.harness.run(mode);
        const std::string all = m.harness.everything(end);
        if (mode == Mode::kSkip) expected = all;
        ASSERT_EQ(all, expected) << "depth " << depth << ", cores " << cores;
        for (const sim::UnitReport& r : m.harness.reports()) {
          const std::uint64_t period = r.path == "dram" ? dram.timing.ck.time : kClock.period();
          EXPECT_EQ(r.elapsed, end / period + 1) << r.path;
        }
      }
    }
  }
}

}  // namespace
}  // namespace hw::test
