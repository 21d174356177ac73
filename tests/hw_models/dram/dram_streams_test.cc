#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_measurements.h"
#include "sim/config/config.h"

// Compares LPDDR5 and LPDDR5X streams with the published rules of Ramulator 2.1 (python/ramulator/dram/lpddr5.py, LPDDR
// controller). Times are in clocks of CK. Bursts are 2 clocks apart (BL/n_min), or 4 in one bank group (tCCD_L,
// BL/n_max). RD to WR: RL + 2 + 2 - WL. WR to RD: WL + 2 + tWTR_S, or in one group WL + 4 + tWTR_L. WCK stops one clock
// after the data; later reads or writes then need a CAS one clock before. A line is two bursts of one bank.

namespace hw {
namespace {

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
