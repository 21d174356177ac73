#include <bit>

#include "hw_models/memory/l2_bank.h"

namespace hw {

/// Does what the policy says with the head, a write; false if it must stay.
bool L2Bank::write(sim::Time now) {
  if (!has_room(1)) return false;
  const MemRequest& r = head_.request;
  if (writes_ == L2Writes::kBack) {
    write_here(now);
  } else {
    const bool here = store_.find(r.line, r.sectors) != L2Store::Found::kNot;
    const bool stored = here && writes_ == L2Writes::kThrough;
    if (here && !stored) store_.take_out(r.line);
    stats_.write_hits += here;
    (stored ? stats_.stored : stats_.not_stored) += 1;
    to_memory(now, MemRequest{r.line, index_, 0, true, r.sectors, r.owner});
    stats_.passed_on += 1;
  }
  if (book_ != nullptr) [[unlikely]]
    book_->count(r.owner, &TileAccount::l2_writes);
  stats_.writes += 1;
  stats_.bytes_written += sector_bytes_ * static_cast<std::uint32_t>(std::popcount(r.sectors));
  return true;
}

/// Keeps what the head writes.
void L2Bank::write_here(sim::Time now) {
  const MemRequest& r = head_.request;
  SectorMask overwritten = 0;
  bool hit = true;
  if (Waiters* waiters = misses_.find(r.line)) {
    overwritten = waiters->dirty & r.sectors;
    waiters->dirty |= r.sectors;
  } else if (store_.find(r.line, r.sectors) != L2Store::Found::kNot) {
    overwritten = store_.write(r.line, r.sectors);
  } else {
    hit = false;
    write_back(now, store_.put_in(r.line, r.sectors, r.sectors), r.owner);
  }
  stats_.write_hits += hit;
  stats_.stored += 1;
  stats_.bytes_overwritten += sector_bytes_ * static_cast<std::uint32_t>(std::popcount(overwritten));
}

/// After the end of the frame a dirty line goes each cycle.
bool L2Bank::flush(sim::Time now) {
  if (flush_in_->can_pop(now)) {
    flush_in_->pop(now);
    flushing_ = true;
  }
  if (!flushing_ || store_.dirty_lines() == 0 || !has_room(1)) return false;
  write_back(now, store_.clean_next());
  return true;
}

}  // namespace hw
