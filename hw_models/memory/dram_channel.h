#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hw_models/memory/data_bus.h"
#include "hw_models/memory/dram_config.h"
#include "hw_models/memory/dram_queue.h"
#include "hw_models/memory/messages.h"
#include "hw_models/memory/slot_calendar.h"
#include "sim/activity.h"
#include "sim/link.h"

namespace hw {

/// One LPDDR channel with its controller. State is "the first cycle at which this command may run", never a countdown.
///
///   ports_in --> one request per cycle --> [read queue ] --> ACT / RD / WR / PRE on the command bus --> banks
///                                          [write queue]                                               |
///   ports_out <-- [returns: fixed fabric latency] <--------- data bus <--------------------------------+
///
/// First ready, first come first served, rows left open: a column command before an activate before a precharge, the
/// oldest first among equals. A request older than the age limit is no longer overtaken in its bank. Writes wait until
/// the queue is filled to its high mark, an old write or an idle read queue calls them, and then go to the low mark.
/// The bursts of a line are booked as one train; other bank groups and other commands fit between them. Refresh goes
/// round the banks, one per interval, closes the bank and keeps it busy.
/// A response leaves on the port on which its request came, with `source` and `tag` unchanged.
/// Not modelled: forwarding from the write queue, postponed refresh, command slots of refreshes and their distance to
/// activates of other banks (LPDDR5 refreshes banks in pairs), power-down, ranks, masked writes, WCK synchronisation.
class DramChannel {
 public:
  enum class Why : std::uint8_t {
    kIdle,         ///< nothing queued, no data expected
    kReading,      ///< read data on the bus
    kWriting,      ///< write data on the bus
    kLatency,      ///< nothing queued, data on their way
    kRowConflict,  ///< another row must be closed first (tRAS, tRTP, tWR, tRP)
    kActivate,     ///< a row is being opened, or activates follow too closely (tRCD, tRC, tRRD, tFAW)
    kRefresh,      ///< the bank is refreshing
    kTurnaround,   ///< the data bus changes direction
    kColumn,       ///< column commands follow too closely (tCCD)
    kCommandBus,   ///< the command bus is taken
    kReturnsFull,  ///< reads cannot start because responses do not leave
    kCount
  };
  struct Stats {
    std::uint64_t reads = 0, writes = 0, bytes = 0;
    std::uint64_t row_hits = 0, row_misses = 0, row_conflicts = 0;
    std::uint64_t activates = 0, read_bursts = 0, write_bursts = 0, refreshes = 0, turnarounds = 0;
    std::uint64_t read_latency = 0, read_latency_max = 0;
    std::uint64_t active_standby = 0, precharge_standby = 0;
    static void describe(auto& s, auto&& counter) {
      counter(s.reads, "reads", "lines read");
      counter(s.writes, "writes", "lines written");
      counter(s.bytes, "bytes", "bytes moved over the data bus");
      counter(s.row_hits, "row_hits", "lines whose row was open");
      counter(s.row_misses, "row_misses", "lines whose bank was closed");
      counter(s.row_conflicts, "row_conflicts", "lines for which another row was closed");
      counter(s.activates, "activates", "rows opened", "dram.activate");
      counter(s.read_bursts, "read_bursts", "read commands", "dram.read_burst");
      counter(s.write_bursts, "write_bursts", "write commands", "dram.write_burst");
      counter(s.refreshes, "refreshes", "refreshes of one bank", "dram.refresh");
      counter(s.turnarounds, "turnarounds", "changes of direction between reads and writes");
      counter(s.read_latency, "read_latency", "sum over reads of cycles from arrival here to the last data");
      counter(s.read_latency_max, "read_latency_max", "the longest of these");
      counter(s.active_standby, "active_standby", "cycles with a row open somewhere", "dram.active_standby");
      counter(s.precharge_standby, "precharge_standby", "cycles with every row closed", "dram.precharge_standby");
    }
  };
  struct Links {
    std::vector<sim::Link<MemRequest>*> ports_in;
    std::vector<sim::Link<MemResponse>*> ports_out;
  };

  DramChannel(const DramConfig& config, Links links);
  DramChannel(const DramChannel&) = delete;
  DramChannel& operator=(const DramChannel&) = delete;

  sim::Time tick(sim::Time now);
  /// Brings every counter up to `end`, an edge of the clock.
  void finish(sim::Time end);
  /// Nothing is queued and no response is on its way.
  bool idle() const { return reads_.empty() && writes_.empty() && returns_.size == 0; }

  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<Why>& activity() const { return activity_; }
  std::string state() const;

 private:
  using Cycle = std::uint64_t;
  static constexpr std::uint32_t kMaxBanks = 32;
  static constexpr std::uint32_t kMaxGroups = 8;

  struct Bank {
    bool open = false;
    std::uint32_t row = 0;
    Cycle activate_at = 0, column_at = 0, precharge_at = 0;
    Why closed_why = Why::kActivate;  ///< what activate_at waits for
  };
  enum class Command : std::uint8_t { kColumn, kActivate, kPrecharge, kNone };  ///< in the order of preference
  /// The command that comes next if nothing new arrives.
  struct Plan {
    Cycle at = sim::kNever;
    Command command = Command::kNone;
    std::uint32_t place = 0;  ///< of the request it serves
    std::uint32_t bank = 0;
    bool before(const Plan& other) const;
  };
  struct Return {
    MemResponse response;
    std::uint16_t port = 0;
    Cycle due = 0;
  };
  struct Returns {
    std::vector<Return> slots;
    std::size_t head = 0, size = 0;
  };

  void settle(Cycle until);
  void refresh(Cycle now);
  void take_request(sim::Time now, Cycle cycle);
  void respond(sim::Time now, Cycle cycle);
  sim::Time next_wake(sim::Time now) const;

  void replan(Cycle now);
  bool writes_first(Cycle now);
  Plan best_plan(const DramQueue& queue, Cycle now) const;
  Cycle column_at(std::uint32_t bank, Cycle from) const;
  Cycle direction_at(std::uint32_t bank) const;
  Why reason(const Plan& plan) const;
  void issue(Cycle now);
  void activate(DramQueue::Entry& entry, Cycle now);
  void close(std::uint32_t bank, Cycle at);
  void read(const DramQueue::Entry& entry, Cycle now);
  void write(const DramQueue::Entry& entry, Cycle now);
  void book_train(Cycle now, Cycle data, bool write);
  void count_line(const DramQueue::Entry& entry);
  void count_standby(Cycle until);

  bool overdue(const DramQueue& queue, Cycle now) const {
    return !queue.empty() && now >= queue.oldest().arrived + controller_.age_limit;
  }
  std::uint32_t group_of(std::uint32_t bank) const { return bank & group_mask_; }

  // Configuration, and what follows from it.
  const DramTiming t_;
  const DramController controller_;
  const DramMap map_;
  const std::uint32_t banks_in_use_;
  const std::uint32_t group_mask_;
  const std::uint32_t bursts_;
  const std::uint64_t line_bytes_;
  const Cycle fabric_;
  const Cycle train_length_;  ///< first to last column command of a line
  const std::uint64_t data_train_, column_train_, activate_slots_, precharge_slots_;
  const sim::Clock clock_;
  Links links_;

  // Requests and responses.
  DramQueue reads_, writes_;
  Returns returns_;
  std::uint32_t port_turn_ = 0;
  bool draining_ = false;  ///< writes go first, down to the low mark
  bool writing_ = false;   ///< the plan serves the write queue
  Plan plan_;
  bool plan_is_stale_ = true;
  Cycle replan_at_ = sim::kNever;  ///< when a request becomes overdue

  // The device.
  std::array<Bank, kMaxBanks> banks_;
  std::array<Cycle, kMaxGroups> group_column_at_{}, group_read_at_{};
  Cycle read_at_ = 0, write_at_ = 0;  ///< after data in the other direction
  bool last_was_write_ = false;
  Cycle activate_at_ = 0;                  ///< tRRD
  std::array<Cycle, 4> four_activates_{};  ///< tFAW: when each of the last four leaves the window
  std::uint32_t oldest_activate_ = 0;
  SlotCalendar command_bus_, column_slots_;
  DataBus data_bus_;
  Cycle refresh_at_;
  std::uint32_t refresh_bank_ = 0;

  // Accounting.
  Cycle settled_ = 0;
  Why waiting_ = Why::kIdle;
  std::uint32_t open_banks_ = 0;
  Cycle active_since_ = 0, active_until_ = 0;
  Stats stats_;
  sim::Activity<Why> activity_;
};

constexpr std::array<std::string_view, 11> names_of(DramChannel::Why) {
  return {"idle",    "reading",    "writing", "latency",     "row_conflict", "activate",
          "refresh", "turnaround", "column",  "command_bus", "returns_full"};
}

}  // namespace hw
