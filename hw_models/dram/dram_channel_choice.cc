#include <algorithm>
#include <bit>

#include "hw_models/dram/dram_channel.h"

namespace hw {

/// Replaces `best` by the best such command in these banks of a rank, if that is better. Except for its bank, all banks
/// of the rank wait for the same things. So the rank's first slot belongs to the oldest request whose bank is ready by
/// then. If no bank is, the first slot after the earliest bank is ready is assigned in the same way.
template <DramCommand kCommand>
[[gnu::always_inline]] inline void DramChannel::best_of(const DramQueue& queue, std::uint32_t banks, std::uint32_t rank,
                                                        Cycle from, ScheduledCommand& best) const {
  if (banks == 0) return;
  const auto none_is_better = [&](Cycle at) { return best < ScheduledCommand(at, kCommand, 0, 0); };
  const Cycle rank_ready = device_.rank_ready(kCommand, rank, writing_, from);
  if (none_is_better(rank_ready)) return;
  const auto take = [&](Cycle at, std::uint64_t positions) {
    const auto oldest = static_cast<std::uint32_t>(std::countr_zero(positions));
    best = std::min(best, ScheduledCommand(at, kCommand, oldest, queue.at(oldest).address.bank));
  };
  // True if that slot is not better, or has been given away.
  const auto is_over = [&](Cycle slot) {
    if (none_is_better(slot)) return true;
    const std::uint32_t ready = banks & device_.ready_banks<kCommand>(writing_, slot);
    if (ready != 0) take(slot, kCommand == DramCommand::kColumn ? queue.hits_in(ready) : queue.waiting_in(ready));
    return ready != 0;
  };
  if (is_over(device_.slot(kCommand, rank, rank_ready))) return;
  is_over(device_.slot(kCommand, rank, device_.first_ready<kCommand>(banks, writing_)));
}

ScheduledCommand DramChannel::best_command(const DramQueue& queue, Cycle now) const {
  const bool in_turn = controller_.scheduler == DramScheduler::kFcfs;
  std::uint32_t banks = queue.banks(), columns = queue.hit_banks();
  if (in_turn || due(queue) <= now) [[unlikely]] {
    const std::uint32_t first = 1U << queue.oldest().address.bank;
    if ((queue.hits(queue.oldest().address.bank) & 1) == 0) columns &= ~first;
    if (in_turn) banks = first;
  }
  const Cycle from = device_.awake(now);
  ScheduledCommand best;
  for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
    const std::uint32_t here = banks & device_.banks_of(rank), others = here & ~columns;
    best_of<DramCommand::kColumn>(queue, here & columns, rank, from, best);
    best_of<DramCommand::kActivate>(queue, others & ~device_.open_mask(), rank, from, best);
    best_of<DramCommand::kPrecharge>(queue, others & device_.open_mask(), rank, from, best);
  }
  return best;
}

}  // namespace hw
