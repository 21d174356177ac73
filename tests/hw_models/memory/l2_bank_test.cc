#include <gtest/gtest.h>

#include "tests/hw_models/memory/harness.h"

namespace hw::test {
namespace {

const sim::Clock kClock(2'000'000);

/// Cores, one bank, and a memory whose answers take `memory` cycles.
struct BankBench {
  explicit BankBench(L2Config config = small(), std::size_t cores = 2, std::size_t capacity = 64,
                     std::uint64_t memory = 50) {
    L2Bank::Links links;
    for (std::size_t i = 0; i < cores; ++i) {
      auto& up = bench.link<MemRequest>(capacity, 1, kClock, kClock);
      auto& down = bench.link<MemResponse>(capacity, 1, kClock, kClock);
      bench.requesters.emplace_back(kClock, up, down);
      bench.connect(up, i, cores);
      bench.connect(down, cores, i);
      links.cores_in.push_back(&up);
      links.cores_out.push_back(&down);
    }
    auto& up = bench.link<MemRequest>(capacity, 1, kClock, kClock);
    auto& down = bench.link<MemResponse>(capacity, memory, kClock, kClock);
    bench.echoes.emplace_back(kClock, up, down);
    bench.connect(up, cores, cores + 1);
    bench.connect(down, cores + 1, cores);
    links.channels_out.push_back(&up);
    links.channels_in.push_back(&down);
    bench.banks.emplace_back(config, std::uint16_t{0}, links, Interleave(64, 1), kClock);
  }

  static L2Config small() {
    L2Config c;
    c.cache.size = {8192};
    c.banks = 1;
    c.cache.mshrs = 4;
    return c;
  }

  Requester& core(std::size_t i) { return *std::next(bench.requesters.begin(), static_cast<long>(i)); }
  const L2Bank::Stats& stats() { return bench.banks.front().stats(); }
  std::uint64_t fetched() { return bench.echoes.front().requests; }
  std::uint64_t why(L2Bank::Why w) { return kClock.cycles(bench.banks.front().activity().spent(w)); }

  Bench bench;
};

constexpr std::uint64_t kHit = 1 + 12 + 1;               // wire, hit_cycles, wire
constexpr std::uint64_t kMiss = 1 + 4 + 1 + 50 + 1 + 1;  // wire, lookup, wire, memory, fill, wire

TEST(L2Bank, AMissTakesLookUpMemoryAndFillAHitItsPipe) {
  BankBench b;
  b.core(0).send(640);
  b.core(0).send(640, 200);
  b.bench.run();
  EXPECT_EQ(b.core(0).script[0].latency(), kMiss);
  EXPECT_EQ(b.core(0).script[1].latency(), kHit);
  EXPECT_EQ(b.stats().hits, 1U);
  EXPECT_EQ(b.stats().fills, 1U);
}

TEST(L2Bank, HitsLeaveOnePerCycle) {
  BankBench b;
  b.core(0).send(0);
  for (std::uint64_t i = 0; i < 30; ++i) b.core(0).send(0, 200);
  b.bench.run();
  EXPECT_EQ(b.core(0).script[30].answered, 200 + 29 + kHit);
}

TEST(L2Bank, ALineOnItsWayIsFetchedOnceForAllWhoWant) {
  BankBench b;
  for (std::size_t core : {0U, 1U})
    for (int i = 0; i < 3; ++i) b.core(core).send(640);
  b.bench.run();
  EXPECT_EQ(b.fetched(), 1U);
  EXPECT_EQ(b.stats().merges, 5U);
  EXPECT_EQ(b.stats().misses, 6U);
  EXPECT_EQ(b.core(1).script[2].answered, kMiss + 5) << "one answer per cycle";
}

TEST(L2Bank, FullMissRegistersHoldUpTheHeadAndAllBehindIt) {
  BankBench b;
  b.core(0).send(6400);
  for (Addr i = 0; i < 5; ++i) b.core(0).send(64 * i, 200);
  b.core(0).send(6400, 200);
  b.bench.run();
  EXPECT_EQ(b.core(0).script[4].answered - 200, kMiss + 3) << "the fourth miss register";
  const std::uint64_t fill = kMiss - 2;  // a reply and a wire before the first answer: a miss register is free again
  EXPECT_EQ(b.core(0).script[5].answered - 200, fill + kMiss - 1) << "from there as any miss, but for the first wire";
  EXPECT_GT(b.core(0).script[6].latency(), kHit + 40) << "a hit, but behind it";
  EXPECT_GT(b.why(L2Bank::Why::kMshrFull), 40U);
}

TEST(L2Bank, ALinesTargetsAreLimited) {
  L2Config c = BankBench::small();
  c.targets = 2;
  BankBench b(c);
  for (int i = 0; i < 5; ++i) b.core(0).send(640);
  b.bench.run();
  EXPECT_EQ(b.stats().merges, 1U);
  EXPECT_EQ(b.stats().hits, 3U) << "those that waited in the head find the line filled";
  EXPECT_EQ(b.fetched(), 1U);
}

TEST(L2Bank, RandomTrafficDoesNotDependOnHowTheEngineVisitsIt) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    std::string expected;
    for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
      L2Config c = BankBench::small();
      c.cache.mshrs = seed < 3 ? 4 : 1;
      c.targets = seed % 2 == 0 ? 16 : 2;
      BankBench b(c, 3, seed == 1 ? 1 : seed == 2 ? 16 : 4, seed == 4 ? 1 : 50);
      b.core(1).pop_every = seed == 3 ? 20 : 1;
      for (std::uint64_t i = 0; i < 1500; ++i)
        b.core(i % 3).send(sim::hash(i, seed) % (128 * seed) * 64, i / 500 * 20000 + i % 500 * (seed - 1));
      const sim::Time end = b.bench.run(mode);
      const std::string all = b.bench.everything(end);
      if (mode == Mode::kSkip) expected = all;
      ASSERT_EQ(all, expected) << "seed " << seed;
      const L2Bank::Stats& s = b.stats();
      EXPECT_EQ(s.reads, 1500U);
      EXPECT_EQ(s.hits + s.misses, s.reads);
      EXPECT_EQ(s.misses - s.merges, s.fills);
      EXPECT_EQ(s.fills, b.fetched());
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(b.core(i).mistakes, 0);
      std::uint64_t sum = 0;
      for (std::size_t w = 0; w < static_cast<std::size_t>(L2Bank::Why::kCount); ++w)
        sum += b.why(static_cast<L2Bank::Why>(w));
      EXPECT_EQ(sum, kClock.cycles(end) + 1);
    }
  }
}

}  // namespace
}  // namespace hw::test
