#include <gtest/gtest.h>

#include "hw_models/dram/dram_channel.h"

namespace hw {
namespace {

constexpr std::uint32_t kBank = 5, kRow = 7;

/// Serves the last queued hit of a row, then a request for `row` arrives. Returns true if the first row was closed.
bool closes_before(DramPagePolicy& policy, std::uint32_t row) {
  const bool closed = policy.should_close_row(kBank, kRow, false);
  policy.note_request(kBank, row);
  return closed;
}

TEST(DramPagePolicy, ForgetsManyOtherRowsAfterTwoOfTheSame) {
  DramPagePolicy policy(PagePolicy::kAdaptive);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(policy.should_close_row(kBank, kRow, true)) << "another row waits";
  EXPECT_TRUE(closes_before(policy, kRow)) << "the count ends at 3";
  EXPECT_TRUE(closes_before(policy, kRow)) << "2: the upper half";
  EXPECT_FALSE(closes_before(policy, kRow)) << "1";
}

TEST(DramPagePolicy, ForgetsManyOfTheSameAfterTwoOtherRows) {
  DramPagePolicy policy(PagePolicy::kAdaptive);
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(closes_before(policy, kRow));
  EXPECT_FALSE(closes_before(policy, kRow + 1)) << "0";
  EXPECT_FALSE(closes_before(policy, kRow + 1)) << "1";
  EXPECT_TRUE(closes_before(policy, kRow + 1)) << "2";
}

TEST(DramPagePolicy, CountsOnlyTheNextRequest) {
  DramPagePolicy policy(PagePolicy::kAdaptive);
  EXPECT_FALSE(closes_before(policy, kRow + 1));
  for (int i = 0; i < 10; ++i) policy.note_request(kBank, kRow + 1);
  EXPECT_FALSE(policy.should_close_row(kBank, kRow, false)) << "1";
}

TEST(DramPagePolicy, CountsForEachBankSeparately) {
  DramPagePolicy policy(PagePolicy::kAdaptive);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(policy.should_close_row(kBank, kRow, true));
  for (std::uint32_t bank = 0; bank < 32; ++bank) EXPECT_EQ(policy.should_close_row(bank, kRow, false), bank == kBank);
}

}  // namespace
}  // namespace hw
