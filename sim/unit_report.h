#pragma once
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>
#include <vector>

#include "sim/named.h"
#include "sim/time.h"

namespace sim {

/// Category of a cycle reason, to which a unit charges its cycles.
enum class ReasonKind : std::uint8_t {
  kWorking,     ///< the unit works, including latency of its pipeline
  kWaiting,     ///< the unit waits for another unit
  kIdle,        ///< the unit has nothing to do and its clock is gated
  kBackground,  ///< activity caused only by the passing of time, such as refresh
};

/// Declaration of a cycle reason, to which a unit charges its cycles.
struct Reason {
  const char* name;
  ReasonKind kind;
  const char* meaning;
};
/// Functions that each declare a cycle reason of one kind (working, waiting, idle, background), for the table kReasons
/// of a unit.
constexpr Reason working_reason(const char* name, const char* meaning) { return {name, ReasonKind::kWorking, meaning}; }
constexpr Reason waiting_reason(const char* name, const char* meaning) { return {name, ReasonKind::kWaiting, meaning}; }
constexpr Reason idle_reason(const char* name, const char* meaning) { return {name, ReasonKind::kIdle, meaning}; }
constexpr Reason background_reason(const char* name, const char* meaning) {
  return {name, ReasonKind::kBackground, meaning};
}

/// An entry of a unit's table of cycle reasons: the CycleReason and its declaration.
template <class CycleReason>
struct ReasonLine {
  CycleReason reason;
  Reason declared;
};

/// Builds a unit's table of cycle reasons. Compiles only if the table lists every value of the enumeration, in order:
///
///   static constexpr auto kReasons = sim::reasons<CycleReason>({{kIdle, sim::idle_reason("idle", "nothing inside")},
///   ...});
template <class CycleReason, std::size_t kLines>
consteval std::array<Reason, kLines> reasons(const ReasonLine<CycleReason> (&lines)[kLines]) {
  static_assert(kLines == static_cast<std::size_t>(CycleReason::kCount));
  std::array<Reason, kLines> all{};
  for (std::size_t i = 0; i < kLines; ++i) {
    if (static_cast<std::size_t>(lines[i].reason) != i) throw "not in the order of the values";
    all[i] = lines[i].declared;
  }
  return all;
}

/// Accounting of a unit's time: every cycle is charged to exactly one CycleReason. The last value of that enumeration
/// must be kCount.
template <class CycleReason>
class Activity {
 public:
  static constexpr std::size_t kReasons = static_cast<std::size_t>(CycleReason::kCount);

  /// Charges the cycle at time `now` to `reason_now`. Later cycles, until the next call of spend(), are charged to
  /// `reason_after`.
  void spend(Time now, Time period, CycleReason reason_now, CycleReason reason_after) {
    assert(now >= accounted_);
    // Unconditional, because a test for equal times would be an unpredictable branch.
    spent_[index_of(then_)] += now - accounted_;
    spent_[index_of(reason_now)] += period;
    accounted_ = now + period;
    then_ = reason_after;
  }

  /// Charges the unit's time up to `end`, an edge of its clock. Has no effect on time that is already charged.
  void finish(Time end) {
    if (end <= accounted_) return;
    spent_[index_of(then_)] += end - accounted_;
    accounted_ = end;
  }

  /// Returns the time charged to a cycle reason up to the last finish().
  Time spent(CycleReason reason) const { return spent_[index_of(reason)]; }
  Time accounted_until() const { return accounted_; }

 private:
  static constexpr std::size_t index_of(CycleReason reason) { return static_cast<std::size_t>(reason); }

  std::array<Time, kReasons> spent_{};
  Time accounted_ = 0;  ///< end of the unit's charged time; later cycles are charged to `then_`
  CycleReason then_{};
};

/// How a counter is combined when the results of two time spans are added.
enum class CounterKind : std::uint8_t {
  kSum,    ///< the counter's values are added
  kPeak,   ///< the counter is a maximum: the larger value is used
  kAtEnd,  ///< like kSum, but the counter is computed only at the end of a run
};

/// One counter of a unit, declared in its Stats::describe: counter(NAMED(s.hits), "line found", "cache.l1_read").
/// `event`: name of the energy event that each count represents; empty: none.
struct CounterReport {
  std::string name;
  std::string meaning;
  std::uint64_t value = 0;
  std::string event;
  CounterKind kind = CounterKind::kSum;
};

/// Name of the block for units that are not on the chip. They have counters, but neither energy nor area.
inline constexpr std::string_view kOutsideBlock = "outside";

/// A part that a unit's logic contains several times, such as a box tester. A configuration key sets the number.
struct UnitPart {
  std::string name;  ///< name of the part: "box_tester"
  std::uint32_t count = 0;
};

/// Results of one unit as plain data, so that reports, energy and comparisons do not depend on classes of units.
struct UnitReport {
  std::string path;                                                     ///< path of the unit: "core0.tni.trv2"
  std::string block;                                                    ///< block of the GPU for which energy and area
                                                                        ///< are summed
  std::uint64_t elapsed = 0;                                            ///< run time in cycles of the unit's clock
  std::vector<std::pair<std::string, std::uint64_t>> cycles_by_reason;  ///< cycles charged to each reason; the sum is
                                                                        ///< `elapsed`
  std::span<const Reason> reasons;  ///< declarations of the reasons in `cycles_by_reason`
  std::vector<CounterReport> counters;
  std::uint64_t sram_bytes = 0;   ///< size of the unit's memory, for leakage
  std::uint64_t cache_bytes = 0;  ///< size of the memory array whose accesses are counted, for size-dependent energies
  std::uint32_t clock_mhz = 0;
  std::type_index type = typeid(void);  ///< C++ class of the simulated unit
  std::vector<UnitPart> parts;          ///< parts whose number determines the unit's area
  std::uint32_t data_lines = 0;         ///< number of data pins of the unit at the die's edge
};

/// Adds the results `more` of another time span to the results `sum` of the same units.
void add_reports(std::vector<UnitReport>& sum, const std::vector<UnitReport>& more);

/// Subtracts from `later` the results of the same units at an earlier time, so that `later` covers the time between.
/// Maxima (CounterKind::kPeak) stay those of the whole time.
void subtract_reports(std::vector<UnitReport>& later, const std::vector<UnitReport>& earlier);

/// Builds the report of a unit from its declarations kBlock, kReasons and Stats::describe. `cache_bytes` 0 means equal
/// to `sram_bytes`.
template <class Unit>
UnitReport report_of(const Unit& unit, std::string path, std::uint64_t sram_bytes = 0, std::uint64_t cache_bytes = 0) {
  UnitReport r;
  r.type = typeid(Unit);
  r.path = std::move(path);
  r.block = names_of(Unit::kBlock)[static_cast<std::size_t>(Unit::kBlock)];
  r.reasons = Unit::kReasons;
  r.sram_bytes = sram_bytes;
  r.cache_bytes = cache_bytes != 0 ? cache_bytes : sram_bytes;
  const Clock clock = unit.clock();
  r.clock_mhz = static_cast<std::uint32_t>(kFemtosecondsPerSecond / clock.period() / 1'000'000);
  for (std::size_t i = 0; i < r.reasons.size(); ++i) {
    const std::uint64_t cycles = clock.cycles(unit.activity().spent(static_cast<typename Unit::CycleReason>(i)));
    r.cycles_by_reason.emplace_back(r.reasons[i].name, cycles);
    r.elapsed += cycles;
  }
  using Stats = typename Unit::Stats;
  const Stats& stats = unit.stats();
  Stats::describe(stats, [&](const std::uint64_t& value, const char* name, const char* meaning, const char* event = "",
                             CounterKind kind = CounterKind::kSum) {
    r.counters.push_back({name, meaning, value, event, kind});
  });
  return r;
}

/// Writes the values of a unit's report to `out`: cycles by reason, then counters. Allocates no memory. Returns the end
/// of the values.
template <class Unit>
std::uint64_t* write_values(const Unit& unit, std::uint64_t* out) {
  const Clock clock = unit.clock();
  for (std::size_t i = 0; i < Unit::kReasons.size(); ++i) {
    *out++ = clock.cycles(unit.activity().spent(static_cast<typename Unit::CycleReason>(i)));
  }
  const typename Unit::Stats& stats = unit.stats();
  Unit::Stats::describe(stats, [&](const std::uint64_t& value, auto&&...) { *out++ = value; });
  return out;
}

/// Calls set(value, i, kind) for the ith value of the units' reports, in the order of write_values(). set() may replace
/// the value. Then sets `elapsed` of each unit to the sum of its cycles by reason.
void set_each_value(std::span<UnitReport> units, auto&& set) {
  std::size_t number = 0;
  for (UnitReport& unit : units) {
    unit.elapsed = 0;
    for (auto& [reason, cycles] : unit.cycles_by_reason) {
      set(cycles, number++, CounterKind::kSum);
      unit.elapsed += cycles;
    }
    for (CounterReport& counter : unit.counters) set(counter.value, number++, counter.kind);
  }
}

}  // namespace sim
