#pragma once
#include <cstddef>

#include "sim/report/thermal.h"

namespace tools {

/// Thermal governor of a device: lowers the clock of the chip in steps when die or body become too hot, and raises it
/// again when both have cooled.
///
/// A decision extrapolates the body's temperature over the time `lookahead`, at its rate of change since the last
/// decision:
/// 1. The die is above its limit and has not cooled since that decision, or the body would pass its limit: one step
/// slower.
/// 2. Else, both would stay at least `hysteresis` below their limits: one step faster.
/// 3. Else: the same clock.
class ThermalGovernor {
 public:
  /// `steps`: number of the governor's clocks. Step 0 is the fastest clock.
  ThermalGovernor(const sim::ThermalConfig& config, std::size_t steps)
      : config_(config), steps_(steps), before_{config.ambient, config.ambient} {}

  std::size_t clock_step() const { return step_; }

  /// Chooses the next clock from the temperatures `seconds` after the last decision. Returns true if the clock changes.
  bool choose_next_clock(const sim::Temperatures& now, double seconds) {
    const double body = now.body + (now.body - before_.body) * config_.lookahead / seconds;
    const bool slower = (now.die > config_.die_limit && now.die >= before_.die) || body > config_.body_limit;
    const double margin = config_.hysteresis;
    const bool cool = now.die <= config_.die_limit - margin && body <= config_.body_limit - margin;
    before_ = now;
    if (slower && step_ + 1 < steps_) return step_ += 1, true;
    if (!slower && cool && step_ > 0) return step_ -= 1, true;
    return false;
  }

 private:
  const sim::ThermalConfig config_;
  const std::size_t steps_;
  sim::Temperatures before_;
  std::size_t step_ = 0;
};

}  // namespace tools
