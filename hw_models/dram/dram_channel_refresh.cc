#include <algorithm>
#include <bit>

#include "hw_models/dram/dram_channel.h"

namespace hw {

/// Runs every refresh due by now, each at its own time: the outcome is the same whenever this is called.
void DramChannel::refresh(Cycle now) {
  const auto due_after = [&](std::uint64_t turns) {
    return refresh_interval_ * (turns / ranks_ + 1) + refresh_interval_ * (turns % ranks_) / ranks_;
  };
  while (refresh_at_ <= now) {
    Cycle due = refresh_at_;
    power_down(due);
    if (is_down_) {
      if (due > down_since_) {
        count_power_down(due);
        due += exit_cycles_;
        device_.wake(due);
      }
      down_since_ = std::max(due, down_since_) + refresh_cycles_;
    }
    refresh_banks(static_cast<std::uint32_t>(refresh_turn_ % ranks_), due);
    refresh_at_ += due_after(refresh_turn_ + 1) - due_after(refresh_turn_);
    refresh_turn_ += 1;
    next_is_stale_ = true;
  }
}

void DramChannel::refresh_banks(std::uint32_t rank, Cycle due) {
  if (controller_.refresh == RefreshKind::kAllBank) {
    device_.refresh_rank(rank, due);
    close_rows(device_.banks_of(rank));
    stats_.refreshes_all += 1;
    return;
  }
  const std::uint32_t leader = next_refresh(rank);
  const std::uint32_t banks = device_.refreshed_with(leader);
  device_.refresh(banks, due);
  close_rows(banks);
  stats_.refreshes += 1;
  to_refresh_ &= ~(1U << leader);
  const std::uint32_t of_rank = device_.banks_of(rank);
  if ((to_refresh_ & of_rank) == 0) to_refresh_ |= device_.refresh_leaders() & of_rank;
}

std::uint32_t DramChannel::next_refresh(std::uint32_t rank) const {
  const std::uint32_t candidates = to_refresh_ & device_.banks_of(rank);
  if (controller_.refresh_order == RefreshOrder::kIdleFirst) {
    const std::uint32_t wanted = reads_.banks() | writes_.banks();
    for (std::uint32_t left = candidates; left != 0; left &= left - 1) {
      const auto leader = static_cast<std::uint32_t>(std::countr_zero(left));
      if ((wanted & device_.refreshed_with(leader)) == 0) return leader;
    }
  }
  return static_cast<std::uint32_t>(std::countr_zero(candidates));
}

/// The device has closed these banks.
void DramChannel::close_rows(std::uint32_t banks) {
  for (std::uint32_t left = banks; left != 0; left &= left - 1) {
    const auto bank = static_cast<std::uint32_t>(std::countr_zero(left));
    reads_.row_closed(bank);
    writes_.row_closed(bank);
  }
}

/// Powers down if the channel has been idle for long enough before `now`: as with refreshes, it does not matter when
/// this is called, as long as it is before something changes.
void DramChannel::power_down(Cycle now) {
  const Cycle due = data_end_ + controller_.power_down_after;
  if (!controller_.power_down || is_down_ || due >= now || !reads_.empty() || !writes_.empty()) return;
  is_down_ = true;
  down_since_ = due;
  for (std::uint32_t rank = 0; rank < ranks_; ++rank)
    down_since_ = std::max(down_since_, device_.precharge_all(device_.banks_of(rank), due));
}

void DramChannel::count_power_down(Cycle until) {
  const Cycle from = std::max(down_since_, down_counted_);
  if (!is_down_ || until <= from) return;
  stats_.power_down += ranks_ * (until - from);
  down_counted_ = until;
}

/// A request has arrived.
void DramChannel::wake(Cycle now) {
  if (!is_down_) return;
  count_power_down(now);
  is_down_ = false;
  if (now <= down_since_) return;
  stats_.power_downs += 1;
  device_.wake(now + exit_cycles_);
}

}  // namespace hw
