#include <gtest/gtest.h>

#include "hw_models/dram/dram_measurements.h"
#include "tests/hw_models/dram/dram_harness.h"

// Tests of page policies, schedulers and a device of two ranks, and of every kind of controller in every engine mode.

namespace hw::test {
namespace {

DramConfig with_policy(PagePolicy policy) {
  return with([&](DramConfig& c) { c.controller.page_policy = policy; });
}

TEST(ClosedPages, MakeEverySingleReadOneOfAClosedBank) {
  Script s(with_policy(PagePolicy::kClosed));
  s.read(0, 1);
  s.read(0, 1, 1000);
  s.read(0, 2, 2000);
  s.go();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(s.latency(i), kForm.closed_bank_latency());
  EXPECT_EQ(s.result.stats.row_misses, 3U);
}

TEST(ClosedPages, StayOpenForHitsThatWait) {
  Script s(with_policy(PagePolicy::kClosed));
  for (Addr i = 0; i < 10; ++i) s.read(0, 1, 0, i);
  s.go();
  EXPECT_EQ(s.result.stats.activates, 1U);
  EXPECT_EQ(s.result.stats.row_hits, 9U);
}

TEST(ClosedPages, ARowIsClosedNoSoonerThanItsTimesAllow) {
  Script s(with_policy(PagePolicy::kClosed));
  s.read(0, 1);
  s.read(0, 2, kT.rcd + 1);  // arrives after row 1's only hit is served
  s.go();
  const std::uint64_t precharge = std::max(kT.ras, kT.rcd + kT.ccd_l + kT.rtp);
  EXPECT_EQ(s.done(1), std::max<std::uint64_t>(precharge + kT.rp, kT.rc) +
                           static_cast<std::uint64_t>(kForm.closed_bank_latency()));
}

TEST(AdaptivePages, AreClosedIfTheNextRequestNeedsAnotherRow) {
  Script s(with_policy(PagePolicy::kAdaptive));
  for (std::uint64_t i = 0; i < 6; ++i) s.read(0, i, 1000 * i);
  s.go();
  EXPECT_EQ(s.latency(1), kForm.row_conflict_latency());
  EXPECT_EQ(s.latency(2), kForm.row_conflict_latency());
  for (const std::size_t i : {3U, 4U, 5U})
    EXPECT_EQ(s.latency(i), kForm.closed_bank_latency()) << "two in a row are enough";
}

TEST(AdaptivePages, StayOpenAgainIfTheNextRequestNeedsTheSameRow) {
  Script s(with_policy(PagePolicy::kAdaptive));
  for (std::uint64_t i = 0; i < 6; ++i) s.read(0, i, 1000 * i);
  for (std::uint64_t i = 6; i < 12; ++i) s.read(0, 5, 1000 * i);
  s.go();
  EXPECT_EQ(s.latency(6), kForm.closed_bank_latency());
  for (const std::size_t i : {9U, 10U, 11U}) EXPECT_EQ(s.latency(i), kForm.row_hit_latency());
}

TEST(Scheduler, FirstComeFirstServedNeitherOvertakesNorPreparesBanks) {
  std::array<Script, 2> scripts{
      Script(DramHarness::quiet()),
      Script(with([](DramConfig& c) { c.controller.scheduler = DramSchedulingPolicy::kFcfs; }))};
  for (Script& s : scripts) {
    s.read(0, 1);
    s.read(0, 2);
    s.read(0, 1, 0, 1);
    s.read(1, 1);
    s.go();
  }
  EXPECT_LT(scripts[0].done(2), scripts[0].done(1)) << "a row hit goes first";
  EXPECT_LT(scripts[0].done(3), scripts[0].done(1)) << "another bank is made ready meanwhile";
  const Script& in_turn = scripts[1];
  for (std::size_t i = 1; i < 4; ++i) EXPECT_LT(in_turn.done(i - 1), in_turn.done(i));
  const std::uint64_t third = in_turn.done(2) - static_cast<std::uint64_t>(kForm.row_hit_latency());
  EXPECT_EQ(in_turn.done(3), third + kT.ca_column + static_cast<std::uint64_t>(kForm.closed_bank_latency()))
      << "the bank is opened in the first gap after the third read's first command";
}

TEST(Ranks, HaveActivateWindowsOfTheirOwn) {
  DramConfig c = with([](DramConfig& d) { d.organisation.ranks = 2; });
  Script s(c);
  s.read(0, 0);
  s.read(8, 0);  // the first bank of the other rank
  s.read(1, 0, 1000);
  s.read(2, 0, 1000);
  s.go();
  EXPECT_EQ(s.done(1) - s.done(0), 2 * kT.burst + kT.rtrs) << "only the data bus keeps them apart";
  EXPECT_EQ(s.done(3) - s.done(2), std::max(kT.rrd, 2 * kT.burst)) << "tRRD, within a rank";
  EXPECT_GT(s.why(DramCycleReason::kRankSwitch), 0U);
}

TEST(Ranks, AreRefreshedInTurn) {
  DramConfig c = with([](DramConfig& d) {
    d.organisation.ranks = 2;
    d.timing.refi_pb = 780;
  });
  Script s(c);
  s.read(0, 0, 780);
  s.read(8, 0, 780);  // its rank's refresh is half an interval later
  s.read(0, 0, 780'000);
  s.go();
  EXPECT_EQ(s.latency(0), kT.rfc_pb - 1 + kForm.closed_bank_latency());
  EXPECT_LT(s.latency(1), kForm.closed_bank_latency() + 2 * kT.burst);
  EXPECT_NEAR(static_cast<double>(s.result.stats.refreshes), 2000.0, 2.0);
  const std::uint64_t cycles = s.done(2);
  EXPECT_EQ(s.result.stats.active_standby + s.result.stats.precharge_standby, 2 * cycles) << "of either rank";
}

TEST(Ranks, AreAboveTheirBanksInTheAddress) {
  DramConfig c = with([](DramConfig& d) {
    d.organisation.ranks = 2;
    d.controller.bank_xor = true;
  });
  const DramMap map(c);
  const Addr pages = c.organisation.page.bytes;
  EXPECT_EQ(map.address_of(7 * pages).bank, 7U);
  EXPECT_EQ(map.address_of(8 * pages).bank, 8U);
  EXPECT_EQ(map.address_of(16 * pages).row, 1U);
  EXPECT_EQ(map.address_of(16 * pages).bank, 1U) << "row 1 changes the bank";
  EXPECT_EQ(map.address_of((8 * 16 + 8) * pages).bank, 8U) << "row 8 does not change the rank";
}

TEST(IdealChannel, AnswersAnyNumberACycleLater) {
  DramHarness b(DramHarness::quiet(), 3, 64, true);
  for (std::uint64_t i = 0; i < 300; ++i) b.requester(i % 3).send(sim::hash(i) % 65536 * 64, 0, i % 5 == 4);
  b.run();
  for (std::size_t r = 0; r < 3; ++r) {
    for (const auto& sent : b.requester(r).script) {
      if (!sent.request.write) {
        EXPECT_EQ(sent.latency(), DramHarness::kWires);
      }
    }
    EXPECT_EQ(b.requester(r).script[99].cycle, 99U) << "no request waits";
  }
  EXPECT_EQ(b.stats().reads + b.stats().writes, 300U);
  EXPECT_EQ(b.stats().read_bursts, 2 * b.stats().reads);
  EXPECT_EQ(b.stats().activates + b.stats().refreshes, 0U);
}

TEST(Controllers, OfEveryKindDoNotDependOnTheEngine) {
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    std::string expected;
    for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
      DramConfig c = DramHarness::quiet();
      c.controller.page_policy = static_cast<PagePolicy>(seed % 3);
      c.controller.refresh = static_cast<RefreshKind>(seed / 3 % 2);
      c.controller.power_down = seed / 6 % 2 == 1;
      c.controller.power_down_after = seed % 5 == 0 ? 1 : 160;
      c.controller.scheduler = static_cast<DramSchedulingPolicy>(sim::hash(seed) % 2);
      c.controller.bank_xor = seed % 2 == 1;
      c.organisation.ranks = seed / 12 % 2 + 1;
      c.organisation.refresh_banks = sim::hash(seed, 1) % 2 + 1;
      c.timing.refi_pb = 780;
      c.timing.refi_ab = 1600;
      const bool ideal = seed == 23;
      DramHarness b(c, 3, seed % 4 == 0 ? 1 : 8, ideal);
      b.requester(0).pop_every = seed % 7 == 0 ? 50 : 1;
      for (std::uint64_t i = 0; i < 900; ++i) {
        const std::uint64_t pause = i / 150 * 4321;
        b.requester(i % 3).send(sim::hash(i, seed) % (seed % 2 == 0 ? 100000 : 512) * 64, pause + i % 150 * (seed % 4),
                                sim::hash(i, seed, 1) % 3 == 0);
      }
      const std::uint64_t cycles = b.run(mode);
      std::uint64_t spent = 0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(DramCycleReason::kCount); ++i) {
        spent += b.why(static_cast<DramCycleReason>(i));
      }
      EXPECT_EQ(spent, cycles);
      const DramChannel::Stats& s = b.stats();
      EXPECT_EQ(s.active_standby + s.precharge_standby + s.power_down, c.organisation.ranks * cycles);
      // The second share is what remains, so their sum is right even if they overlap.
      for (const std::uint64_t part : {s.active_standby, s.precharge_standby, s.power_down}) {
        EXPECT_LE(part, c.organisation.ranks * cycles) << "seed " << seed;
      }
      EXPECT_EQ(s.reads + s.writes, 900U);
      const std::string all = b.harness.everything(b.end);
      if (mode == Mode::kSkip) expected = all;
      ASSERT_EQ(all, expected) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace hw::test
