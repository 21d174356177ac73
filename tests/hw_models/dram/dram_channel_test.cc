#include <numeric>

#include <gtest/gtest.h>

#include "tests/hw_models/dram/dram_harness.h"

namespace hw::test {
namespace {

// Expected latencies below are sums of JEDEC parameters, in cycles of the command clock.
constexpr std::uint64_t kWires = DramHarness::kWires;
const std::uint64_t kLine = 2 * kT.burst;
const std::uint64_t kHit = kT.rl + kT.dqsck + kLine;

TEST(DramChannel, ASingleReadOfAClosedBankTakesActivateReadAndTwoBursts) {
  DramHarness b;
  b.requester().send(b.row(3, 5));
  b.run();
  EXPECT_EQ(b.latency(0), kT.rcd + kHit + kWires);
  EXPECT_EQ(b.latency(0) - kWires, 76U) << "29 + 28 + 3 + 16 at LPDDR4-3200";
  EXPECT_EQ(b.stats().row_misses, 1U);
  EXPECT_EQ(b.stats().activates, 1U);
  EXPECT_EQ(b.stats().read_bursts, 2U);
}

TEST(DramChannel, ARowHitTakesOnlyTheRead) {
  DramHarness b;
  b.requester().send(b.row(0, 1));
  b.requester().send(b.row(0, 1) + 64, 500);
  b.run();
  EXPECT_EQ(b.latency(1), kHit + kWires);
  EXPECT_EQ(b.stats().row_hits, 1U);
}

TEST(DramChannel, ARowConflictTakesPrechargeActivateAndRead) {
  DramHarness b;
  b.requester().send(b.row(0, 1));
  b.requester().send(b.row(0, 2), 500);
  b.run();
  EXPECT_EQ(b.latency(1), kT.rp + kT.rcd + kHit + kWires);
  EXPECT_EQ(b.stats().row_conflicts, 1U);
}

TEST(DramChannel, AnEarlyRowConflictWaitsForTheRowsMinimumTime) {
  DramHarness b;
  b.requester().send(b.row(0, 1));
  b.requester().send(b.row(0, 2));
  b.run();
  const std::uint64_t precharge = std::max(kT.ras, kT.rcd + kT.ccd_l + kT.rtp);
  EXPECT_EQ(b.requester().script[1].answered,
            kWires + std::max<std::uint64_t>(precharge + kT.rp, kT.rc) + kT.rcd + kHit);
  EXPECT_GT(b.why(DramCycleReason::kRowConflict), 0U);
}

TEST(DramChannel, RowHitsFollowEachOtherWithoutAGapOnTheDataBus) {
  DramHarness b;
  for (Addr i = 0; i < 32; ++i) b.requester().send(b.row(0, 0) + 64 * i);
  b.run();
  EXPECT_EQ(b.requester().script[31].answered, kWires + kT.rcd + kHit + 31 * kLine);
  EXPECT_EQ(b.why(DramCycleReason::kReading), 32 * kLine);
}

TEST(DramChannel, TheFabricIsPartOfEveryReadsLatency) {
  DramConfig c = DramHarness::quiet();
  c.fabric = {50'000'000};
  DramHarness b(c);
  b.requester().send(0);
  b.run();
  EXPECT_EQ(b.latency(0), kT.rcd + kHit + kWires + 80) << "50 ns are 80 cycles of 0.625 ns";
}

TEST(DramChannel, FourActivatesFillTheWindow) {
  DramConfig c = DramHarness::quiet();
  c.timing.faw = 120;
  c.timing.ca_activate = c.timing.ca_column = 1;
  DramHarness b(c);
  for (std::uint32_t bank = 0; bank < 8; ++bank) b.requester().send(b.row(bank, 0));
  b.run();
  for (std::uint64_t i = 0; i < 8; ++i) {
    const std::uint64_t activate = i / 4 * 120 + i % 4 * kT.rrd;
    EXPECT_EQ(b.requester().script[i].answered, kWires + activate + kT.rcd + kHit);
  }
}

TEST(DramChannel, AReadAfterAWriteWaitsForTheTurnaround) {
  DramHarness b;
  b.requester().send(b.row(0, 0), 0, true);
  b.requester().send(b.row(0, 0) + 64, kT.rcd + 1);
  b.run();
  const std::uint64_t write = 1 + kT.rcd;  // arrival, activate
  const std::uint64_t read = write + kT.ccd_l + kT.wl + kT.dqss + kT.burst + kT.wtr_s;
  EXPECT_EQ(b.requester().script[1].answered, read + kHit + 1);
  EXPECT_GT(b.why(DramCycleReason::kTurnaround), 0U);
  EXPECT_EQ(b.stats().turnarounds, 2U) << "to the write and back";
}

TEST(DramChannel, ARequestToARefreshingBankWaitsForTheRefresh) {
  DramConfig c = DramHarness::quiet();
  c.timing.refi_pb = 780;
  DramHarness b(c);
  b.requester().send(b.row(0, 0), 780);
  b.run();
  EXPECT_EQ(b.requester().script[0].answered, 780 + kT.rfc_pb + kT.rcd + kHit + 1);
  EXPECT_GT(b.why(DramCycleReason::kRefresh), 0U);
}

TEST(DramChannel, RefreshesContinueInAnIdleChannel) {
  DramConfig c = DramHarness::quiet();
  c.timing.refi_pb = 780;
  DramHarness b(c);
  b.requester().send(b.row(7, 0));
  b.requester().send(b.row(7, 0), 1'000'000);
  const std::uint64_t cycles = b.run();
  EXPECT_EQ(b.stats().refreshes, cycles / 780);
  EXPECT_EQ(b.stats().row_misses, 2U) << "a refresh closed the row in between";
  EXPECT_EQ(b.stats().active_standby + b.stats().precharge_standby, cycles);
  EXPECT_LT(b.stats().active_standby, 780U * 9) << "the row stays open until the refresh of its bank";
}

TEST(DramChannel, RefreshCostsAStreamLessThanItsShareOfTime) {
  std::uint64_t cycles[2];
  for (const int with : {0, 1}) {
    DramConfig c = DramHarness::quiet();
    c.timing.refi_pb = with ? 780 : 0;
    DramHarness b(c);
    for (Addr i = 0; i < 20000; ++i) b.requester().send(64 * i);
    cycles[with] = b.run();
  }
  EXPECT_GT(cycles[1], cycles[0]);
  EXPECT_LT(static_cast<double>(cycles[1]) / static_cast<double>(cycles[0]), 1.0 + 1.2 * kT.rfc_pb / 780.0 / 8);
}

TEST(DramChannel, AStreamOfRowHitsCannotStarveAnotherRow) {
  std::uint64_t worst[2];
  for (const int limited : {0, 1}) {
    DramConfig c = DramHarness::quiet();
    c.organisation.page = {1 << 16};
    c.controller.age_limit = limited ? 500 : 1'000'000;
    DramHarness b(c, 2);
    for (Addr i = 0; i < 900; ++i) b.requester(0).send(b.row(0, 0) + 64 * i);
    b.requester(1).send(b.row(0, 1), 200);
    b.run();
    worst[limited] = b.requester(1).script[0].latency();
  }
  EXPECT_GT(worst[0], 900 * kLine - 500) << "without the limit it waits for the whole stream";
  EXPECT_LT(worst[1], 500 + kT.rtp + kT.rp + kT.rc + kT.rcd + 4 * kHit);
}

TEST(DramChannel, SaturatingReadsCannotStarveAWriteNorWritesARead) {
  for (const bool writes : {false, true}) {
    DramConfig c = DramHarness::quiet();
    c.controller.age_limit = 800;
    DramHarness b(c, 2);
    for (Addr i = 0; i < 3000; ++i) b.requester(0).send(sim::hash(i) % 4096 * 64, 0, writes);
    b.requester(1).send(b.row(2, 9), 2000, !writes);
    b.requester(1).send(b.row(3, 9), 2001, false);
    b.run();
    EXPECT_LT(b.requester(1).script[1].answered, 2001U + 4 * 800U);
  }
}

TEST(DramChannel, WritesWaitForTheirMarkWhileReadsGo) {
  DramConfig c = DramHarness::quiet();
  c.controller.age_limit = 100'000;
  DramHarness b(c, 2);
  for (Addr i = 0; i < 400; ++i) b.requester(0).send(64 * i);
  for (Addr i = 0; i < 20; ++i) b.requester(1).send((1 << 20) + 64 * i, 100, true);
  b.run();
  EXPECT_EQ(b.stats().turnarounds, 1U) << "20 writes stay below the mark of 24 and go when the reads are done";
  EXPECT_EQ(b.requester(0).script[399].answered, kWires + kT.rcd + kHit + 399 * kLine);
}

TEST(DramChannel, AtTheirHighMarkWritesGoFirstDownToTheLowMark) {
  DramConfig c = DramHarness::quiet();
  c.controller.write_queue = c.controller.write_high = 24;
  DramHarness b(c, 2);
  for (Addr i = 0; i < 30; ++i) b.requester(0).send(64 * i, 0, true);
  b.requester(1).send(b.row(0, 0) + 30 * 64, 100);
  b.run();
  const std::uint64_t last_write = 1 + kT.rcd + (30 - c.controller.write_low - 1) * kLine;
  const std::uint64_t read = last_write + kT.ccd_l + kT.wl + kT.dqss + kT.burst + kT.wtr_s;
  EXPECT_EQ(b.requester(1).script[0].answered, read + kHit + 1);
}

TEST(DramChannel, EverythingThatEntersLeavesAndIsCounted) {
  DramConfig c = DramHarness::quiet();
  c.timing.refi_pb = 780;
  DramHarness b(c, 3);
  for (std::uint64_t i = 0; i < 3000; ++i)
    b.requester(i % 3).send(sim::hash(i) % 65536 * 64, 4 * i, sim::hash(i, 1) % 3 == 0);
  const std::uint64_t cycles = b.run();
  const DramChannel::Stats& s = b.stats();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(b.requester(i).done());
    EXPECT_EQ(b.requester(i).mistakes, 0);
  }
  EXPECT_EQ(s.reads + s.writes, 3000U);
  EXPECT_EQ(s.bytes, 3000U * 64);
  EXPECT_EQ(s.read_bursts, 2 * s.reads);
  EXPECT_EQ(s.write_bursts, 2 * s.writes);
  EXPECT_EQ(s.row_hits + s.row_misses + s.row_conflicts, 3000U);
  EXPECT_GE(s.activates, s.row_misses + s.row_conflicts);
  EXPECT_EQ(s.active_standby + s.precharge_standby, cycles);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(DramCycleReason::kCount); ++i)
    sum += b.why(static_cast<DramCycleReason>(i));
  EXPECT_EQ(sum, cycles);
}

TEST(DramChannel, ASlowClientIsChargedToReturnsFullAndStillServed) {
  DramHarness b(DramHarness::quiet(), 1, 1);
  b.requester().pop_every = 100;
  for (Addr i = 0; i < 200; ++i) b.requester().send(64 * i);
  b.run();
  EXPECT_TRUE(b.requester().done());
  EXPECT_GT(b.why(DramCycleReason::kReturnsFull), 10'000U);
}

TEST(DramChannel, RandomTrafficDoesNotDependOnHowTheEngineVisitsIt) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
    std::string expected;
    for (const Mode mode : {Mode::kSkip, Mode::kEveryEdge, Mode::kShuffled}) {
      DramConfig c = DramHarness::quiet();
      c.timing.refi_pb = seed % 2 == 0 ? 780 : 97;
      c.timing.rfc_pb = seed % 2 == 0 ? 224 : 40;
      c.controller.age_limit = seed % 3 == 0 ? 60 : 1600;
      c.controller.read_queue = seed < 4 ? 32 : 1;
      c.controller.write_queue = seed < 4 ? 32 : 2;
      c.controller.write_high = seed < 4 ? 24 : 2;
      c.controller.write_low = seed < 4 ? 8 : 0;
      c.fabric = {sim::Time{10'000'000} * (seed % 4)};
      if (seed == 2) c.controller.refresh_order = RefreshOrder::kRoundRobin;
      if (seed == 3) c.organisation.bank_groups = 4, c.timing.ccd_s = c.timing.burst = 2, c.timing.ccd_l = 4;
      DramHarness b(c, 3, seed % 2 == 0 ? 1 : 8);
      b.requester(0).pop_every = seed == 5 ? 50 : 1;
      b.requester(2).most_outstanding = 2;
      for (std::uint64_t i = 0; i < 1500; ++i) {
        const std::uint64_t pause = i / 300 * 5000;
        b.requester(i % 3).send(sim::hash(i, seed) % (seed == 1 ? 100000 : 512) * 64, pause + i % 300 * seed,
                                sim::hash(i, seed, 1) % 3 == 0);
      }
      b.run(mode);
      const std::string all = b.harness.everything(b.end);
      if (mode == Mode::kSkip) expected = all;
      ASSERT_EQ(all, expected) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace hw::test
