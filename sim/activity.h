#pragma once
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "sim/time.h"

namespace sim {

/// What a unit's time goes to. Every cycle is charged to exactly one reason of `CycleReason`, whose last value is
/// kCount.
template <class CycleReason>
class Activity {
 public:
  static constexpr std::size_t kReasons = static_cast<std::size_t>(CycleReason::kCount);

  /// The cycle at `now` went to `now_why`; every cycle until the next call goes to `then_why`.
  void spend(Time now, Time period, CycleReason now_why, CycleReason then_why) {
    assert(now >= accounted_);
    if (now != accounted_) spent_[index(then_)] += now - accounted_;
    spent_[index(now_why)] += period;
    accounted_ = now + period;
    then_ = then_why;
  }

  /// Charges the rest up to `end`, an edge of the unit's clock. Call once, when the run is over.
  void finish(Time end) {
    if (end <= accounted_) return;
    spent_[index(then_)] += end - accounted_;
    accounted_ = end;
  }

  Time spent(CycleReason why) const { return spent_[index(why)]; }
  Time accounted() const { return accounted_; }

 private:
  static constexpr std::size_t index(CycleReason why) { return static_cast<std::size_t>(why); }

  std::array<Time, kReasons> spent_{};
  Time accounted_ = 0;
  CycleReason then_{};
};

}  // namespace sim
