#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/dram/dram_config.h"
#include "hw_models/dram/dram_device.h"
#include "hw_models/memory/messages.h"
#include "hw_models/memory/observer.h"
#include "hw_models/memory/unit_names.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/ring.h"
#include "sim/time.h"
#include "sim/unit_report.h"

namespace hw {

/// The read queue or write queue of a DRAM channel, oldest request first. For each bank, one bit mask marks the queue
/// positions of its requests, another those of its row hits. So the scheduler searches banks instead of requests.
class DramQueue {
 public:
  struct Entry {
    MemRequest request;
    DramAddress address;
    std::uint64_t arrived = 0;
    std::uint16_t port = 0;
    bool precharged = false;  ///< the DRAM channel precharged the bank for this request
    bool activated = false;   ///< the DRAM channel opened the row for this request
  };

  DramQueue(std::uint32_t capacity, std::uint32_t bank_count)
      : capacity_(capacity), waiting_(bank_count), hits_(bank_count) {
    assert(capacity <= 64);
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<std::uint8_t>(i);
  }

  bool empty() const { return size_ == 0; }
  bool is_full() const { return size_ == capacity_; }
  std::uint32_t size() const { return size_; }
  const Entry& oldest_entry() const { return entries_[order_[0]]; }
  Entry& at(std::uint32_t position) { return entries_[order_[position]]; }
  const Entry& at(std::uint32_t position) const { return entries_[order_[position]]; }

  /// Returns a mask of the DRAM banks with queued requests.
  std::uint32_t requested_bank_mask() const { return banks_; }
  /// Returns a mask of the DRAM banks with a queued row hit.
  std::uint32_t hit_bank_mask() const { return hit_banks_; }
  /// Returns a mask of the queue positions of all requests for DRAM bank `bank`.
  std::uint64_t request_position_mask(std::uint32_t bank) const { return waiting_[bank]; }
  /// Returns a mask of the queue positions of all requests that hit the open row of DRAM bank `bank`.
  std::uint64_t hit_position_mask(std::uint32_t bank) const { return hits_[bank]; }

  /// Returns a mask of the queue positions of all requests for the banks in the mask `bank_mask`.
  std::uint64_t request_position_mask_of_banks(std::uint32_t bank_mask) const {
    return waiting_.bitwise_or_of(bank_mask);
  }
  /// Returns a mask of the queue positions of all row hits of the banks in the mask `bank_mask`.
  std::uint64_t hit_position_mask_of_banks(std::uint32_t bank_mask) const { return hits_.bitwise_or_of(bank_mask); }

  void push(const Entry& entry, bool row_is_open) {
    assert(!is_full());
    const std::uint32_t bank = entry.address.bank;
    const std::uint64_t bit = std::uint64_t{1} << size_;
    entries_[order_[size_]] = entry;
    size_ += 1;
    waiting_[bank] |= bit;
    if (row_is_open) set_hit_positions(bank, hits_[bank] | bit);
    banks_ |= 1U << bank;
  }

  void remove_at(std::uint32_t position) {
    assert(position < size_);
    const std::uint8_t slot = order_[position];
    const std::uint32_t bank = entries_[slot].address.bank;
    std::copy(order_.data() + position + 1, order_.data() + size_, order_.data() + position);
    size_ -= 1;
    order_[size_] = slot;
    waiting_.transform_all([&](std::uint64_t positions) { return without_position(positions, position); });
    hits_.transform_all([&](std::uint64_t positions) { return without_position(positions, position); });
    set_hit_positions(bank, hits_[bank]);
    if (waiting_[bank] == 0) banks_ &= ~(1U << bank);
  }

  void note_row_opened(std::uint32_t bank, std::uint32_t row) {
    std::uint64_t hits = 0;
    for (std::uint64_t left = waiting_[bank]; left != 0; left &= left - 1) {
      const auto position = static_cast<std::size_t>(std::countr_zero(left));
      if (entries_[order_[position]].address.row == row) hits |= std::uint64_t{1} << position;
    }
    set_hit_positions(bank, hits);
  }
  void note_row_closed(std::uint32_t bank) { set_hit_positions(bank, 0); }

 private:
  void set_hit_positions(std::uint32_t bank, std::uint64_t position_mask) {
    hits_[bank] = position_mask;
    hit_banks_ = (hit_banks_ & ~(1U << bank)) | std::uint32_t{position_mask != 0} << bank;
  }

  /// Returns a mask of queue positions without one removed request. The bits of later requests move down by one.
  static std::uint64_t without_position(std::uint64_t position_mask, std::uint32_t position) {
    const std::uint64_t before = (std::uint64_t{1} << position) - 1;
    return (position_mask & before) | ((position_mask >> 1) & ~before);
  }

  std::uint32_t capacity_;
  std::uint32_t size_ = 0;
  std::uint32_t banks_ = 0;
  std::uint32_t hit_banks_ = 0;
  std::array<std::uint8_t, 64> order_{};
  std::array<Entry, 64> entries_{};
  BankLanes waiting_, hits_;
};

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

/// Queue of the bursts that are booked on a DRAM channel's data bus and have not ended yet, sorted by start time.
class DataBus {
 public:
  using Cycle = std::uint64_t;
  struct Burst {
    Cycle begin = 0, end = 0;
    bool write = false;
  };

  explicit DataBus(std::size_t capacity) : bursts_(capacity), capacity_(capacity) {}

  bool empty() const { return size_ == 0; }
  const Burst& front() const { return bursts_[head_]; }
  void pop() {
    head_ = next_index(head_);
    size_ -= 1;
  }

  /// Books a burst on the DRAM data bus. The burst may begin before bursts that were booked earlier, because bursts of
  /// two bank groups interleave.
  void book_burst(Burst burst) {
    assert(size_ < capacity_);
    std::size_t i = head_ + size_ < capacity_ ? head_ + size_ : head_ + size_ - capacity_;
    size_ += 1;
    for (std::size_t left = size_ - 1; left > 0; --left) {
      const std::size_t before = i == 0 ? capacity_ - 1 : i - 1;
      if (bursts_[before].begin <= burst.begin) break;
      bursts_[i] = bursts_[before];
      i = before;
    }
    bursts_[i] = burst;
  }

 private:
  std::size_t next_index(std::size_t i) const { return i + 1 == capacity_ ? 0 : i + 1; }

  std::vector<Burst> bursts_;
  std::size_t capacity_;
  std::size_t head_ = 0;
  std::size_t size_ = 0;
};

/// One LPDDR channel with its controller. Timing state is stored as earliest allowed cycles, not as countdowns.
///
///   ports_in --> one request per cycle --> [read queue ] --> ACT / RD / WR / PRE on the command bus --> banks
///                                          [write queue]                                               |
///   ports_out <-- [returns: fixed fabric latency] <--------- data bus <--------------------------------+
///
/// 1. The scheduler is FR-FCFS or FCFS. It prefers column commands to activates and activates to precharges, then the
/// oldest request. A queue's oldest request is not overtaken in its bank once it exceeds the age limit.
/// 2. Reads go before writes until the write queue reaches its high mark. Then writes go first, down to the low mark.
/// Writes also go while there are no reads, or when a write exceeds the age limit.
/// 3. All bursts of a line are booked at once. Bursts of other bank groups and other commands use the gaps between
/// them.
/// 4. A row stays open, or is closed by its last queued hit (DramPagePolicy).
/// 5. Once per interval, one bank, a pair of banks or a whole rank is closed and refreshed. Ranks take turns.
/// 6. An idle channel may power down: all ranks together, with all rows closed. A refresh wakes the channel until the
/// refresh ends.
/// 7. A response leaves on the port at which its request arrived, with the request's `source` and `tag`.
/// 8. An ideal channel answers every request in the cycle of its arrival, so only the links delay it. The bursts of its
/// lines still cost energy.
///
/// Not modelled: forwarding from the write queue, postponed refresh, command bus cycles of refreshes, constraints
/// between refreshes and activates of other banks except pbr2act, power-down of single ranks or with open rows, self
/// refresh, masked writes.
class DramChannel {
 public:
  static constexpr const char* kName = "dram.channel";
  static constexpr Block kBlock = Block::kDram;
  /// Maximum number of lines that the DRAM channel sends to one port in one tick: a line that waited, and a line that
  /// was read in this tick.
  static constexpr std::size_t kMaxLinesPerTick = 2;
  using CycleReason = DramCycleReason;
  static constexpr auto kReasons = kDramReasons;
  struct Stats {
    std::uint64_t reads = 0, writes = 0, bytes = 0;
    std::uint64_t row_hits = 0, row_misses = 0, row_conflicts = 0;
    std::uint64_t activates = 0, read_bursts = 0, write_bursts = 0, turnarounds = 0;
    std::uint64_t refreshes = 0, refreshes_all = 0, power_downs = 0;
    std::uint64_t read_latency = 0, read_latency_max = 0;
    std::uint64_t active_standby = 0, precharge_standby = 0, power_down = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.reads), "lines read");
      counter(NAMED(s.writes), "lines written");
      counter(NAMED(s.bytes), "bytes moved over the data bus");
      counter(NAMED(s.row_hits), "lines whose row was open");
      counter(NAMED(s.row_misses), "lines whose bank was closed");
      counter(NAMED(s.row_conflicts), "lines for which another row was closed");
      counter(NAMED(s.activates), "rows opened", "dram.activate");
      counter(NAMED(s.read_bursts), "read commands", "dram.read_burst");
      counter(NAMED(s.write_bursts), "write commands", "dram.write_burst");
      counter(NAMED(s.refreshes), "refreshes of one bank or pair of banks", "dram.refresh");
      counter(NAMED(s.refreshes_all), "refreshes of all banks of a rank", "dram.refresh_all");
      counter(NAMED(s.turnarounds), "changes of direction between reads and writes", "", sim::CounterKind::kAtEnd);
      counter(NAMED(s.read_latency), "sum over reads of cycles from arrival here to the last data");
      counter(NAMED(s.read_latency_max), "the longest of these latencies", "", sim::CounterKind::kPeak);
      counter(NAMED(s.active_standby), "cycles with a row open, summed over ranks", "dram.active_standby",
              sim::CounterKind::kAtEnd);
      counter(NAMED(s.precharge_standby), "cycles with every row closed, summed over ranks", "dram.precharge_standby",
              sim::CounterKind::kAtEnd);
      counter(NAMED(s.power_down), "cycles in power-down, summed over ranks", "dram.power_down");
      counter(NAMED(s.power_downs), "times that the channel woke from power-down for a request");
    }
  };
  struct Links {
    std::vector<sim::Link<MemRequest>*> ports_in;
    std::vector<sim::Link<MemResponse>*> ports_out;
    Observer* observer = nullptr;
  };

  DramChannel(const DramConfig& config, Links links, bool ideal = false, const DramPerturbation& perturbation = {});
  DramChannel(const DramChannel&) = delete;
  DramChannel& operator=(const DramChannel&) = delete;

  sim::Time tick(sim::Time now);
  /// Updates all counters of the DRAM channel to the time `end`, which must be an edge of the channel's clock.
  void finish(sim::Time end);
  /// True if the DRAM channel holds no queued request and no pending response.
  bool idle() const { return reads_.empty() && writes_.empty() && returns_.empty(); }

  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  std::string state() const;

 private:
  using Cycle = DramDevice::Cycle;

  struct Return {
    MemResponse response;
    std::uint16_t port = 0;
    sim::Time due = 0;
  };

  void account_until(Cycle until);
  void run_due_refreshes(Cycle now);
  std::uint32_t next_bank_to_refresh(std::uint32_t rank) const;
  void refresh_banks(std::uint32_t rank, Cycle due);
  void note_rows_closed(std::uint32_t bank_mask);
  void power_down_if_idle(Cycle now);
  void count_power_down_cycles(Cycle until);
  void leave_power_down(Cycle now);
  void take_request(sim::Time now, Cycle cycle);
  bool send_response(const Return& line, sim::Time now);
  sim::Time next_wake(sim::Time now) const;
  sim::Time tick_ideal(sim::Time now);

  void choose_next_command(Cycle now);
  bool serves_writes_first(Cycle read_due, Cycle write_due, Cycle now) const;
  bool next_command_survives(bool write, std::uint32_t bank, bool row_is_open) const;
  ScheduledCommand best_command(Cycle now) const;
  CycleReason wait_reason() const;
  void issue_command(sim::Time now, Cycle cycle);
  void apply_page_policy(const DramAddress& address);
  void transfer_line(const DramQueue::Entry& entry, sim::Time now, Cycle cycle);
  /// Returns the cycle at which the oldest request in the DRAM queue exceeds the controller's age limit.
  Cycle overdue_cycle(const DramQueue& queue) const {
    return queue.empty() ? sim::kNever : queue.oldest_entry().arrived + controller_.age_limit;
  }
  bool has_room_for(const MemRequest& request) const { return !(request.write ? writes_ : reads_).is_full(); }

  const DramController controller_;
  const DramMap map_;
  const std::uint32_t ranks_;
  const bool ideal_;
  const std::uint32_t bursts_;
  const std::uint64_t line_bytes_;
  const Cycle fabric_;
  const Cycle refresh_interval_;  ///< cycles between two refreshes of a DRAM rank; 0: no refreshes
  const std::uint32_t refresh_cycles_;
  const std::uint32_t exit_cycles_;  ///< cycles from the end of power-down to the first DRAM command
  const sim::Clock clock_;
  const sim::Inputs<MemRequest> ports_in_;
  const std::vector<sim::Link<MemResponse>*> ports_out_;
  Observer* const observer_;

  DramDevice device_;
  const DramScheduler scheduler_;
  DataBus data_bus_;
  DramPagePolicy page_policy_;
  Cycle refresh_at_;
  std::uint64_t refresh_turn_ = 0;   ///< number of refreshes so far, which determines the rank to refresh next
  std::uint32_t unrefreshed_banks_;  ///< mask of the banks that have not been refreshed in this refresh round

  Cycle data_end_ = 0;  ///< last cycle for which data are booked on the data bus
  bool is_down_ = false;
  Cycle down_since_ = 0;    ///< cycle at which power-down began, if `is_down_`
  Cycle down_counted_ = 0;  ///< cycle up to which power-down time has been counted

  DramQueue reads_, writes_;
  sim::Ring<Return> returns_;
  /// Capacity of the queue of read responses: twice the lines that a saturated data bus moves during the latency of
  /// device and fabric.
  std::size_t max_returns_;
  sim::Time return_at_ = 0;  ///< earliest time at which the channel can send its next response
  Arbiter ports_;
  bool draining_ = false;  ///< writes are served before reads until the write queue is down to its low mark
  bool writing_ = false;   ///< the next command, `next_`, serves a request of the write queue
  ScheduledCommand next_;
  bool next_is_stale_ = true;
  Cycle reschedule_at_ = sim::kNever;  ///< next cycle at which the oldest read or write exceeds the age limit

  Cycle accounted_until_ = 0;
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
