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

}  // namespace
}  // namespace hw::test
