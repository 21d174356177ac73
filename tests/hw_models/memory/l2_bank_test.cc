#include "hw_models/memory/l2_bank.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/memory/tile_accounting.h"
#include "tests/hw_models/memory/bank_harness.h"

namespace hw::test {
namespace {

TEST(L2Bank, AMissTakesLookUpMemoryAndFillAHitItsPipe) {
  BankHarness b;
  b.core(0).send(640);
  b.core(0).send(640, 200);
  b.harness.run();
  EXPECT_EQ(b.core(0).script[0].latency(), kMiss);
  EXPECT_EQ(b.core(0).script[1].latency(), kHit);
  EXPECT_EQ(b.stats().hits, 1U);
  EXPECT_EQ(b.stats().fills, 1U);
}

/// Observer that lists hits and misses in order.
struct Lookups : Observer {
  void on_event(const Event& event) override {
    if (const auto* lookup = std::get_if<L2LookedUp>(&event)) hits.push_back(lookup->hit);
  }
  std::vector<bool> hits;
};

TEST(L2Bank, ReportsEachLineThatIsReadOnce) {
  Lookups lookups;
  BankHarness b(BankHarness::small(), 1, 64, 50, Arbitration::kRoundRobin, false, &lookups);
  b.core(0).send(640);
  for (const std::uint64_t cycle : {200U, 300U}) b.core(0).send(640, cycle);
  b.harness.run();
  EXPECT_EQ(lookups.hits, (std::vector<bool>{false, true, true}));
}

TEST(L2Bank, ChargesHitsMissesAndFillsToTheRequester) {
  TileAccounting accounting(1);
  BankHarness b(BankHarness::small(), 1, 64, 50, Arbitration::kRoundRobin, false, &accounting);
  b.core(0).send(640);
  for (const std::uint64_t cycle : {200U, 300U}) b.core(0).send(640, cycle);
  b.harness.run();
  EXPECT_EQ(accounting.account_without_tile().l2_hits, 2U) << "the harness sends requests for no tile";
  EXPECT_EQ(accounting.account_without_tile().l2_misses, 1U);
  EXPECT_EQ(accounting.account_without_tile().l2_fills, 1U);
}

TEST(TileAccounting, CountsEventsForTheirTile) {
  TileAccounting accounting(2);
  accounting.on_event(TileDispatched{0, 0, 10});
  accounting.on_event(TileDispatched{1, 3, 20});
  for (int i = 0; i < 3; ++i) accounting.on_event(RowActivated{1});
  accounting.on_event(RowActivated{kNoTile});
  accounting.on_event(TileFinished{0, 30});
  EXPECT_EQ(accounting.tiles()[0].activates, 0U);
  EXPECT_EQ(accounting.tiles()[0].finished, 30U);
  EXPECT_EQ(accounting.tiles()[1].activates, 3U);
  EXPECT_EQ(accounting.tiles()[1].core, 3U);
  EXPECT_EQ(accounting.tiles()[1].dispatched, 20U);
  EXPECT_EQ(accounting.account_without_tile().activates, 1U);
}

TEST(TileAccounting, CountsLinesByTheirRequester) {
  TileAccounting accounting(1);
  accounting.on_event(TileDispatched{0, 0, 0});
  for (int i = 0; i < 2; ++i) accounting.on_event(LineRequested{0, RequesterKind::kTriangles});
  EXPECT_EQ(accounting.tiles()[0].lines[static_cast<std::size_t>(RequesterKind::kTriangles)], 2U);
  EXPECT_EQ(accounting.tiles()[0].lines[static_cast<std::size_t>(RequesterKind::kNodes)], 0U);
}

TEST(ObserverList, ForwardsEventsToAllAndIsNullIfEmpty) {
  ObserverList none, one, two;
  TileAccounting first(1), second(1);
  none.add(nullptr);
  one.add(&first);
  two.add(&first);
  two.add(&second);
  EXPECT_EQ(none.attached_observer(), nullptr);
  EXPECT_EQ(one.attached_observer(), &first);
  two.attached_observer()->on_event(RowActivated{kNoTile});
  EXPECT_EQ(first.account_without_tile().activates, 1U);
  EXPECT_EQ(second.account_without_tile().activates, 1U);
}

TEST(TileTag, GivesTheNumberOfATileRelativeToAnotherInFlightAcrossTagWrapAround) {
  constexpr std::uint32_t kTags = 0x8000;
  EXPECT_EQ(tile_number_of_tag(12, 10), 12U);
  EXPECT_EQ(tile_number_of_tag(8, 10), 8U);
  EXPECT_EQ(tile_number_of_tag(3, kTags - 2), kTags + 3);
  EXPECT_EQ(tile_number_of_tag(kTags - 2, kTags + 3), kTags - 2);
}

TEST(L2Bank, HitsLeaveOnePerCycle) {
  BankHarness b;
  b.core(0).send(0);
  for (std::uint64_t i = 0; i < 30; ++i) b.core(0).send(0, 200);
  b.harness.run();
  EXPECT_EQ(b.core(0).script[30].answered, 200 + 29 + kHit);
}

TEST(L2Bank, AnOutstandingLineIsFetchedOnceForAllRequesters) {
  BankHarness b;
  for (std::size_t core : {0U, 1U})
    for (int i = 0; i < 3; ++i) b.core(core).send(640);
  b.harness.run();
  EXPECT_EQ(b.fetched(), 1U);
  EXPECT_EQ(b.stats().merges, 5U);
  EXPECT_EQ(b.stats().misses, 6U);
  EXPECT_EQ(b.core(1).script[2].answered, kMiss + 5) << "one answer per cycle";
}

TEST(L2Bank, FullMshrsBlockTheHeadAndAllLaterRequests) {
  BankHarness b;
  b.core(0).send(6400);
  for (Addr i = 0; i < 5; ++i) b.core(0).send(64 * i, 200);
  b.core(0).send(6400, 200);
  b.harness.run();
  EXPECT_EQ(b.core(0).script[4].answered - 200, kMiss + 3) << "the fourth MSHR";
  const std::uint64_t fill = kMiss - 2;  // the first answer, minus a reply and a link: an MSHR is free again
  EXPECT_EQ(b.core(0).script[5].answered - 200, fill + kMiss - 1) << "from there as any miss, but for the first wire";
  EXPECT_GT(b.core(0).script[6].latency(), kHit + 40) << "a hit, but behind it";
  EXPECT_GT(b.why(L2Bank::CycleReason::kMshrFull), 40U);
}

TEST(L2Bank, ALinesTargetsAreLimited) {
  L2Config c = BankHarness::small();
  c.targets = 2;
  BankHarness b(c);
  for (int i = 0; i < 5; ++i) b.core(0).send(640);
  b.harness.run();
  EXPECT_EQ(b.stats().merges, 1U);
  EXPECT_EQ(b.stats().hits, 3U) << "those that waited in the head find the line filled";
  EXPECT_EQ(b.fetched(), 1U);
}

TEST(L2Bank, RandomTrafficDoesNotDependOnHowTheEngineVisitsIt) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    std::string expected;
    for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
      L2Config c = BankHarness::small();
      c.cache.mshrs = seed < 3 ? 4 : 1;
      c.targets = seed % 2 == 0 ? 16 : 2;
      BankHarness b(c, 3, seed == 1 ? 1 : seed == 2 ? 16 : 4, seed == 4 ? 1 : 50);
      b.core(1).pop_every = seed == 3 ? 20 : 1;
      for (std::uint64_t i = 0; i < 1500; ++i)
        b.core(i % 3).send(sim::hash(i, seed) % (128 * seed) * 64, i / 500 * 20000 + i % 500 * (seed - 1));
      const sim::Time end = b.harness.run(mode);
      const std::string all = b.harness.everything(end);
      if (mode == Mode::kSkip) expected = all;
      ASSERT_EQ(all, expected) << "seed " << seed;
      const L2Bank::Stats& s = b.stats();
      EXPECT_EQ(s.reads, 1500U);
      EXPECT_EQ(s.hits + s.misses, s.reads);
      EXPECT_EQ(s.misses - s.merges, s.fills);
      EXPECT_EQ(s.fills, b.fetched());
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(b.core(i).mistakes, 0);
      std::uint64_t sum = 0;
      for (std::size_t w = 0; w < static_cast<std::size_t>(L2Bank::CycleReason::kCount); ++w)
        sum += b.why(static_cast<L2Bank::CycleReason>(w));
      EXPECT_EQ(sum, kClock.cycles(end) + 1);
    }
  }
}

TEST(L2Bank, HasRoomForTwoRequestsToMemoryForEachMshrAndTwoMore) {
  L2Config config = BankHarness::small();
  config.writes = L2Writes::kAround;
  constexpr std::uint64_t kMemory = 1'000;
  // Memory has one answer in flight at a time, so it accepts the second read after the first answer.
  BankHarness b(config, 1, 1, kMemory);
  for (Addr i = 0; i < 2; ++i) b.core(0).send(64 * i);
  for (Addr i = 2; i < 40; ++i) b.core(0).send(64 * i, 0, true);
  b.harness.run();
  std::uint32_t writes = 0;
  for (std::size_t i = 2; i < 40; ++i) writes += b.core(0).script[i].cycle < kMemory;
  // All room of the bank except for the two misses; one more write waits in the bank, and one in the port.
  EXPECT_EQ(writes, 2 * config.cache.mshrs + 2 - 2 + 1 + 1);
}

/// Returns a store of four sets of one line each, so that slot n has line n.
L2Config four_lines() {
  L2Config c;
  c.banks = 1;
  c.cache.size = {256};
  c.cache.ways = 1;
  return c;
}

TEST(L2Store, IsCleanedInTheOrderOfItsSlotsWithWrapAround) {
  L2Store store(four_lines());
  for (const Addr line : {192U, 64U, 0U}) store.allocate(line, kWholeLine, 0b1);
  EXPECT_EQ(store.dirty_lines(), 3U);
  EXPECT_EQ(store.clean_next_dirty_line().line, 0U);
  EXPECT_EQ(store.clean_next_dirty_line().line, 64U);
  store.write_sectors(0, 0b1000);
  EXPECT_EQ(store.clean_next_dirty_line().line, 192U);
  const L2Store::Victim last = store.clean_next_dirty_line();
  EXPECT_EQ(last.line, 0U);
  EXPECT_EQ(last.sectors, 0b1000U);
  EXPECT_EQ(store.dirty_lines(), 0U);
}

TEST(L2Store, DistinguishesPartialFromWholeLines) {
  L2Store store(four_lines());
  EXPECT_EQ(store.look_up(64, 0b1), L2Store::LookupResult::kNot);
  store.allocate(64, 0b0011, 0b0001);
  EXPECT_EQ(store.look_up(64, 0b0011), L2Store::LookupResult::kAll);
  EXPECT_EQ(store.look_up(64, 0b0110), L2Store::LookupResult::kPart);
  EXPECT_EQ(store.write_sectors(64, 0b0101), 0b0001U) << "dirty before";
  EXPECT_EQ(store.look_up(64, 0b0111), L2Store::LookupResult::kAll);
  EXPECT_EQ(store.invalidate_line(64), 0b0101U) << "what is dirty";
  EXPECT_EQ(store.look_up(64, 0b1), L2Store::LookupResult::kNot);
}

TEST(L2Store, ReturnsOnlyTheDirtySectorsOfAVictim) {
  L2Store store(four_lines());
  store.allocate(64, kWholeLine, 0b1010);
  const L2Store::Victim victim = store.allocate(64 + 256, kWholeLine, 0);
  EXPECT_EQ(victim.line, 64U);
  EXPECT_EQ(victim.sectors, 0b1010U);
  EXPECT_EQ(store.dirty_lines(), 0U);
  EXPECT_EQ(store.allocate(64, kWholeLine, 0).sectors, 0U) << "it was clean";
}

// Tests of writes to an L2 bank. Lines are 64 bytes in eight sectors. At the end the harness makes the bank write back
// all dirty lines.

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
