#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/dram/dram_config.h"
#include "hw_models/dram/dram_device.h"
#include "hw_models/dram/dram_queue.h"
#include "hw_models/dram/dram_scheduler.h"
#include "hw_models/memory/arbiter.h"
#include "hw_models/memory/messages.h"
#include "hw_models/memory/observer.h"
#include "hw_models/memory/unit_names.h"
#include "sim/activity.h"
#include "sim/inputs.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/ring.h"

namespace hw {

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
