#include <string>
#include <vector>

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

// Compares LPDDR5 and LPDDR5X streams with the published rules of Ramulator 2.1 (python/ramulator/dram/lpddr5.py, LPDDR
// controller). Times are in clocks of CK. Bursts are 2 clocks apart (BL/n_min), or 4 in one bank group (tCCD_L,
// BL/n_max). RD to WR: RL + 2 + 2 - WL. WR to RD: WL + 2 + tWTR_S, or in one group WL + 4 + tWTR_L. WCK stops one clock
// after the data; later reads or writes then need a CAS one clock before. A line is two bursts of one bank.

constexpr std::uint64_t kLine = 64;
constexpr std::uint64_t kColumns = 32;  ///< lines of a row

DramConfig quiet(const char* grade) {
  DramConfig c = sim::load_config<DramConfig>(std::string("configs/dram/") + grade + ".yaml");
  c.timing.refi_pb = 0;
  c.controller.bank_xor = false;
  return c;
}

class Lpddr5Streams : public testing::TestWithParam<const char*> {
 protected:
  static DramTiming timing() { return quiet(GetParam()).timing; }
  static std::uint64_t read_to_write() { return timing().rl + 2 + 2 - timing().wl; }
  static std::uint64_t write_to_read() { return timing().wl + 2 + timing().wtr_s; }
  static std::uint64_t write_to_read_of_group() { return timing().wl + 4 + timing().wtr_l; }
};
INSTANTIATE_TEST_SUITE_P(Grades, Lpddr5Streams, testing::Values("lpddr5-6400", "lpddr5x-8533"), [](const auto& grade) {
  std::string name = grade.param;
  std::erase(name, '-');
  return name;
});

/// Returns the address of a line in row 0 of a bank. Even and odd banks are in different bank groups.
std::uint64_t line_in(std::uint64_t bank, std::uint64_t column) { return (column * 16 + bank) * kLine; }

double clocks_of(const DramConfig& c, sim::Time time) {
  return static_cast<double>(time) / static_cast<double>(c.timing.ck.time);
}

/// Adds reads that open the first row of every bank, long before the stream begins.
constexpr std::uint64_t kStart = 1000;
std::vector<DramRequest> opened_rows() {
  std::vector<DramRequest> requests;
  for (std::uint64_t bank = 0; bank < 16; ++bank) requests.push_back({line_in(bank, 0), false, 0});
  return requests;
}

/// Returns the mean distance of reads in clocks, if each arrives `gap` clocks after the data of the previous one.
double clocks_a_read(const char* grade, std::uint64_t gap, std::uint64_t expected) {
  const DramConfig c = quiet(grade);
  std::vector<DramRequest> requests = opened_rows();
  constexpr std::uint64_t kReads = 200;
  for (std::uint64_t i = 0; i < kReads; ++i)
    requests.push_back({line_in(i % 16, i / 16), false, (kStart + i * expected) * c.timing.ck.time});
  const DramRun p = run_dram_requests(c, requests, 1);
  for (std::size_t i = 17; i < requests.size(); ++i) {
    EXPECT_EQ(clocks_of(c, p.arrived[i] - p.done[i - 1]), gap) << "read " << i;
  }
  return clocks_of(c, p.done.back() - p.done[16]) / (kReads - 1);
}

// RL + 2 after the last read its data end, and WCK stops a clock later.
TEST_P(Lpddr5Streams, AReadAtATimeStartsTheDataClockAgainIfItIsAClockLate) {
  const std::uint64_t line = timing().rl + 4 + 2;
  EXPECT_EQ(clocks_a_read(GetParam(), 0, line), line);
  EXPECT_EQ(clocks_a_read(GetParam(), 1, line + 2), 1 + 1 + line) << "CAS";
  EXPECT_EQ(clocks_a_read(GetParam(), 9, line + 10), 9 + 1 + line);
}

/// Returns the mean clocks for a read and a write of one line each in these banks, which alternate. Each request
/// arrives before the bus is free.
double clocks_a_pair(const char* grade, std::uint64_t read_bank, std::uint64_t write_bank, std::uint64_t expected) {
  const DramConfig c = quiet(grade);
  std::vector<DramRequest> requests = opened_rows();
  constexpr std::uint64_t kPairs = 100, kWait = 12;  // clocks
  for (std::uint64_t i = 0; i < kPairs; ++i) {
    const std::uint64_t read_at = kStart + i * expected;
    requests.push_back({line_in(read_bank, i % kColumns), false, (read_at - (i == 0 ? 0 : kWait)) * c.timing.ck.time});
    requests.push_back({line_in(write_bank, i % kColumns), true, (read_at + 2) * c.timing.ck.time});
  }
  const DramRun p = run_dram_requests(c, requests, 32);
  return clocks_of(c, p.done.back() - p.done[17]) / (kPairs - 1);
}

// Two reads 4 apart, two writes 4 apart, and a CAS before the next read.
TEST_P(Lpddr5Streams, ALineReadAndALineWrittenInTurnPayBothTurnaroundsAndACas) {
  const std::uint64_t other = 4 + read_to_write() + 4 + write_to_read() + 1;
  const std::uint64_t same = 4 + read_to_write() + 4 + write_to_read_of_group() + 1;
  EXPECT_EQ(clocks_a_pair(GetParam(), 0, 1, other), other) << "other bank group";
  EXPECT_EQ(clocks_a_pair(GetParam(), 0, 4, same), same) << "same bank group";
}

/// A stream that copies lines: alternating groups of reads and of writes, as the controller forms them.
struct Copy {
  double clocks;
  double pairs_of_groups;  ///< lines in a group of reads and in a group of writes
};
constexpr std::uint64_t kLines = 4096;
template <class Source, class Destination>
Copy copy(const char* grade, std::uint32_t n, Source&& from, Destination&& to) {
  DramConfig c = quiet(grade);
  c.controller.write_high = 28;
  c.controller.write_low = 28 - n;
  std::vector<DramRequest> requests;
  for (std::uint64_t i = 0; i < kLines; ++i) {
    requests.push_back({from(i) * kLine, false, 0});
    requests.push_back({to(i) * kLine, true, 0});
  }
  const DramRun p = run_dram_requests(c, requests, 64);
  const double pairs = static_cast<double>(p.stats.turnarounds) / 2;
  EXPECT_NEAR(pairs, static_cast<double>(kLines) / n, 0.2 * static_cast<double>(kLines) / n) << n;
  return {clocks_of(c, p.end), pairs};
}

// Copies one half of each row to the other. At 2 clocks per burst, a copied line takes 8 clocks. A pair of groups adds
// two turnarounds instead of 2 clocks each; the second has a CAS. Rows stay open for 16 lines of each half, so
// activates are hidden.
TEST_P(Lpddr5Streams, ACopyWithinOpenRowsIsBoundByBurstsAndTurnarounds) {
  constexpr std::uint64_t kHalf = 16 * kColumns / 2;
  const auto from = [](std::uint64_t i) { return i / kHalf * 2 * kHalf + i % kHalf; };
  const auto turns = static_cast<double>((read_to_write() - 2) + (write_to_read() + 1 - 2));
  for (const std::uint32_t n : {8U, 16U, 24U}) {
    const Copy c = copy(GetParam(), n, from, [&](std::uint64_t i) { return from(i) + kHalf; });
    const double expected = 8.0 * kLines + c.pairs_of_groups * turns;
    EXPECT_NEAR(c.clocks, expected, 0.02 * expected) << n << " lines a group";
  }
}

// Copies rows to other rows of the same banks. Each group closes and opens 16 rows: PRE a clock after the last column
// command, tRP 15, tRCD 15, then one row per 4 clocks (tRRD, tFAW), which is as fast as the bursts of its line. LPDDR5X
// opens rows more slowly than it reads their lines, so groups share rows; "a line of every row" of DramMeasurements has
// its rate.
TEST(Lpddr5Copy, BetweenRowsOfABankIsBoundByActivates) {
  const auto from = [](std::uint64_t i) { return i; };
  const Copy c = copy("lpddr5-6400", 16, from, [](std::uint64_t i) { return i + (1 << 20); });
  const double expected = 8.0 * kLines + c.pairs_of_groups * 2 * (1 + 15 + 15);
  EXPECT_NEAR(c.clocks, expected, 0.02 * expected);
}

// LPDDR6 by the rules of Ramulator 2.1 (python/ramulator/dram/lpddr6.py): a line of two bursts, 6 clocks each between
// bank groups. RD to WR takes nRL + nBL_min + nWCK2DQO - nODTLon + 1 = 41 clocks, WR to RD nWL + nBL_min + nWTRS = 49
// after a CAS of 2 clocks.
TEST(Lpddr6Streams, ACopyWithinOpenRowsIsBoundByBurstsAndTurnarounds) {
  constexpr std::uint64_t kHalf = 16 * kColumns / 2;
  constexpr double kBurst = 6, kTurns = (41 - kBurst) + (49 + 2 - kBurst);
  const auto from = [](std::uint64_t i) { return i / kHalf * 2 * kHalf + i % kHalf; };
  for (const std::uint32_t n : {8U, 16U, 24U}) {
    const Copy c = copy("lpddr6-10667", n, from, [&](std::uint64_t i) { return from(i) + kHalf; });
    const double expected = 4 * kBurst * kLines + c.pairs_of_groups * kTurns;
    EXPECT_NEAR(c.clocks, expected, 0.02 * expected) << n << " lines a group";
  }
}

}  // namespace
}  // namespace hw
