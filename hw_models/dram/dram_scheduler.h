#pragma once
#include <array>
#include <compare>
#include <cstdint>

#include "hw_models/dram/dram_config.h"
#include "hw_models/dram/dram_device.h"
#include "hw_models/dram/dram_queue.h"
#include "sim/time.h"

namespace hw {

/// The command that a channel runs next if no request arrives before. It is one number that sorts by preference:
/// earliest cycle, then kind of command, then oldest request. The low bits hold the bank.
class ScheduledCommand {
 public:
  using Cycle = CommandCalendar::Cycle;

  /// No command.
  ScheduledCommand() = default;
  /// `position`: the request's position in its DramQueue.
  ScheduledCommand(Cycle at, DramCommand command, std::uint32_t position, std::uint32_t bank)
      : key_(at << kAt.first | std::uint64_t{static_cast<std::uint8_t>(command)} << kCommand.first |
             position << kPosition.first | bank << kBank.first) {}

  bool is_none() const { return key_ == kNone; }
  Cycle start_cycle() const { return is_none() ? sim::kNever : kAt.extract_from(key_); }
  DramCommand command() const { return static_cast<DramCommand>(kCommand.extract_from(key_)); }
  std::uint32_t position() const { return static_cast<std::uint32_t>(kPosition.extract_from(key_)); }
  std::uint32_t bank() const { return static_cast<std::uint32_t>(kBank.extract_from(key_)); }
  friend auto operator<=>(const ScheduledCommand&, const ScheduledCommand&) = default;

 private:
  /// A field of `bits` bits of the key, from bit `first` on.
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

/// Banks in which a scheduling policy allows commands, as masks.
struct EligibleBanks {
  std::uint32_t all = 0;      ///< for any command
  std::uint32_t columns = 0;  ///< for reads or writes of the open row
};

/// First ready, first come, first served (Rixner et al. 2000): hits may overtake older requests of their bank until the
/// queue's oldest request is overdue.
struct FrFcfs {
  static EligibleBanks eligible_banks(const DramQueue& queue, bool is_overdue) {
    EligibleBanks banks{queue.requested_banks(), queue.hit_banks()};
    if (is_overdue) [[unlikely]]
      banks.columns = without_overtaking(queue);
    return banks;
  }
  /// Returns the banks with hits. The oldest request's bank is included only if that request is a hit.
  static std::uint32_t without_overtaking(const DramQueue& queue) {
    const std::uint32_t bank = queue.oldest_entry().address.bank;
    return (queue.hit_positions(bank) & 1) != 0 ? queue.hit_banks() : queue.hit_banks() & ~(1U << bank);
  }
};

/// Strictly first come, first served: the oldest request blocks all others.
struct Fcfs {
  static EligibleBanks eligible_banks(const DramQueue& queue, bool /*is_overdue*/) {
    return {1U << queue.oldest_entry().address.bank, FrFcfs::without_overtaking(queue)};
  }
};

/// Chooses a channel's next command among the banks that the policy allows: the earliest one; of equals, a column
/// command before an activate before a precharge; then that of the oldest request.
class DramScheduler {
 public:
  using Cycle = DramDevice::Cycle;

  DramScheduler(const DramConfig& config, const DramDevice& device)
      : policy_(config.controller.scheduler), ranks_(config.organisation.ranks), device_(device) {}

  /// `is_overdue`: the oldest request has exceeded the age limit.
  ScheduledCommand best_command(const DramQueue& queue, bool writes, bool is_overdue, Cycle now) const;

 private:
  template <DramCommand kCommand>
  void best_of(const DramQueue& queue, std::uint32_t banks, std::uint32_t rank, bool writes, Cycle from,
               ScheduledCommand& best) const;

  const DramSchedulingPolicy policy_;
  const std::uint32_t ranks_;
  const DramDevice& device_;
};

/// Decides whether a row is closed with its last queued hit. The adaptive policy closes it if a request for another row
/// of the bank is waiting. Otherwise it uses a two-bit counter per bank, which counts how often the next request needed
/// another row; it closes the row in the upper half. Only the next request after a last hit is counted, independent of
/// the decision and of refreshes.
class DramPagePolicy {
 public:
  explicit DramPagePolicy(PagePolicy policy) : policy_(policy) {}

  /// True if the row is closed with its last queued hit, which is being served. `others`: requests for other rows of
  /// the bank wait.
  bool closes_row(std::uint32_t bank, std::uint32_t row, bool others) {
    if (policy_ != PagePolicy::kAdaptive) return policy_ == PagePolicy::kClosed;
    if (others) {
      count_next_row(bank, true);
      return true;
    }
    last_row_[bank] = row;
    unproven_ |= 1U << bank;
    return others_[bank] >= 2;
  }

  /// Notes the arrival of a request for the bank.
  void note_request(std::uint32_t bank, std::uint32_t row) {
    if ((unproven_ >> bank & 1) == 0) return;
    unproven_ &= ~(1U << bank);
    count_next_row(bank, row != last_row_[bank]);
  }

 private:
  void count_next_row(std::uint32_t bank, bool other) {
    std::uint8_t& n = others_[bank];
    if (other ? n < 3 : n > 0) n = static_cast<std::uint8_t>(other ? n + 1 : n - 1);
  }

  PagePolicy policy_;
  std::uint32_t unproven_ = 0;  ///< banks whose next request is counted, as a mask
  std::array<std::uint32_t, 32> last_row_{};
  std::array<std::uint8_t, 32> others_{};  ///< the two-bit counters
};

}  // namespace hw
