#include <gtest/gtest.h>

#include "hw_models/dram/dram_measurements.h"
#include "tests/hw_models/dram/dram_harness.h"

// Tests of refreshes of banks, pairs of banks and whole ranks, and of power-down.

namespace hw::test {
namespace {

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

}  // namespace
}  // namespace hw::test
