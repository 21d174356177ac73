#include <gtest/gtest.h>

#include "hw_models/dram/dram_channel.h"

namespace hw {
namespace {

DramQueue::Entry entry(std::uint32_t bank, std::uint32_t row) {
  DramQueue::Entry e;
  e.address = {bank, row};
  return e;
}

/// A queue with requests for rows 10 and 11 of bank 3, whose row 10 is open, and for a closed row of bank 31.
DramQueue four() {
  DramQueue queue(4, 32);
  queue.push(entry(3, 10), true);
  queue.push(entry(31, 20), false);
  queue.push(entry(3, 11), false);
  queue.push(entry(3, 10), true);
  return queue;
}

TEST(DramQueue, TracksRequestsByBankAndHitsOfItsOpenRow) {
  DramQueue queue = four();
  EXPECT_TRUE(queue.is_full());
  EXPECT_EQ(queue.requested_bank_mask(), 1U << 3 | 1U << 31);
  EXPECT_EQ(queue.hit_bank_mask(), 1U << 3);
  EXPECT_EQ(queue.request_position_mask(3), 0b1101U);
  EXPECT_EQ(queue.request_position_mask(31), 0b0010U);
  EXPECT_EQ(queue.hit_position_mask(3), 0b1001U);
  EXPECT_EQ(queue.hit_position_mask(31), 0U);
}

TEST(DramQueue, MovesLaterRequestsUpWhenOneIsRemoved) {
  DramQueue queue = four();
  queue.remove_at(1);
  EXPECT_EQ(queue.size(), 3U);
  EXPECT_EQ(queue.requested_bank_mask(), 1U << 3);
  EXPECT_EQ(queue.request_position_mask(3), 0b111U);
  EXPECT_EQ(queue.request_position_mask(31), 0U);
  EXPECT_EQ(queue.hit_position_mask(3), 0b101U);
  EXPECT_EQ(queue.at(1).address.row, 11U);
  queue.remove_at(0);
  EXPECT_EQ(queue.oldest_entry().address.row, 11U);
  EXPECT_EQ(queue.hit_position_mask(3), 0b10U);
  queue.remove_at(1);
  EXPECT_EQ(queue.hit_bank_mask(), 0U);
  queue.remove_at(0);
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.requested_bank_mask(), 0U);
}

TEST(DramQueue, UpdatesHitsWhenARowOpensOrCloses) {
  DramQueue queue = four();
  queue.note_row_opened(3, 11);
  EXPECT_EQ(queue.hit_position_mask(3), 0b100U);
  queue.note_row_opened(31, 20);
  EXPECT_EQ(queue.hit_bank_mask(), 1U << 3 | 1U << 31);
  queue.note_row_closed(3);
  EXPECT_EQ(queue.hit_position_mask(3), 0U);
  EXPECT_EQ(queue.hit_bank_mask(), 1U << 31);
}

TEST(DramQueue, FindsTheRequestsOfSeveralBanks) {
  const DramQueue queue = four();
  EXPECT_EQ(queue.request_position_mask_of_banks(1U << 3), 0b1101U);
  EXPECT_EQ(queue.hit_position_mask_of_banks(1U << 3), 0b1001U);
  EXPECT_EQ(queue.request_position_mask_of_banks(1U << 3 | 1U << 31), 0b1111U);
  EXPECT_EQ(queue.hit_position_mask_of_banks(1U << 31), 0U);
  EXPECT_EQ(queue.request_position_mask_of_banks(0), 0U);
}

TEST(DramQueue, HoldsSixtyFour) {
  DramQueue queue(64, 32);
  for (std::uint32_t i = 0; i < 64; ++i) queue.push(entry(i % 32, i), true);
  EXPECT_TRUE(queue.is_full());
  EXPECT_EQ(queue.request_position_mask(31), std::uint64_t{1} << 31 | std::uint64_t{1} << 63);
  for (std::uint32_t i = 0; i < 64; ++i) {
    EXPECT_EQ(queue.oldest_entry().address.row, i);
    queue.remove_at(0);
  }
}

}  // namespace
}  // namespace hw
