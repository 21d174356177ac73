#include <gtest/gtest.h>

#include "hw_models/dram/dram_device.h"
#include "hw_models/dram/dram_measurements.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "tests/hw_models/dram/dram_harness.h"

// Tests of rules that only LPDDR5 has: ACT-1 and ACT-2, the CAS that starts WCK, bursts of 32, and per-bank refresh
// close to activates.

namespace hw {
namespace {

using Cycle = DramDevice::Cycle;
using enum DramCommand;

DramConfig lpddr5() { return sim::load_config<DramConfig>("configs/dram/lpddr5-6400.yaml"); }

Cycle earliest(const DramDevice& d, DramCommand command, std::uint32_t bank, Cycle now) {
  return test::earliest_start(d, command, bank, false, now);
}

TEST(Lpddr5, ACommandFitsBetweenAct1AndAct2) {
  DramConfig c = lpddr5();
  c.timing.wck_sync = 0;
  DramDevice d{c};
  d.activate_row(0, 0, 0);
  d.read_line(0, 100);        // reads at 100 and 104
  d.activate_row(1, 0, 103);  // ACT-1 at 103, ACT-2 after the read, at 105
  EXPECT_EQ(earliest(d, kPrecharge, 2, 103), 106U);
  d.read_line(0, 108);        // 108 and 112
  d.activate_row(2, 0, 120);  // 120 and 121
  EXPECT_EQ(earliest(d, kPrecharge, 3, 121), 122U);
}

TEST(Lpddr5, Act2IsDisplacedByAReadOfAnotherBankGroup) {
  DramConfig c = lpddr5();
  c.timing.wck_sync = 0;
  DramDevice d{c};
  d.activate_row(0, 0, 0);
  d.activate_row(1, 0, 50);
  d.read_line(0, 100);  // reads at 100 and 104, data of two clocks each: those of another group fit at 102 and 106
  d.activate_row(2, 0, 101);  // ACT-2 at 102
  EXPECT_EQ(earliest(d, kColumn, 1, 102), 102U);
  d.read_line(1, 102);  // ACT-2 at 103
  EXPECT_EQ(earliest(d, kPrecharge, 4, 103), 105U) << "104 holds a read";
}

TEST(Lpddr5, Act2IsNotDisplacedAtTAad) {
  DramConfig c = lpddr5();
  c.timing.wck_sync = 0;
  c.timing.aad = 1;
  DramDevice d{c};
  d.activate_row(0, 0, 0);
  d.activate_row(1, 0, 50);
  d.read_line(0, 100);
  d.activate_row(2, 0, 101);  // ACT-2 at 102 and no later
  EXPECT_EQ(earliest(d, kColumn, 1, 102), 106U) << "between, the data bus has no room";
}

TEST(Lpddr5, AnotherAct1IsIssuedAfterAct2) {
  DramConfig c = lpddr5();
  c.timing.wck_sync = 0;
  c.timing.rrd = 1;
  DramDevice d{c};
  d.activate_row(0, 0, 0);
  d.read_line(0, 100);
  d.activate_row(1, 0, 103);  // ACT-2 after the read, at 105
  EXPECT_EQ(earliest(d, kActivate, 2, 104), 106U);
}

TEST(Lpddr5, Act2IsIssuedWithinTAadOrAct1Waits) {
  DramConfig c = lpddr5();
  c.timing.wck_sync = 0;
  c.timing.aad = 1;  // the next slot or none
  DramDevice d{c};
  d.activate_row(0, 0, 0);
  d.read_line(0, 100);
  EXPECT_EQ(earliest(d, kActivate, 1, 103), 105U) << "104 holds the line's second read";
  c.timing.aad = 2;
  DramDevice wider{c};
  wider.activate_row(0, 0, 0);
  wider.read_line(0, 100);
  EXPECT_EQ(earliest(wider, kActivate, 1, 103), 103U);
}

TEST(Lpddr5, AColumnCommandAfterAPauseBeginsWithCas) {
  const DramConfig c = lpddr5();
  DramDevice d{c};
  d.activate_row(0, 0, 0);
  EXPECT_EQ(earliest(d, kColumn, 0, 5), Cycle{c.timing.rcd}) << "CAS waits for the row";
  EXPECT_EQ(d.read_line(0, 100), 100 + 1 + Cycle{c.timing.rl}) << "CAS at 100, read at 101";
  // WCK stops one clock after the data of the second read: at 105 + 17 + 2 + 1.
  EXPECT_EQ(d.read_line(0, 124), 124 + Cycle{c.timing.rl});
  EXPECT_EQ(d.read_line(0, 148), 148 + 1 + Cycle{c.timing.rl}) << "128 + 17 + 2 + 1: the cycle in which WCK stops";
}

/// The rule of the scheduler: find the first slot for a kind of command, and give it to the oldest request whose bank
/// is ready by then (DramScheduler::best_command).
TEST(Lpddr5, AFreeSlotServesEveryBankReadyByThen) {
  for (const std::uint32_t sync : {0U, 1U, 4U}) {
    DramConfig c = lpddr5();
    c.timing.wck_sync = sync;
    DramDevice d{c};
    for (std::uint32_t bank = 0; bank < 4; ++bank) d.activate_row(bank, 0, Cycle{bank} * c.timing.faw / 4);
    d.read_line(0, 100);
    d.read_line(1, 109);
    d.refresh_banks(1U << 5, 105);
    d.activate_row(6, 0, 111);
    for (const DramCommand command : {kColumn, kActivate, kPrecharge}) {
      for (Cycle ready = 111; ready < 180; ++ready) {
        const Cycle slot = d.first_bus_slot(command, 0, ready);
        for (Cycle later = ready; later < ready + 20; ++later) {
          const Cycle at = d.first_bus_slot(command, 0, later);
          EXPECT_EQ(at == slot, later <= slot) << sync << ' ' << ready << ' ' << later;
          EXPECT_GE(at, slot);
        }
      }
    }
  }
}

TEST(Lpddr5, ABurstOf32TakesOneCommand) {
  DramConfig c = lpddr5();
  c.timing.wck_sync = 0;
  DramDevice two{c};
  c.organisation.bl32 = true;
  DramDevice one{c};
  for (DramDevice* d : {&two, &one}) {
    d->activate_row(0, 0, 0);
    d->read_line(0, 100);
  }
  EXPECT_EQ(earliest(two, kPrecharge, 1, 104), 105U);
  EXPECT_EQ(earliest(one, kPrecharge, 1, 104), 104U);
  EXPECT_EQ(one.line_transfer_cycles(), two.line_transfer_cycles()) << "the data are the same";
}

TEST(Lpddr5, BurstsOf32NeedLinesOfAnEvenNumberOfBursts) {
  DramConfig c = lpddr5();
  c.line = c.organisation.burst;
  ASSERT_EQ(c.bursts_per_line(), 1U);
  EXPECT_NO_THROW(sim::check_config(c));
  c.organisation.bl32 = true;
  EXPECT_THROW(sim::check_config(c), sim::InputError);
}

TEST(Lpddr4, ARefreshOfOneBankIsAnActivateToTheOthers) {
  const DramConfig c = sim::load_config<DramConfig>("configs/dram/lpddr4-3200.yaml");
  const DramTiming& t = c.timing;
  DramDevice d{c};
  d.refresh_banks(1U << 5, 1000);
  EXPECT_EQ(earliest(d, kActivate, 0, 900), 900U);
  EXPECT_EQ(earliest(d, kActivate, 0, 990), 1000U + t.rrd) << "not within tRRD before it either";
  EXPECT_EQ(earliest(d, kActivate, 0, 1001), 1000U + t.rrd);
  for (std::uint32_t bank = 0; bank < 3; ++bank) d.activate_row(bank, 0, 1000 + Cycle{t.rrd} * (bank + 1));
  EXPECT_EQ(earliest(d, kActivate, 3, 1000 + Cycle{t.rrd} * 4), 1000U + t.faw) << "the fifth in the window";
}

TEST(DramRequests, PostedWritesFillTheChannelForAnyWindow) {
  DramConfig c = lpddr5();
  c.controller.write_high = 32;
  std::vector<DramRequest> writes;
  for (std::uint64_t i = 0; i < 4000; ++i) writes.push_back({i * c.line.bytes, true, 0});
  const auto gbps = [&](std::uint32_t outstanding) {
    return static_cast<double>(writes.size() * c.line.bytes) /
           (static_cast<double>(run_dram_requests(c, writes, outstanding).end) * 1e-6);
  };
  constexpr double kPeak = 12.8;  // 16 pins at 6.4 Gb/s
  EXPECT_GT(gbps(32), 0.95 * kPeak);
  EXPECT_GT(gbps(4), 0.95 * kPeak);
}

}  // namespace
}  // namespace hw
