#include "hw_models/dram/dram_timing_table.h"

#include <algorithm>

#include <gtest/gtest.h>

// Rows of the timing table of LPDDR4-3200 (DramConfig's defaults), worked out by hand from the grade's parameters:
// lines of 64 bytes are two bursts of 8 cycles (tCCD 8), RL 28, WL 14, tDQSCK 3, tDQSS 1.

namespace hw {
namespace {

using enum DramOp;
using enum DramScope;

/// Cycles of the row, or -1 if there is none.
std::int64_t cycles(DramScope scope, DramOp from, DramOp to, std::uint32_t count = 1) {
  const DramTimingTable table{DramConfig{}};
  const auto rows = table.after(from);
  const auto row = std::ranges::find_if(
      rows, [&](const DramConstraint& r) { return r.scope == scope && r.to == to && r.count == count; });
  return row == rows.end() ? -1 : row->cycles;
}

TEST(DramTimingTable, BindsTheCommandsOfABank) {
  EXPECT_EQ(cycles(kBank, kActivate, kRead), 29) << "tRCD";
  EXPECT_EQ(cycles(kBank, kActivate, kWrite), 29) << "tRCD";
  EXPECT_EQ(cycles(kBank, kActivate, kPrecharge), 68) << "tRAS";
  EXPECT_EQ(cycles(kBank, kActivate, kActivate), 97) << "tRC";
  EXPECT_EQ(cycles(kBank, kPrecharge, kActivate), 29) << "tRPpb";
  EXPECT_EQ(cycles(kBank, kRead, kPrecharge), 8 + 12) << "last read + tRTP";
  EXPECT_EQ(cycles(kBank, kWrite, kPrecharge), 8 + 14 + 1 + 8 + 29) << "last data of the write + tWR";
  EXPECT_EQ(cycles(kBank, kRefresh, kActivate), 224) << "tRFCpb";
  EXPECT_EQ(cycles(kBank, kRefreshRank, kActivate), 448) << "tRFCab";
}

TEST(DramTimingTable, BindsReadsAndWritesOfABankGroup) {
  EXPECT_EQ(cycles(kBankGroup, kRead, kRead), 8 + 8) << "last read + tCCD_L";
  EXPECT_EQ(cycles(kBankGroup, kWrite, kWrite), 8 + 8);
  EXPECT_EQ(cycles(kBankGroup, kWrite, kRead), 8 + 14 + 1 + 8 + 16) << "last write + WL + tDQSS + tCCD_L + tWTR_L";
}

TEST(DramTimingTable, BindsARank) {
  EXPECT_EQ(cycles(kRank, kActivate, kActivate), 16) << "tRRD";
  EXPECT_EQ(cycles(kRank, kActivate, kActivate, 4), 64) << "tFAW, counted from the fourth last";
  EXPECT_EQ(cycles(kRank, kRead, kWrite), 8 + 28 + 3 + 8 + 1 - 14) << "read data + tRTW end where write data begin";
  EXPECT_EQ(cycles(kRank, kWrite, kRead), 8 + 14 + 1 + 8 + 16) << "write data + tWTR_S";
}

TEST(DramTimingTable, BindsOtherRanksByTheirTurnOnTheDataBus) {
  EXPECT_EQ(cycles(kOtherRanks, kRead, kRead), 8 + 8 + 1) << "burst + tRTRS";
  EXPECT_EQ(cycles(kOtherRanks, kWrite, kWrite), 8 + 8 + 1);
  EXPECT_EQ(cycles(kOtherRanks, kWrite, kRead), 8 + 14 + 1 + 8 + 1 - 28 - 3) << "may be negative";
  EXPECT_EQ(cycles(kOtherRanks, kActivate, kActivate), -1) << "ranks open rows independently";
}

}  // namespace
}  // namespace hw
