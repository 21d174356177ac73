#include "hw_models/dram/dram_scheduler.h"

#include <algorithm>
#include <bit>

namespace hw {

/// Replaces `best` if one of the given banks of a rank has a better command of kind `kCommand`. Let t be the first
/// cycle that rank and bus constraints allow. The new command serves the oldest request whose bank is ready at t, and
/// starts at t. If no bank is ready at t, t becomes the first cycle at which one is.
template <DramCommand kCommand>
[[gnu::always_inline]] inline void DramScheduler::keep_better_command(const DramQueue& queue, std::uint32_t bank_mask,
                                                                      std::uint32_t rank, bool writes, Cycle from,
                                                                      ScheduledCommand& best) const {
  if (bank_mask == 0) return;
  const auto none_is_better = [&](Cycle at) { return best < ScheduledCommand(at, kCommand, 0, 0); };
  const Cycle rank_ready = device_.earliest_rank_cycle(kCommand, rank, writes, from);
  if (none_is_better(rank_ready)) return;
  const auto take = [&](Cycle at, std::uint64_t positions) {
    const auto oldest = static_cast<std::uint32_t>(std::countr_zero(positions));
    best = std::min(best, ScheduledCommand(at, kCommand, oldest, queue.at(oldest).address.bank));
  };
  // Looks for a command that starts at cycle `slot`. True if the search can end: a command was found, or `best` starts
  // earlier.
  const auto is_over = [&](Cycle slot) {
    if (none_is_better(slot)) return true;
    const std::uint32_t ready = bank_mask & device_.ready_bank_mask<kCommand>(writes, slot);
    if (ready != 0)
      take(slot, kCommand == DramCommand::kColumn ? queue.hit_position_mask_of_banks(ready)
                                                  : queue.request_position_mask_of_banks(ready));
    return ready != 0;
  };
  if (is_over(device_.first_bus_slot(kCommand, rank, rank_ready))) return;
  is_over(device_.first_bus_slot(kCommand, rank, device_.first_ready_cycle<kCommand>(bank_mask, writes)));
}

ScheduledCommand DramScheduler::best_command(const DramQueue& queue, bool writes, bool is_overdue, Cycle now) const {
  const EligibleBanks eligible = policy_ == DramSchedulingPolicy::kFcfs ? Fcfs::eligible_banks(queue, is_overdue)
                                                                        : FrFcfs::eligible_banks(queue, is_overdue);
  const Cycle from = device_.first_awake_cycle(now);
  ScheduledCommand best;
  for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
    const std::uint32_t here = eligible.all & device_.bank_mask_of_rank(rank), others = here & ~eligible.columns;
    keep_better_command<DramCommand::kColumn>(queue, here & eligible.columns, rank, writes, from, best);
    keep_better_command<DramCommand::kActivate>(queue, others & ~device_.open_bank_mask(), rank, writes, from, best);
    keep_better_command<DramCommand::kPrecharge>(queue, others & device_.open_bank_mask(), rank, writes, from, best);
  }
  return best;
}

}  // namespace hw
