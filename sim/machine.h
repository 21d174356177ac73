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
#include "sim/wakes.h"

namespace sim {

/// A declared unit: what links are made between.
struct UnitId {
  std::size_t index;
  Clock clock;
};

/// Lookahead that a link between two partitions gives: how far each may be run by itself.
enum class Lookahead : std::uint8_t {
  kByLatency,  ///< items that come over it matter at any time
  kByOwner,    ///< the machine's owner knows when something comes over it, and has it in its reach()
};

/// Units and the links between them, each declared once. All else follows from that: the units' wake-up times and who
/// lowers them, the order of visits, partitions, synchronisers between clock domains, state, reports and the end of a
/// run.
///
///   unit(), unit(), ... --> link<T>(), ... --> build<U>(), ... --> sim::run
///
/// First units are declared, then the links between them, then units are built with their links. The order of building
/// is that of reports and states. Units of a partition that are declared one after the other have their wake-up times
/// side by side, which costs least if those that are seldom awake come last. A machine declared otherwise (a unit built
/// twice or not at all, a link of a unit that it has not, anything after the start) throws std::logic_error.
class Machine {
 public:
  struct Declaration {
    std::string name;  ///< "core0.tni.trv2"
    Clock clock;
    std::size_t partition = 0;      ///< 0: the inner one; from 1 on the outer ones (sim/partitions.h)
    std::uint64_t sram_bytes = 0;   ///< storage that leaks
    std::uint64_t cache_bytes = 0;  ///< the array of it whose accesses are counted; 0: all
    std::vector<UnitPart> parts{};  ///< that its area depends on
    std::uint32_t data_lines = 0;   ///< at the die's edge
  };

  /// Items that cross from one clock to another wait that many cycles of the latter (Link).
  explicit Machine(std::uint64_t synchroniser_cycles = 0) : synchroniser_cycles_(synchroniser_cycles) {}
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  UnitId unit(Declaration declared);

  /// A link of `capacity` items, each of which takes `latency_cycles` of the clock of `from`. Where it leads to another
  /// partition, `from` pushes `at_once` items in a tick at most, or its owner knows when it pushes.
  template <class T>
  Link<T>& link(std::size_t capacity, std::uint64_t latency_cycles, UnitId from, UnitId to,
                Lookahead lookahead = Lookahead::kByLatency, std::size_t at_once = 1) {
    auto wire = std::make_unique<Wire<T>>(capacity, latency_cycles, from.clock, to.clock, synchroniser_cycles_);
    expect(from.index < declared_.size() && to.index < declared_.size(), "a link is between declared units");
    expect(!started(), "a link is declared before the start");
    wire->from = from.index;
    wire->to = to.index;
    wire->lookahead = lookahead;
    wire->at_once = at_once;
    Link<T>& link = wire->link;
    wires_.push_back(std::move(wire));
    return link;
  }

  /// Builds a declared unit. It has tick(now) and clock(); if it has them, finish(end), state(), idle(), retired()
  /// and what a report needs (sim::report_of) are used, too. finish(end) brings its time and counters up to an edge of
  /// its clock, and the unit may go on from there.
  template <class U, class... Args>
  U& build(UnitId id, Args&&... args) {
    expect_to_be_built(id);
    auto built = std::make_unique<Built<U>>(std::forward<Args>(args)...);
    U& unit = built->unit;
    const Declaration& declared = declared_[id.index];
    built->ticked = {&unit, [](void* of, Time now) { return static_cast<U*>(of)->tick(now); }};
    built->declared = id.index;
    if constexpr (requires { U::kReasons; }) {
      reports_.push_back([&unit, declared] {
        UnitReport report = report_of(unit, declared.name, declared.sram_bytes, declared.cache_bytes);
        report.parts = declared.parts;
        report.data_lines = declared.data_lines;
        return report;
      });
      values_.push_back(values_by<U>(unit));
    }
    units_.push_back(std::move(built));
    return unit;
  }
  /// Has these units, of one outer partition and one clock, run by their owner where partitions run by themselves, by
  /// owner.run(turn, now): from `now`, when the first of them wakes, as far as the turn reaches. It leaves in the
  /// turn when each of them wakes next, and the earliest of each eight. A partition has one cluster at most.
  template <class Owner>
  void cluster(std::vector<UnitId> units, Owner& owner) {
    expect_to_be_a_cluster(units);
    clusters_.push_back({std::move(units), &owner,
                         [](void* of, const ClusterTurn& turn, Time now) { static_cast<Owner*>(of)->run(turn, now); }});
  }
  /// Has a part of the unit built last reported as if it were one itself.
  template <class Part>
  void report_part(std::string name, const Part& part, std::uint64_t sram_bytes) {
    reports_.push_back([&part, name = std::move(name), sram_bytes] { return report_of(part, name, sram_bytes); });
    values_.push_back(values_by(part));
  }
  /// Has the values of all reports taken down at every edge of an interval, and at the end. Before the start;
  /// `intervals` are there as long as the machine.
  void record(Intervals& intervals);

  /// Nothing is under way: all links are empty, and units that can be idle are.
  bool quiet() const;
  /// Charges every unit's time up to the end, rounded up to its clock. Call once, when the run is over.
  void finish(Time end);
  /// Charges time and counters of every unit up to `end`, rounded up to its clock, unless it has come further by
  /// itself. It may go on from there.
  void bring_up_to(Time end);
  /// A line for each unit that has a state.
  std::string state() const;
  std::vector<UnitReport> report() const;
  /// Sum of what units have retired, each in items of its own kind: grows as long as the machine gets anywhere.
  std::uint64_t retired() const;

  // The engine works on these.
  /// Gives the units their wake-up times, unless they have them, and wakes them all at time 0.
  void start();
  Wakes& wakes() { return wakes_; }
  Partitions& partitions() { return partitions_; }
  /// Time before which nothing that a partition does at 0 can matter to another, but for links kByOwner.
  Time lookahead() const { return lookahead_; }
  Time wake_time(UnitId unit) const { return wakes_[slots_[unit.index]]; }
  /// The edge at which all units are to stand together; kNever if nothing is recorded.
  Time next_edge() const { return next_edge_; }
  /// Takes down all edges up to `now`. All units have done what comes before the next edge, and nothing else.
  void pass_edges(Time now);
  /// A unit by its wake-up time, to be ticked through a plain function of its own kind.
  struct Ticked {
    void* unit = nullptr;
    Time (*tick)(void*, Time) = nullptr;
    Time operator()(Time now) const { return tick(unit, now); }
  };
  const std::vector<Ticked>& ticked() const { return ticked_; }
  /// Calls f(wake-up time's index, clock) for every unit.
  void each_clock(auto&& f) const {
    for (const auto& unit : units_) f(slots_[unit->declared], declared_[unit->declared].clock);
  }

 private:
  /// A reported unit, to have its values written through a plain function of its own kind.
  struct Values {
    const void* unit;
    std::uint64_t* (*write)(const void*, std::uint64_t*);
  };
  template <class U>
  static Values values_by(const U& unit) {
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
    virtual std::string state() const = 0;  ///< empty: none
    virtual std::uint64_t retired() const = 0;
    Ticked ticked;
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
    std::uint64_t retired() const override {
      if constexpr (requires { unit.retired(); }) return unit.retired();
      return 0;
    }
    U unit;
  };
  struct AnyWire {
    virtual ~AnyWire() = default;
    virtual bool empty() const = 0;
    virtual Time latency() const = 0;
    virtual void connect(Waker producer, Waker consumer, std::uint32_t* nearly_full) = 0;
    std::size_t from = 0, to = 0, at_once = 1;
    Lookahead lookahead = Lookahead::kByLatency;
  };
  template <class T>
  struct Wire final : AnyWire {
    Wire(std::size_t capacity, std::uint64_t latency, Clock producer, Clock consumer, std::uint64_t synchroniser)
        : link(capacity, latency, producer, consumer, synchroniser) {}
    bool empty() const override { return link.empty(); }
    Time latency() const override { return link.latency(); }
    void connect(Waker producer, Waker consumer, std::uint32_t* nearly_full) override {
      link.wakes(producer, consumer);
      if (nearly_full != nullptr) link.count_if_nearly_full(nearly_full, at_once);
    }
    Link<T> link;
  };

  /// Throws std::logic_error unless the rule is kept.
  static void expect(bool kept, std::string_view rule);
  void expect_to_be_built(UnitId id) const;
  void expect_to_be_a_cluster(const std::vector<UnitId>& units) const;
  bool started() const { return wakes_.size() != 0; }
  void place_units();
  Wakes::Groups place(std::span<const std::size_t> units, std::size_t& slot);
  void connect_links();
  void write_row(std::uint64_t* row) const;

  const std::uint64_t synchroniser_cycles_;
  std::vector<Declaration> declared_;
  std::vector<std::unique_ptr<AnyWire>> wires_;
  std::vector<std::unique_ptr<AnyUnit>> units_;
  std::vector<ClusteredUnits> clusters_;
  std::vector<std::function<UnitReport()>> reports_;
  std::vector<Values> values_;  ///< likewise
  Intervals* intervals_ = nullptr;
  Time next_edge_ = kNever;
  std::vector<std::size_t> slots_;  ///< index of each declared unit among the wake-up times
  std::vector<Ticked> ticked_;      ///< by slot
  Wakes wakes_;
  Partitions partitions_;
  Time lookahead_ = kNever;
};

}  // namespace sim
