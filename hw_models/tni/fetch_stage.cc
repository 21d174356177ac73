#include "hw_models/tni/fetch_stage.h"

#include <algorithm>
#include <cassert>

namespace hw {

void FetchStage::wait_after_miss(Addr line, std::uint64_t slot_mask) {
  if (handling_ == MissHandling::kBlocking) {
    stalled_ = true;
    return;
  }
  stats_.rau_writes += 1;
  if (l1_.find_miss(line)->slots == slot_mask) rows_used_ += 1;
}

void FetchStage::unblock_waiters(Addr line, std::uint64_t slot_mask) {
  resume_slots(no_mshr_);
  if (handling_ == MissHandling::kBlocking) {
    if (slot_mask != 0) stalled_ = false;
    return;
  }
  if (slot_mask != 0) {
    stats_.rau_fills += 1;
    filled_rau_rows_.push_back(slot_mask);
  }
  if (wanted_row_ == line) resume_slots(table_full_);
}

bool FetchStage::has_room_in_rau_table(Addr line) {
  const L1Cache::Miss* row = l1_.find_miss(line);
  if (row != nullptr && row->slots != 0) {
    wanted_row_ = line;
    return static_cast<std::uint32_t>(std::popcount(row->slots)) < rau_.rays;
  }
  wanted_row_ = kAnyRow;
  return rows_used_ < rau_.rows || (row == nullptr && l1_.has_line(line));
}

void FetchStage::remove_from_rau_table(std::uint64_t slot_mask) {
  stats_.rau_reads += 1;
  const auto row =
      std::ranges::find_if(filled_rau_rows_, [&](std::uint64_t slots) { return (slots & slot_mask) != 0; });
  assert(row != filled_rau_rows_.end() && "a line is kept for a slot that is in no row");
  *row &= ~slot_mask;
  if (*row != 0) return;
  *row = filled_rau_rows_.back();
  filled_rau_rows_.pop_back();
  rows_used_ -= 1;
  if (wanted_row_ == kAnyRow) resume_slots(table_full_);
}

void FetchStage::resume_slots(std::uint64_t slot_mask) {
  if (slot_mask == 0) return;
  resumed_ |= slot_mask;
  ready_ |= slot_mask;
  table_full_ &= ~slot_mask;
  stalled_ = false;
}

}  // namespace hw
