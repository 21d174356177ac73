#include <numeric>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_measurements.h"
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

TEST(IdealChannel, ReadsAndWritesInTheCycleOfARequestsArrival) {
  DramHarness b(DramHarness::quiet(), 1, 64, true);
  b.requester().send(0, 0);
  b.requester().send(64, 5, true);
  b.requester().send(128, 9, true);
  b.requester().send(192, 20);
  const std::uint64_t cycles = b.run();
  EXPECT_EQ(b.why(DramCycleReason::kReading), 2U);
  EXPECT_EQ(b.why(DramCycleReason::kWriting), 2U);
  EXPECT_EQ(b.why(DramCycleReason::kIdle), cycles - 4);
}

TEST(IdealChannel, WaitsForAFullPort) {
  constexpr std::uint64_t kLongAfter = 1'000;
  DramHarness b(DramHarness::quiet(), 1, 1, true);
  b.requester().pop_every = kLongAfter;
  b.requester().send(0);
  b.requester().send(64);
  b.run();
  EXPECT_EQ(b.why(DramCycleReason::kReading), 2U);
  EXPECT_GT(b.why(DramCycleReason::kReturnsFull), kLongAfter - 10);
  EXPECT_LE(b.why(DramCycleReason::kReturnsFull), kLongAfter);
  EXPECT_EQ(b.requester().script[1].answered, 2 * kLongAfter);
}

// Tests of reads whose data wait in the channel because their port is full.

constexpr std::uint64_t kLongAfter = 10'000;

/// Simulates hits of one row through a port with room for one answer. The requester takes one every `kLongAfter`
/// cycles.
struct SlowPort : DramHarness {
  explicit SlowPort(std::uint32_t reads, DramConfig c = quiet()) : DramHarness(c, 1, 1) {
    requester().pop_every = kLongAfter;
    for (Addr i = 0; i < reads; ++i) requester().send(64 * i);
    run();
  }
};

/// Reads in flight last RL + tDQSCK + a line = 28 + 3 + 16 cycles, which is 2 lines. The channel has room for twice (2
/// + 4) lines.
constexpr std::uint32_t kRoom = 2 * (2 + 4);

TEST(DramReturns, HaveRoomForTwiceWhatIsInFlightAndFourMore) {
  SlowPort s(1 + kRoom);
  EXPECT_LT(s.stats().read_latency_max, kLongAfter) << "one in the port, the others in the channel";
}

TEST(DramReturns, StopReadsThatFindNoRoom) {
  SlowPort s(1 + kRoom + 1);
  EXPECT_GT(s.stats().read_latency_max, kLongAfter - 100);
  EXPECT_GT(s.why(DramCycleReason::kReturnsFull), kLongAfter - 500);
}

TEST(DramReturns, HaveMoreRoomForALongerFabric) {
  DramConfig c = DramHarness::quiet();
  c.fabric = {17 * c.timing.ck.time};  // 64 cycles in flight: 4 lines
  SlowPort enough(1 + 2 * (4 + 4), c);
  EXPECT_LT(enough.stats().read_latency_max, kLongAfter);
  SlowPort one_more(1 + 2 * (4 + 4) + 1, c);
  EXPECT_GT(one_more.stats().read_latency_max, kLongAfter - 100);
}

// Tests of refreshes of banks, pairs of banks and whole ranks, and of power-down.

TEST(AllBankRefresh, KeepsEveryBankBusy) {
  DramConfig c = with([](DramConfig& d) {
    d.controller.refresh = RefreshKind::kAllBank;
    d.timing.refi_ab = 6246;
  });
  Script s(c);
  s.read(3, 0, 6246);
  s.read(5, 0, 12'400);  // leaves a row open until the next refresh
  s.read(6, 0, 2 * 6246);
  s.go();
  const auto closed = static_cast<std::uint64_t>(kForm.closed_bank_latency());
  EXPECT_EQ(s.done(0), 6246 - 1 + kT.rfc_ab + closed) << "a player's cycles begin one later";
  EXPECT_EQ(s.done(2), 2 * 6246 - 1 + kT.rp_ab + kT.rfc_ab + closed);
  EXPECT_EQ(s.result.stats.refreshes_all, 2U);
  EXPECT_EQ(s.result.stats.refreshes, 0U);
  EXPECT_GT(s.why(DramCycleReason::kRefresh), std::uint64_t{2} * kT.rfc_ab - 20);
}

TEST(PairRefresh, TakesBanksOfTwoGroupsTogether) {
  DramConfig c;
  c.organisation.banks = 16;
  c.organisation.bank_groups = 4;
  c.organisation.refresh_banks = 2;
  const DramDevice paired(c);
  EXPECT_EQ(paired.refresh_command_bank_mask(), 0b0011'0011'0011'0011U);
  EXPECT_EQ(paired.refresh_bank_mask_of(5), 1U << 5 | 1U << 7);
  c.organisation.bank_groups = 1;
  const DramDevice halves(c);
  EXPECT_EQ(halves.refresh_command_bank_mask(), 0x00FFU);
  EXPECT_EQ(halves.refresh_bank_mask_of(5), 1U << 5 | 1U << 13);
}

TEST(PowerDown, BeginsAfterTheIdleTimeAndThePrechargeAndEndsWithARequest) {
  Script s(with([](DramConfig& c) { c.controller.power_down = true; }));
  s.read(0, 1);
  s.read(0, 1, 5000);
  s.go();
  EXPECT_EQ(s.latency(1), kForm.latency_after_power_down());
  EXPECT_EQ(s.why(DramCycleReason::kPowerDown), kT.xp);
  EXPECT_EQ(s.result.stats.power_downs, 1U);
  EXPECT_EQ(s.result.stats.power_down, 5000 - s.done(0) - s.config.controller.power_down_after - kT.rp_ab);
}

TEST(PowerDown, IsLeftForEveryRefresh) {
  DramConfig c = with([](DramConfig& d) {
    d.controller.power_down = true;
    d.timing.refi_pb = 780;
  });
  DramHarness b(c);
  b.requester().send(b.row(7, 0));
  b.requester().send(b.row(7, 0), 100'000);
  const std::uint64_t cycles = b.run();
  const std::uint64_t refreshes = 100'000 / 780;
  const std::uint64_t awake = refreshes * (kT.xp + kT.rfc_pb);
  EXPECT_NEAR(static_cast<double>(b.stats().power_down), static_cast<double>(100'000 - awake), 500.0);
  EXPECT_EQ(b.stats().refreshes, cycles / 780);
  EXPECT_EQ(b.stats().active_standby + b.stats().precharge_standby + b.stats().power_down, cycles);
}

TEST(PowerDown, WaitsForAFuturePrecharge) {
  DramConfig c = with([](DramConfig& d) {
    d.controller.power_down = true;
    d.controller.power_down_after = 1;
    d.controller.page_policy = PagePolicy::kClosed;
    d.timing.refi_pb = 0;
  });
  DramHarness b(c);
  for (const std::uint32_t i : {0U, 1U, 2U}) b.requester().send(b.row(i, 0), 2000 * i, true);
  const std::uint64_t cycles = b.run();
  const DramChannel::Stats& s = b.stats();
  // A row stays open from its activate to the precharge after the write recovery time. All rows are closed tRP later,
  // so the device may power down.
  const std::uint64_t open = kT.rcd + kT.ccd_l + kT.wl + kT.dqss + kT.burst + kT.wr;
  EXPECT_EQ(s.active_standby, 2 * open + kT.rcd + 1) << "the last one is still open at the end of the run";
  EXPECT_GE(s.power_downs, 2U);
  EXPECT_GE(s.precharge_standby, 2 * kT.rp);
  EXPECT_LE(s.precharge_standby, cycles);
}

TEST(Refresh, ThatBarelyLeavesABankTimeStillServesAllRequests) {
  for (const RefreshKind kind : {RefreshKind::kPerBank, RefreshKind::kAllBank}) {
    for (const DramSchedulingPolicy scheduler : {DramSchedulingPolicy::kFrFcfs, DramSchedulingPolicy::kFcfs}) {
      DramConfig c = with([&](DramConfig& d) {
        d.controller.refresh = kind;
        d.controller.scheduler = scheduler;
        d.controller.power_down = true;
        d.controller.power_down_after = 1;
        d.timing.refi_pb = 200;
        d.timing.refi_ab = 1600;
        d.timing.rfc_pb = d.timing.rfc_ab = 1600 - kT.xp - kT.rp_ab - 2 * kT.rc - 1;
      });
      c.check([](const std::string& key, const std::string& what) { ADD_FAILURE() << key << " " << what; });
      Script s(c);
      for (std::uint64_t i = 0; i < 600; ++i) {
        s.requests.push_back({sim::hash(i) % 65536 * 64, sim::hash(i, 1) % 3 == 0, 0});
      }
      s.go();
      EXPECT_EQ(s.result.stats.reads + s.result.stats.writes, 600U);
    }
  }
}

TEST(DramPowerDown, LastsToTheEndOfTheFrameInEveryRank) {
  for (const std::uint32_t ranks : {1U, 2U}) {
    constexpr std::uint64_t kEnd = 10'000;  // cycle in which the answer is taken, which ends the run
    const DramConfig c = with([&](DramConfig& d) {
      d.controller.power_down = true;
      d.organisation.ranks = ranks;
    });
    DramHarness b(c);
    b.requester().pop_every = kEnd;
    b.requester().send(b.row(0, 1));
    const std::uint64_t cycles = b.run();
    EXPECT_EQ(cycles, kEnd + 1);
    const auto read = static_cast<std::uint64_t>(DramClosedForms(c).closed_bank_latency());
    const std::uint64_t down =
        1 + read + c.controller.power_down_after + c.timing.rp_ab;  // after one cycle on the link
    EXPECT_EQ(b.stats().power_down, ranks * (cycles - down));
    EXPECT_EQ(b.stats().power_downs, 0U) << "nothing woke it";
    EXPECT_EQ(b.stats().active_standby, down - 1 - c.timing.rp_ab) << "from the activate to the precharge";
    EXPECT_EQ(b.stats().precharge_standby, ranks * down - b.stats().active_standby);
  }
}

TEST(DramPowerDown, DelaysNoRequestThatArrivesInItsFirstCycle) {
  const DramConfig c = with([](DramConfig& d) { d.controller.power_down = true; });
  const DramClosedForms form(c);
  const auto down =
      static_cast<std::uint64_t>(form.closed_bank_latency()) + c.controller.power_down_after + c.timing.rp_ab;
  for (const std::uint64_t later : {0U, 1U}) {
    Script s(c);
    s.read(0, 1);
    s.read(0, 1, down + later);
    s.go();
    EXPECT_EQ(s.latency(1), later == 0 ? form.closed_bank_latency() : form.latency_after_power_down());
    EXPECT_EQ(s.result.stats.power_downs, later);
    EXPECT_EQ(s.result.stats.power_down, later);
  }
}

}  // namespace
}  // namespace hw::test
