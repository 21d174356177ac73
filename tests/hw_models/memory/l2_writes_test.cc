#include <algorithm>

#include <gtest/gtest.h>

#include "tests/hw_models/memory/bank_harness.h"

// Tests of writes to an L2 bank. Lines are 64 bytes in eight sectors. At the end the harness makes the bank write back
// all dirty lines.

namespace hw::test {
namespace {

constexpr SectorMask kFirstHalf = 0x0f, kSecondHalf = 0xf0;

L2Config policy(L2Writes writes) {
  L2Config c = BankHarness::small();
  c.writes = writes;
  return c;
}

TEST(L2Writes, AWrittenLineIsReadAsAHitWithoutAFetch) {
  BankHarness b;
  b.core(0).send(640, 0, true);
  b.core(0).send(640);
  b.harness.run();
  EXPECT_EQ(b.core(0).script[1].latency(), kHit);
  EXPECT_EQ(b.stats().fills, 0U);
  EXPECT_EQ(b.stats().stored, 1U);
  EXPECT_EQ(b.written(), 64U) << "flushed";
}

TEST(L2Writes, ASectorIsReadAsAHitIfNoOthersAreRequested) {
  BankHarness b;
  b.core(0).send(640, 0, true, kFirstHalf);
  b.core(0).send(640, 0, false, 0x06);
  b.harness.run();
  EXPECT_EQ(b.core(0).script[1].latency(), kHit);
  EXPECT_EQ(b.stats().fills, 0U);
  EXPECT_EQ(b.written(), 32U);
}

TEST(L2Writes, AReadOfInvalidSectorsFetchesTheLineAroundTheDirtyOnes) {
  BankHarness b;
  b.core(0).send(640, 0, true, kFirstHalf);
  b.core(0).send(640, 10, false, 0x1f);
  b.core(0).send(640, 12, true, kSecondHalf);  // arrives while the line is fetched
  b.core(0).send(640, 100);
  b.harness.run();
  EXPECT_EQ(b.core(0).script[1].latency(), kMiss);
  EXPECT_EQ(b.core(0).script[3].latency(), kHit);
  EXPECT_EQ(b.stats().fills, 1U);
  EXPECT_EQ(b.stats().write_hits, 1U) << "the second write found the line on its way";
  EXPECT_EQ(b.written(), 64U) << "both halves are dirty, and written once";
  EXPECT_EQ(b.stats().written_back, 1U);
}

TEST(L2Writes, ADirtyVictimWritesOnlyItsSectorsToMemory) {
  L2Config c = BankHarness::small();
  BankHarness b(c);
  const Addr stride = 64 * c.cache.set_count();
  b.core(0).send(0, 0, true, 0x01);
  for (Addr i = 1; i <= c.cache.ways; ++i) b.core(0).send(i * stride, 100 * i);
  b.core(0).send(0, 2000);
  b.harness.run();
  EXPECT_EQ(b.written(), 8U);
  EXPECT_EQ(b.stats().written_back, 1U);
  EXPECT_EQ(b.stats().fills, c.cache.ways + 1U) << "the line itself had to be fetched again";
}

TEST(L2Writes, ASectorWrittenTwiceReachesMemoryOnce) {
  BankHarness b;
  for (int i = 0; i < 5; ++i) b.core(0).send(640, 0, true, kFirstHalf);
  b.harness.run();
  EXPECT_EQ(b.written(), 32U);
  EXPECT_EQ(b.stats().bytes_overwritten, 4 * 32U);
  EXPECT_EQ(b.stats().write_hits, 4U);
}

TEST(L2Writes, ABankIsIdleAfterAFlush) {
  BankHarness b;
  b.core(0).send(640, 0, true);
  b.core(0).send(6400, BankHarness::kFlushAt + 1000);
  b.harness.run();
  EXPECT_EQ(b.written(), 64U);
  EXPECT_EQ(b.why(L2Bank::CycleReason::kMemoryFull), 0U);
  EXPECT_GT(b.why(L2Bank::CycleReason::kIdle), BankHarness::kFlushAt + 900);
}

TEST(L2Writes, AWriteIsAcceptedEachCycle) {
  BankHarness b;
  for (Addr i = 0; i < 50; ++i) b.core(0).send(64 * (i % 16), 0, true);
  b.core(0).send(0);
  b.harness.run();
  EXPECT_EQ(b.core(0).script[50].answered, 50 + kHit);
}

TEST(L2Writes, ThroughUpdatesTheLineAndForwardsTheWrite) {
  BankHarness b(policy(L2Writes::kThrough));
  b.core(0).send(640);
  b.core(0).send(640, 100, true, kFirstHalf);
  b.core(0).send(640, 101);
  b.core(0).send(1280, 200, true);
  b.core(0).send(1280, 201);
  b.harness.run();
  EXPECT_EQ(b.core(0).script[2].latency(), kHit);
  EXPECT_EQ(b.core(0).script[4].latency(), kMiss) << "a write brings no line in";
  EXPECT_EQ(b.stats().stored, 1U);
  EXPECT_EQ(b.stats().not_stored, 1U);
  EXPECT_EQ(b.stats().passed_on, 2U);
  EXPECT_EQ(b.written(), 32U + 64U);
}

TEST(L2Writes, AroundInvalidatesTheLineAndForwardsTheWrite) {
  BankHarness b(policy(L2Writes::kAround));
  b.core(0).send(640);
  b.core(0).send(640, 100, true, kFirstHalf);
  b.core(0).send(640, 101);
  b.harness.run();
  EXPECT_EQ(b.core(0).script[2].latency(), kMiss);
  EXPECT_EQ(b.stats().write_hits, 1U);
  EXPECT_EQ(b.stats().stored, 0U);
  EXPECT_EQ(b.written(), 32U);
}

TEST(L2Writes, LatencyIsCountedFromArrivalToLeavingAndTheWaitForMemoryIsPartOfIt) {
  BankHarness b;
  b.core(0).send(640);
  b.core(0).send(640, 200);
  b.core(0).send(640, 200, true);
  b.harness.run();
  EXPECT_EQ(b.stats().latency, (kMiss - 2) + (kHit - 2)) << "without the wires to the bank and from it";
  EXPECT_EQ(b.stats().memory_cycles, kMiss - 3) << "the line leaves in the cycle after its fill";
}

TEST(L2Writes, WritesReachMemoryOnceOrAreOverwrittenInAnyEngine) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    std::string expected;
    for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
      L2Config c = policy(static_cast<L2Writes>(seed % 3));
      c.cache.replacement = static_cast<Replacement>(seed / 3 % 3);
      c.cache.mshrs = seed % 4 == 3 ? 1 : 4;
      c.cache.size = {seed % 2 == 0 ? 512U : 4096U};
      c.targets = seed % 5 == 0 ? 1 : 16;
      const std::size_t capacity = seed % 4 == 1 ? 1 : 8;
      BankHarness b(c, 3, capacity, seed % 4 == 2 ? 1 : 30, static_cast<Arbitration>(seed % 3));
      b.core(1).pop_every = seed == 3 ? 20 : 1;
      for (std::uint64_t i = 0; i < 1200; ++i) {
        const bool write = sim::hash(i, seed, 1) % 2 == 0;
        const auto sectors = static_cast<SectorMask>(sim::hash(i, seed, 2) % 255 + 1);
        b.core(i % 3).send(sim::hash(i, seed) % 100 * 64, i / 400 * 20000 + i % 400 * (seed % 4), write, sectors);
      }
      const sim::Time end = b.harness.run(mode);
      const std::string all = b.harness.everything(end);
      if (mode == Mode::kSkip) expected = all;
      ASSERT_EQ(all, expected) << "seed " << seed;
      const L2Bank::Stats& s = b.stats();
      EXPECT_EQ(s.hits + s.misses, s.reads);
      EXPECT_EQ(s.misses - s.merges, s.fills);
      EXPECT_EQ(s.stored + s.not_stored, s.writes);
      EXPECT_EQ(s.reads + s.writes, 1200U);
      EXPECT_EQ(s.bytes_written, s.bytes_overwritten + s.bytes_to_memory);
      EXPECT_EQ(s.bytes_to_memory, b.written());
      EXPECT_EQ(s.fills + s.passed_on + s.written_back, b.fetched());
      EXPECT_LE(s.memory_cycles, s.latency);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(b.core(i).mistakes, 0);
      std::uint64_t sum = 0;
      for (std::size_t w = 0; w < static_cast<std::size_t>(L2Bank::CycleReason::kCount); ++w)
        sum += b.why(static_cast<L2Bank::CycleReason>(w));
      EXPECT_EQ(sum, kClock.cycles(end) + 1);
    }
  }
}

}  // namespace
}  // namespace hw::test
