#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/branch_free.h"
#include "sim/intervals.h"
#include "sim/link.h"
#include "sim/time.h"
#include "sim/unit_report.h"

namespace sim {

/// The engine's table of wake-up times: one for each unit, and the minimum of each group of eight consecutive units.
/// The eight times of a group are compared at once (sim/branch_free.h).
class WakeupTable {
 public:
  static constexpr std::size_t kGroup = kMatchWidth;
  /// Rounds a number of units up to whole groups.
  static constexpr std::size_t round_up_to_groups(std::size_t units) { return (units + kGroup - 1) / kGroup * kGroup; }

  WakeupTable() = default;
  /// Creates a wake-up table in which all units wake at time 0.
  explicit WakeupTable(std::size_t units) { reset(units); }
  WakeupTable(const WakeupTable&) = delete;
  WakeupTable& operator=(const WakeupTable&) = delete;

  /// Resizes the wake-up table to `units` units. All of them wake at time `first`.
  void reset(std::size_t units, Time first = 0) {
    groups_.assign(round_up_to_groups(units) / kGroup, Eight{});
    for (Eight& group : groups_) group.fill(kNever);
    group_minima_.assign(round_up_to_groups(groups_.size()), kNever);
    for (std::size_t i = 0; i < units; ++i) lower_to(i, first);
    size_ = units;
  }
  std::size_t size() const { return size_; }

  WakeupHandle handle_of(std::size_t unit) { return {&time_of(unit), &group_minima_[unit / kGroup]}; }
  void lower_to(std::size_t unit, Time time) { handle_of(unit).lower_to(time); }

  /// A range of groups of the wake-up table: groups `first` to `end` - 1.
  struct Groups {
    std::size_t first = 0, end = 0;
  };

  /// Returns the earliest wake-up time of any unit.
  Time earliest_time() const {
    Time first = kNever;
    for (std::size_t i = 0; i < group_minima_.size(); i += kGroup)
      first = std::min(first, min_of_eight(&group_minima_[i]));
    return first;
  }
  /// Returns the earliest wake-up time of any unit in a range of groups.
  Time earliest_time(Groups groups) const {
    return min_of({group_minima_.data() + groups.first, groups.end - groups.first});
  }

  /// Returns the wake-up times of the units in a range of groups; null if the range is empty.
  Time* unit_times(Groups groups) { return groups.first == groups.end ? nullptr : groups_[groups.first].data(); }
  std::span<Time> group_minima(Groups groups) {
    return {group_minima_.data() + groups.first, groups.end - groups.first};
  }

  /// Calls tick(unit) for all units that are due at `now`, the earliest wake-up time of any unit. tick() returns the
  /// unit's next wake-up time. A tick may also lower the wake-up times of other units, to times after `now`.
  template <class Tick>
  void tick_due(Time now, Tick&& tick) {
    tick_due({0, groups_.size()}, now, tick);
  }
  /// Ticks the units in a range of groups that are due at `now`, the earliest wake-up time of the range.
  template <class Tick>
  void tick_due(Groups groups, Time now, Tick&& tick) {
    for (std::size_t g = groups.first; g < groups.end; ++g) {
      if (group_minima_[g] != now) continue;
      Eight& group = groups_[g];
      for (unsigned due = match_mask8(group.data(), now); due != 0; due &= due - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(due));
        group[i] = kNever;  // links may lower the unit's time during its tick
        const Time own = tick(g * kGroup + i);
        group[i] = std::min(group[i], own);
      }
      group_minima_[g] = min_of_eight(group.data());
    }
  }

  /// Ticks a unit, even if it is not due.
  template <class Tick>
  void tick_unit(std::size_t unit, Tick&& tick) {
    time_of(unit) = kNever;
    const Time own = tick(unit);
    lower_to(unit, own);
    group_minima_[unit / kGroup] = min_of_eight(groups_[unit / kGroup].data());
  }
  /// Returns the minimum of a few times; kNever for none. A loop of single loads is the fastest for one or two times.
  static Time min_of(std::span<const Time> few_times) {
    Time first = kNever;
    for (const Time& time : few_times) first = std::min(first, load_time(time));
    return first;
  }
  /// Returns the minimum of eight times. The times are loaded one by one, because vector loads of recently written
  /// single times would stall on store forwarding.
  static Time min_of_eight(const Time* eight_times) {
    const Time a = std::min(std::min(load_time(eight_times[0]), load_time(eight_times[1])),
                            std::min(load_time(eight_times[2]), load_time(eight_times[3])));
    const Time b = std::min(std::min(load_time(eight_times[4]), load_time(eight_times[5])),
                            std::min(load_time(eight_times[6]), load_time(eight_times[7])));
    return std::min(a, b);
  }
  /// Returns a mask of the units that wake at `now`. `times`: wake-up times of up to eight groups of units.
  static std::uint64_t due_mask(const Time* times, std::size_t group_count, Time now) {
    std::uint64_t due = match_mask8(times, now);
    for (std::size_t g = 1; g < group_count; ++g)
      due |= std::uint64_t{match_mask8(times + g * kGroup, now)} << g * kGroup;
    return due;
  }
  /// Recomputes the minimum of each group of wake-up times. Returns the minimum of all groups.
  static Time refresh_group_minima(const Time* times, std::span<Time> group_minima) {
    Time first = group_minima.front() = min_of_eight(times);
    for (std::size_t g = 1; g < group_minima.size(); ++g) {
      group_minima[g] = min_of_eight(times + g * kGroup);
      first = std::min(first, group_minima[g]);
    }
    return first;
  }
  Time operator[](std::size_t unit) const { return groups_[unit / kGroup][unit % kGroup]; }

 private:
  using Eight = std::array<Time, kGroup>;

  /// Loads one time with a separate instruction, so that the compiler does not load several at once.
  static Time load_time(const Time& time) { return const_cast<const volatile Time&>(time); }
  Time& time_of(std::size_t unit) { return groups_[unit / kGroup][unit % kGroup]; }

  std::vector<Eight> groups_;
  std::vector<Time> group_minima_;  ///< earliest wake-up time of each group
  std::size_t size_ = 0;
};

struct ClusterTurn;

/// A cluster: units of one partition and one clock, which their owner ticks by direct calls instead of the engine. An
/// optimisation: results do not change, because an action at time t is not visible at time t.
struct Cluster {
  WakeupTable::Groups units;  ///< groups of the wake-up table that contain the cluster's units
  void* owner = nullptr;
  void (*run)(void* owner, const ClusterTurn& turn, Time now) = nullptr;
};

/// A partition of a machine: a set of units. It may run without the other partitions for the latency of the links
/// between them (the lookahead), which keeps its state in the host's caches.
///
///   outer partitions --links--> [ the inner partition ] --links--> outer partitions
///
/// 1. An outer partition has links only to the inner partition.
/// 2. The inner partition runs first, up to the lookahead. The outer partitions follow.
/// 3. A partition with an outgoing link that may become full waits until the others have reached its time, because
/// their pops free slots.
/// 4. Results do not depend on the division into partitions.
struct Partition {
  WakeupTable::Groups units;      ///< groups of the wake-up table with the partition's units, without those of its
                                  ///< cluster
  std::uint32_t nearly_full = 0;  ///< number of links to other partitions that one tick may fill
  Cluster cluster;
};

/// Returns the time before which a partition of the machine must stop. `others_reached`: time before which the other
/// partitions have finished all work. `end`: limit for all partitions. While a link to another partition is nearly
/// full, the partition may run only up to time `others_reached`, inclusive.
inline Time run_limit(const Partition& partition, Time others_reached, Time end) {
  return std::min(end, partition.nearly_full == 0 ? end : others_reached + 1);
}

/// Argument of a cluster's run function: limits of the run, and the wake-up times that the cluster's owner updates.
struct ClusterTurn {
  Time* wakeup_times;            ///< wake-up times of the cluster's units, updated by the owner
  std::span<Time> group_minima;  ///< minimum of each group of eight of these times, updated by the owner
  const Partition& partition;
  Time inner;                    ///< time that the inner partition has reached
  Time end;                      ///< time before which the cluster's run ends
  std::span<const Time> others;  ///< earliest wake-up time in each group of the partition's other units

  /// True if the cluster may tick at time `at`: the partition may run to that time, and none of the partition's units
  /// outside the cluster is due before.
  bool includes_time(Time at) const {
    // A single comparison, because it is unpredictable which limit ends the turn.
    return at <= std::min(run_limit(partition, inner, end) - 1, WakeupTable::min_of(others));
  }
};

/// Times up to which the partitions of a machine may run one after the other when all have reached the same time.
struct RunLimits {
  Time lead;  ///< limit of the inner partition, which runs first
  Time end;   ///< limit of all partitions; no partition may run beyond it
};

/// All partitions of a machine: the inner one and the outer ones.
struct Partitions {
  std::vector<Partition> outer;
  Partition inner;
};

/// Identifies a declared unit when links are declared.
struct UnitId {
  std::size_t index;
  Clock clock;
};

/// How a link between two partitions of a machine limits the time for which each may run without the other.
enum class Lookahead : std::uint8_t {
  kByLatency,  ///< items may be pushed at any time, so the limit is the link's latency
  kByOwner,    ///< the machine's owner computes the arrival times of items, in run_limits()
};

/// A simulated machine: units and the links between them, each declared once. From them the machine derives wake-up
/// times, tick order, partitions, synchronisers between clock domains, reports and the end of a run.
///
///   unit(), unit(), ... --> link<T>(), ... --> build<U>(), ... --> sim::run
///
/// 1. Declare the units, then the links between them, then build the units with their links.
/// 2. Reports and states list units in the order of building.
/// 3. Units declared in sequence have neighbouring entries in the wake-up table. Declare units that are rarely awake
/// last.
/// 4. Throws std::logic_error for a unit that is undeclared, built twice or not built, and for any change after the
/// start.
class Machine {
 public:
  struct Declaration {
    std::string name;  ///< name of the unit: "core0.tni.trv2"
    Clock clock;
    std::size_t partition = 0;      ///< 0: the inner partition; others: outer
    std::uint64_t sram_bytes = 0;   ///< size of the unit's memory, for leakage
    std::uint64_t cache_bytes = 0;  ///< size of the part of the unit's memory whose accesses are counted; 0: all of it
    std::vector<UnitPart> parts{};  ///< parts whose number determines the unit's area
    std::uint32_t data_lines = 0;   ///< number of data pins of the unit at the die's edge
  };

  /// `synchroniser_cycles`: additional latency of links between two clock domains, in cycles of the consumer.
  explicit Machine(std::uint64_t synchroniser_cycles = 0) : synchroniser_cycles_(synchroniser_cycles) {}
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  UnitId unit(Declaration declaration);

  /// Declares a link from unit `from` to unit `to`, with a latency in cycles of `from`. `at_once`: maximum items that
  /// `from` pushes per tick; needed for links to another partition, except those with Lookahead::kByOwner.
  template <class T>
  Link<T>& link(std::size_t capacity, std::uint64_t latency_cycles, UnitId from, UnitId to,
                Lookahead lookahead = Lookahead::kByLatency, std::size_t at_once = 1) {
    auto wire = std::make_unique<Wire<T>>(capacity, latency_cycles, from.clock, to.clock, synchroniser_cycles_);
    require_rule(from.index < declared_.size() && to.index < declared_.size(), "a link is between declared units");
    require_rule(!is_started(), "a link is declared before the start");
    wire->from = from.index;
    wire->to = to.index;
    wire->lookahead = lookahead;
    wire->at_once = at_once;
    Link<T>& link = wire->link;
    wires_.push_back(std::move(wire));
    return link;
  }

  /// Builds a declared unit of class U from `args`. U must have tick(now) and clock(). Optional members are
  /// finish(end), state(), idle(), retired_items() and those used by sim::report_of. finish(end) updates cycles and
  /// counters to a clock edge, after which the unit may continue.
  template <class U, class... Args>
  U& build(UnitId id, Args&&... args) {
    require_unbuilt(id);
    auto built = std::make_unique<Built<U>>(std::forward<Args>(args)...);
    U& unit = built->unit;
    const Declaration& declared = declared_[id.index];
    built->tick = {&unit, [](void* of, Time now) { return static_cast<U*>(of)->tick(now); }};
    built->declared = id.index;
    if constexpr (requires { U::kReasons; }) {
      reports_.push_back([&unit, declared] {
        UnitReport report = report_of(unit, declared.name, declared.sram_bytes, declared.cache_bytes);
        report.parts = declared.parts;
        report.data_lines = declared.data_lines;
        return report;
      });
      values_.push_back(unit_values_of<U>(unit));
    }
    units_.push_back(std::move(built));
    return unit;
  }
  /// Makes these units a cluster: owner.run(turn, now), instead of the engine, ticks them from their first wake-up time
  /// `now` until the end of the turn. owner.run() must update the wake-up times and group minima in `turn`. The units
  /// must share an outer partition and a clock. A partition has at most one cluster.
  template <class Owner>
  void set_cluster(std::vector<UnitId> units, Owner& owner) {
    require_cluster_rules(units);
    clusters_.push_back({std::move(units), &owner,
                         [](void* of, const ClusterTurn& turn, Time now) { static_cast<Owner*>(of)->run(turn, now); }});
  }
  /// Adds a separate report for `part`, a part of the unit that was built last.
  template <class Part>
  void report_subunit(std::string name, const Part& part, std::uint64_t sram_bytes) {
    reports_.push_back([&part, name = std::move(name), sram_bytes] { return report_of(part, name, sram_bytes); });
    values_.push_back(unit_values_of(part));
  }
  /// Makes the machine sample the values of all reports into `intervals`, at every interval boundary and at the end.
  /// Call before the start. `intervals` must outlive the machine.
  void record_intervals(Intervals& intervals);

  /// True if all links of the machine are empty and all units that have idle() are idle.
  bool is_drained() const;
  /// Updates cycles and counters of every unit to the end of the run, rounded up to its clock. Call once, at the end.
  void finish(Time end);
  /// Updates cycles and counters of every unit to time `end`, rounded up to the unit's clock, during a run.
  void account_until(Time end);
  /// Returns the state of the units as text, one line for each unit that reports a state.
  std::string state() const;
  std::vector<UnitReport> report() const;
  /// Returns the number of retired items, summed over all units. The number grows as long as the machine makes
  /// progress.
  std::uint64_t retired_items() const;

  // The functions below are for the engine (sim/engine.h).
  /// Prepares the machine for a run: builds the wake-up table and wakes all units at time 0. Later calls have no
  /// effect.
  void start();
  WakeupTable& wakeup_table() { return wakeups_; }
  Partitions& partitions() { return partitions_; }
  /// Returns the shortest latency of any link between partitions, except links with Lookahead::kByOwner.
  Time min_lookahead() const { return lookahead_; }
  Time wake_time(UnitId unit) const { return wakeups_[slots_[unit.index]]; }
  /// Returns the next interval boundary, where all units must be sampled; kNever if no intervals are recorded.
  Time next_interval_boundary() const { return next_boundary_; }
  /// Samples the counters at all interval boundaries up to `now`. All units must have finished the work before `now`
  /// and none after it.
  void sample_intervals_until(Time now);
  /// A unit and a pointer to its tick function, which avoids virtual calls.
  struct TickFunction {
    void* unit = nullptr;
    Time (*tick)(void*, Time) = nullptr;
    Time operator()(Time now) const { return tick(unit, now); }
  };
  const std::vector<TickFunction>& tick_functions() const { return tick_functions_; }
  /// Calls f(i, clock) for every unit; i is its index in the wake-up table.
  void for_each_clock(auto&& f) const {
    for (const auto& unit : units_) f(slots_[unit->declared], declared_[unit->declared].clock);
  }

 private:
  /// A reported unit and a pointer to the function that writes its values, which avoids virtual calls.
  struct Values {
    const void* unit;
    std::uint64_t* (*write)(const void*, std::uint64_t*);
  };
  template <class U>
  static Values unit_values_of(const U& unit) {
    return {&unit, [](const void* of, std::uint64_t* out) { return write_values(*static_cast<const U*>(of), out); }};
  }

  struct ClusteredUnits {
    std::vector<UnitId> units;
    void* owner;
    void (*run)(void*, const ClusterTurn&, Time);
  };
  struct AnyUnit {
    virtual ~AnyUnit() = default;
    virtual bool idle() const = 0;
    virtual void finish(Time end) = 0;
    virtual std::string state() const = 0;  ///< state of the unit as text; empty if the unit reports none
    virtual std::uint64_t retired_items() const = 0;
    TickFunction tick;
    std::size_t declared = 0;
  };
  template <class U>
  struct Built final : AnyUnit {
    template <class... Args>
    explicit Built(Args&&... args) : unit(std::forward<Args>(args)...) {}
    bool idle() const override {
      if constexpr (requires { unit.idle(); }) return unit.idle();
      return true;
    }
    void finish(Time end) override {
      if constexpr (requires { unit.finish(end); }) unit.finish(end);
    }
    std::string state() const override {
      if constexpr (requires { unit.state(); }) return unit.state();
      return {};
    }
    std::uint64_t retired_items() const override {
      if constexpr (requires { unit.retired_items(); }) return unit.retired_items();
      return 0;
    }
    U unit;
  };
  struct AnyWire {
    virtual ~AnyWire() = default;
    virtual bool empty() const = 0;
    virtual Time latency() const = 0;
    virtual void attach_ends(WakeupHandle producer, WakeupHandle consumer, std::uint32_t* nearly_full) = 0;
    std::size_t from = 0, to = 0, at_once = 1;
    Lookahead lookahead = Lookahead::kByLatency;
  };
  template <class T>
  struct Wire final : AnyWire {
    Wire(std::size_t capacity, std::uint64_t latency, Clock producer, Clock consumer, std::uint64_t synchroniser)
        : link(capacity, latency, producer, consumer, synchroniser) {}
    bool empty() const override { return link.empty(); }
    Time latency() const override { return link.latency(); }
    void attach_ends(WakeupHandle producer, WakeupHandle consumer, std::uint32_t* nearly_full) override {
      link.set_wakeup_handles(producer, consumer);
      if (nearly_full != nullptr) link.count_if_nearly_full(nearly_full, at_once);
    }
    Link<T> link;
  };

  /// Throws std::logic_error with the text `rule` if the rule is broken (`is_kept` is false).
  static void require_rule(bool is_kept, std::string_view rule);
  void require_unbuilt(UnitId id) const;
  void require_cluster_rules(const std::vector<UnitId>& units) const;
  bool is_started() const { return wakeups_.size() != 0; }
  void assign_wakeup_slots();
  WakeupTable::Groups assign_group_slots(std::span<const std::size_t> units, std::size_t& slot);
  void connect_links();
  /// Writes the values of all reports to `row`, a row of the recorded intervals.
  void write_counter_values(std::uint64_t* row) const;

  const std::uint64_t synchroniser_cycles_;
  std::vector<Declaration> declared_;
  std::vector<std::unique_ptr<AnyWire>> wires_;
  std::vector<std::unique_ptr<AnyUnit>> units_;
  std::vector<ClusteredUnits> clusters_;
  std::vector<std::function<UnitReport()>> reports_;
  std::vector<Values> values_;  ///< functions that write values, one per report
  Intervals* intervals_ = nullptr;
  Time next_boundary_ = kNever;
  std::vector<std::size_t> slots_;            ///< index of each declared unit in the wake-up table
  std::vector<TickFunction> tick_functions_;  ///< tick functions of the units, by index in the wake-up table
  WakeupTable wakeups_;
  Partitions partitions_;
  Time lookahead_ = kNever;
};

}  // namespace sim
