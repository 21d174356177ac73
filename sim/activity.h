#pragma once
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

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

}  // namespace sim
