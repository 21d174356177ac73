#pragma once
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "sim/time.h"

namespace sim {

/// What a unit's time goes to. Every cycle is charged to exactly one reason of `Why`, whose last value is kCount.
template <class Why>
class Activity {
 public:
  static constexpr std::size_t kReasons = static_cast<std::size_t>(Why::kCount);

  /// The cycle at `now` went to `now_why`; every cycle until the next call goes to `then_why`.
  void spend(Time now, Time period, Why now_why, Why then_why) {
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

  Time spent(Why why) const { return spent_[index(why)]; }
  Time accounted() const { return accounted_; }

 private:
  static constexpr std::size_t index(Why why) { return static_cast<std::size_t>(why); }

  std::array<Time, kReasons> spent_{};
  Time accounted_ = 0;
  Why then_{};
};

}  // namespace sim
