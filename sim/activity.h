#pragma once
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "sim/time.h"

namespace sim {

/// How a cycle is to be read that went to a reason.
enum class ReasonKind : std::uint8_t {
  kWorking,     ///< own doing: work, or the time that own pipelines take
  kWaiting,     ///< for another unit
  kIdle,        ///< nothing to do: the clock is gated
  kBackground,  ///< time alone brings it
};

/// Declaration of a reason by a unit.
struct Reason {
  const char* name;
  ReasonKind kind;
  const char* meaning;
};
constexpr Reason working(const char* name, const char* meaning) { return {name, ReasonKind::kWorking, meaning}; }
constexpr Reason waiting(const char* name, const char* meaning) { return {name, ReasonKind::kWaiting, meaning}; }
constexpr Reason idle(const char* name, const char* meaning) { return {name, ReasonKind::kIdle, meaning}; }
constexpr Reason background(const char* name, const char* meaning) { return {name, ReasonKind::kBackground, meaning}; }

/// A reason with its value, as sim::reasons() takes it.
template <class CycleReason>
struct ReasonLine {
  CycleReason reason;
  Reason declared;
};

/// A unit's reasons by their values, all of them in the order of the enumeration, or it does not compile:
///   static constexpr auto kReasons = sim::reasons<CycleReason>({{kIdle, sim::idle("idle", "nothing inside")}, ...});
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

/// Account of a unit's time. Every cycle is charged to exactly one reason of `CycleReason`, whose last value is
/// kCount.
template <class CycleReason>
class Activity {
 public:
  static constexpr std::size_t kReasons = static_cast<std::size_t>(CycleReason::kCount);

  /// The cycle at `now` went to `now_why`; every cycle until the next call goes to `then_why`.
  void spend(Time now, Time period, CycleReason now_why, CycleReason then_why) {
    assert(now >= accounted_);
    // Charges even what does not change: whether it does no host foresees.
    spent_[index(then_)] += now - accounted_;
    spent_[index(now_why)] += period;
    accounted_ = now + period;
    then_ = then_why;
  }

  /// Charges all up to `end`, an edge of the unit's clock, unless it has come further.
  void finish(Time end) {
    if (end <= accounted_) return;
    spent_[index(then_)] += end - accounted_;
    accounted_ = end;
  }

  /// As of the last finish().
  Time spent(CycleReason why) const { return spent_[index(why)]; }
  Time accounted() const { return accounted_; }

 private:
  static constexpr std::size_t index(CycleReason why) { return static_cast<std::size_t>(why); }

  std::array<Time, kReasons> spent_{};
  Time accounted_ = 0;  ///< all up to it is in `spent_`; from it on all is `then_`
  CycleReason then_{};
};

}  // namespace sim
