#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/intervals.h"
#include "sim/link.h"
#include "sim/partitions.h"
#include "sim/time.h"
#include "sim/unit_report.h"
#include "sim/wakeups.h"

namespace sim {

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
    std::size_t partition = 0;      ///< 0: the inner partition; others: outer (sim/partitions.h)
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
  Time next_boundary() const { return next_boundary_; }
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
