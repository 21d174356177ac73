#include <algorithm>
#include <bit>

#include "hw_models/dram/dram_channel.h"

namespace hw {

/// Replaces `best` by the best such command in these banks of a rank, if that is better. What holds commands up, but
/// for their bank, is the same for all banks of the rank: the first slot for the first that is ready is that of all
/// that are ready by its `ready_by`, and the oldest request among these gets it.
template <DramCommand kCommand>
[[gnu::always_inline]] inline void DramChannel::best_of(const DramQueue& queue, std::uint32_t banks, std::uint32_t rank,
                                                        Cycle from, ScheduledCommand& best) const {
  if (banks == 0) return;
  const Cycle rank_ready = device_.rank_ready(kCommand, rank, writing_, from), lead = device_.lead(kCommand);
  const auto none_is_better = [&](Cycle ready) {
    return best < ScheduledCommand(std::max(from + lead, ready) - lead, kCommand, 0, 0);
  };
  if (none_is_better(rank_ready)) return;
  const auto each_bank = [&](auto&& f) {
    for (std::uint32_t left = banks; left != 0; left &= left - 1) {
      const auto bank = static_cast<std::uint32_t>(std::countr_zero(left));
      f(bank, device_.ready(kCommand, bank, writing_, rank_ready));
    }
  };
  const auto wanted = [&](std::uint32_t bank) {
    return kCommand == DramCommand::kColumn ? queue.hits(bank) : queue.waiting(bank);
  };
  const auto take = [&](Cycle at, std::uint64_t positions) {
    const auto oldest = static_cast<std::uint32_t>(std::countr_zero(positions));
    best = std::min(best, ScheduledCommand(at, kCommand, oldest, queue.at(oldest).address.bank));
  };
  Cycle soonest = sim::kNever;
  each_bank([&](std::uint32_t, Cycle ready) { soonest = std::min(soonest, ready); });
  if (none_is_better(soonest)) return;
  const DramDevice::Slot slot = device_.slot(kCommand, rank, soonest, from);
  if (kCommand == DramCommand::kColumn && slot.in_doubt) [[unlikely]] {
    each_bank(
        [&](std::uint32_t bank, Cycle ready) { take(device_.slot(kCommand, rank, ready, from).at, wanted(bank)); });
  } else {
    std::uint64_t positions = 0;
    each_bank([&](std::uint32_t bank, Cycle ready) { positions |= ready <= slot.ready_by ? wanted(bank) : 0; });
    take(slot.at, positions);
  }
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
