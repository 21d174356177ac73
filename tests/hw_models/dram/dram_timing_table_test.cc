#include <algorithm>

#include <gtest/gtest.h>

#include "hw_models/dram/dram_device.h"

// Compares the timing table of LPDDR4-3200 (DramConfig's defaults) with values computed by hand from the grade's
// parameters. A line of 64 bytes is two bursts of 8 cycles (tCCD 8); RL 28, WL 14, tDQSCK 3, tDQSS 1.

namespace hw {
namespace {

/// Returns the largest distance in cycles of the table's rows of this kind, or -1 if there is none.
std::int64_t cycles(DramScope scope, DramOp from, DramOp to, std::uint32_t count = 1) {
  const DramTerms terms{DramConfig{}};
  std::int64_t most = -1;
  for (const DramConstraint& row : kDramConstraints) {
    const bool is_it = row.scope == scope && row.from == from && row.to == to && row.count == count;
    if (is_it) most = std::max(most, row.cycles(terms));
  }
  return most;
}

TEST(DramTimingTable, BindsTheCommandsOfABank) {
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kActivate, DramOp::kRead), 29) << "tRCD";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kActivate, DramOp::kWrite), 29) << "tRCD";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kActivate, DramOp::kPrecharge), 68) << "tRAS";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kActivate, DramOp::kActivate), 97) << "tRC";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kPrecharge, DramOp::kActivate), 29) << "tRPpb";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kRead, DramOp::kPrecharge), 8 + 12) << "last read + tRTP";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kWrite, DramOp::kPrecharge), 8 + 14 + 1 + 8 + 29)
      << "last data of the write + tWR";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kRefresh, DramOp::kActivate), 224) << "tRFCpb";
  EXPECT_EQ(cycles(DramScope::kBank, DramOp::kRefreshRank, DramOp::kActivate), 448) << "tRFCab";
}

TEST(DramTimingTable, BindsReadsAndWritesOfABankGroup) {
  EXPECT_EQ(cycles(DramScope::kBankGroup, DramOp::kRead, DramOp::kRead), 8 + 8) << "last read + tCCD_L";
  EXPECT_EQ(cycles(DramScope::kBankGroup, DramOp::kWrite, DramOp::kWrite), 8 + 8);
  EXPECT_EQ(cycles(DramScope::kBankGroup, DramOp::kWrite, DramOp::kRead), 8 + 14 + 1 + 8 + 16)
      << "last write + WL + tDQSS + tCCD_L + tWTR_L";
}

TEST(DramTimingTable, BindsARank) {
  EXPECT_EQ(cycles(DramScope::kRank, DramOp::kActivate, DramOp::kActivate), 16) << "tRRD";
  EXPECT_EQ(cycles(DramScope::kRank, DramOp::kActivate, DramOp::kActivate, 4), 64)
      << "tFAW, counted from the fourth last";
  EXPECT_EQ(cycles(DramScope::kRank, DramOp::kRead, DramOp::kWrite), 8 + 28 + 3 + 8 + 1 - 14)
      << "read data + tRTW end where write data begin";
  EXPECT_EQ(cycles(DramScope::kRank, DramOp::kWrite, DramOp::kRead), 8 + 14 + 1 + 8 + 16) << "write data + tWTR_S";
}

TEST(DramTimingTable, BindsOtherRanksByTheirTurnOnTheDataBus) {
  EXPECT_EQ(cycles(DramScope::kOtherRanks, DramOp::kRead, DramOp::kRead), 8 + 8 + 1) << "burst + tRTRS";
  EXPECT_EQ(cycles(DramScope::kOtherRanks, DramOp::kWrite, DramOp::kWrite), 8 + 8 + 1);
  EXPECT_EQ(cycles(DramScope::kOtherRanks, DramOp::kWrite, DramOp::kRead), 8 + 14 + 1 + 8 + 1 - 28 - 3)
      << "may be negative";
  EXPECT_EQ(cycles(DramScope::kOtherRanks, DramOp::kActivate, DramOp::kActivate), -1)
      << "ranks open rows independently";
}

}  // namespace
}  // namespace hw
