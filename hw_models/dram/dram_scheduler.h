#pragma once
#include <array>
#include <compare>
#include <cstdint>

#include "hw_models/dram/dram_config.h"
#include "hw_models/dram/dram_device.h"
#include "hw_models/dram/dram_queue.h"
#include "sim/time.h"

namespace hw {

/// The next command of a DRAM channel, unless a new request changes the choice. The command is encoded as one number,
/// so that the preferred command is the smallest: by earliest cycle, then kind of command, then age of the request. The
/// low bits hold the bank.
class ScheduledCommand {
 public:
  using Cycle = CommandCalendar::Cycle;

  /// Constructs the encoding of "no command", which sorts after every command.
  ScheduledCommand() = default;
  /// Constructs a command that starts at cycle `at` for the request at position `position` of its DramQueue.
  ScheduledCommand(Cycle at, DramCommand command, std::uint32_t position, std::uint32_t bank)
      : key_(at << kAt.first | std::uint64_t{static_cast<std::uint8_t>(command)} << kCommand.first |
             position << kPosition.first | bank << kBank.first) {}

  bool is_none() const { return key_ == kNone; }
  Cycle start_cycle() const { return is_none() ? sim::kNever : kAt.extract_from(key_); }
  DramCommand command_kind() const { return static_cast<DramCommand>(kCommand.extract_from(key_)); }
  std::uint32_t queue_position() const { return static_cast<std::uint32_t>(kPosition.extract_from(key_)); }
  std::uint32_t bank() const { return static_cast<std::uint32_t>(kBank.extract_from(key_)); }
  friend auto operator<=>(const ScheduledCommand&, const ScheduledCommand&) = default;

 private:
  /// A bit field of the number that encodes a DRAM command: `bits` bits from bit `first` upwards.
  struct BitField {
    std::uint32_t first, bits;
    constexpr std::uint64_t extract_from(std::uint64_t key) const {
      return key >> first & ((std::uint64_t{1} << bits) - 1);
    }
  };
  static constexpr BitField kBank{0, 5}, kPosition{5, 6}, kCommand{11, 2}, kAt{13, 51};

  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::uint64_t key_ = kNone;
};

/// Masks of the DRAM banks for which a scheduling policy allows commands.
struct EligibleBanks {
  std::uint32_t all = 0;      ///< mask of the banks for which the policy allows any command
  std::uint32_t columns = 0;  ///< mask of the banks for which the policy allows a read or write of the open row
};

/// FR-FCFS (first ready, first come, first served; Rixner et al. 2000). A row hit may overtake older requests of its
/// bank until the queue's oldest request exceeds the age limit.
struct FrFcfs {
  static EligibleBanks eligible_banks(const DramQueue& queue, bool is_overdue) {
    EligibleBanks banks{queue.requested_bank_mask(), queue.hit_bank_mask()};
    if (is_overdue) [[unlikely]]
      banks.columns = hit_bank_mask_protecting_oldest(queue);
    return banks;
  }
  /// Returns a mask of the banks with queued row hits. The bank of the oldest request is included only if that request
  /// hits.
  static std::uint32_t hit_bank_mask_protecting_oldest(const DramQueue& queue) {
    const std::uint32_t bank = queue.oldest_entry().address.bank;
    return (queue.hit_position_mask(bank) & 1) != 0 ? queue.hit_bank_mask() : queue.hit_bank_mask() & ~(1U << bank);
  }
};

/// FCFS (first come, first served): the oldest request in the DRAM queue blocks all others.
struct Fcfs {
  static EligibleBanks eligible_banks(const DramQueue& queue, bool /*is_overdue*/) {
    return {1U << queue.oldest_entry().address.bank, FrFcfs::hit_bank_mask_protecting_oldest(queue)};
  }
};

/// Chooses a DRAM channel's next command among the banks that the policy allows. The earliest command wins. Among
/// equally early ones, column commands precede activates, activates precede precharges, then the oldest request wins.
class DramScheduler {
 public:
  using Cycle = DramDevice::Cycle;

  DramScheduler(const DramConfig& config, const DramDevice& device)
      : policy_(config.controller.scheduler), ranks_(config.organisation.ranks), device_(device) {}

  /// Returns the preferred command for the requests in a DRAM queue. `writes`: the queue is the write queue.
  /// `is_overdue`: its oldest request exceeds the age limit.
  ScheduledCommand best_command(const DramQueue& queue, bool writes, bool is_overdue, Cycle now) const;

 private:
  template <DramCommand kCommand>
  void keep_better_command(const DramQueue& queue, std::uint32_t bank_mask, std::uint32_t rank, bool writes, Cycle from,
                           ScheduledCommand& best) const;

  const DramSchedulingPolicy policy_;
  const std::uint32_t ranks_;
  const DramDevice& device_;
};

/// Decides whether a DRAM row is closed after its last queued hit.
///
/// The adaptive policy closes the row if a request for another row of the bank waits. Otherwise a two-bit saturating
/// counter per bank decides: the row is closed if the counter is at least 2. The first request after a last hit moves
/// the counter up if it needs another row, otherwise down, whatever was decided for that row.
class DramPagePolicy {
 public:
  explicit DramPagePolicy(PagePolicy policy) : policy_(policy) {}

  /// True if the row is to be closed after the row hit being served, when no further hit is queued. `other_rows_wait`:
  /// requests for other rows of the bank are queued.
  bool should_close_row(std::uint32_t bank, std::uint32_t row, bool other_rows_wait) {
    if (policy_ != PagePolicy::kAdaptive) return policy_ == PagePolicy::kClosed;
    if (other_rows_wait) {
      count_next_row(bank, true);
      return true;
    }
    last_row_[bank] = row;
    untrained_banks_ |= 1U << bank;
    return others_[bank] >= 2;
  }

  /// Updates the row predictor of a DRAM bank when a request arrives.
  void note_request(std::uint32_t bank, std::uint32_t row) {
    if ((untrained_banks_ >> bank & 1) == 0) return;
    untrained_banks_ &= ~(1U << bank);
    count_next_row(bank, row != last_row_[bank]);
  }

 private:
  void count_next_row(std::uint32_t bank, bool is_other_row) {
    std::uint8_t& n = others_[bank];
    if (is_other_row ? n < 3 : n > 0) n = static_cast<std::uint8_t>(is_other_row ? n + 1 : n - 1);
  }

  PagePolicy policy_;
  std::uint32_t untrained_banks_ = 0;  ///< mask of the banks whose predictor is updated by the next request
  std::array<std::uint32_t, 32> last_row_{};
  std::array<std::uint8_t, 32> others_{};  ///< two-bit counter of each bank; 2 or 3 predicts that the next request
                                           ///< needs another row
};

}  // namespace hw
