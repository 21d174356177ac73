#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/report/energy.h"
#include "sim/report/thermal.h"
#include "sim/time.h"
#include "sim/unit_report.h"
#include "tools/run/frame/load_config.h"

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

/// Time and energy of a frame at one of the governor's clocks.
struct SustainFrame {
  double seconds = 0;
  double dynamic_j = 0;  ///< dynamic energy of the chip in J, without leakage
  double leakage_w = 0;  ///< leakage power of the chip in W at the configured temperature
  double memory_j = 0;
  double idle_clock_w = 0;  ///< power of the clock of the idle chip between frames in W
};

/// Returns the time and energies of a simulated frame, in the form that sustain() needs. `config`, `units`:
/// configuration and units of the machine that simulated the frame.
SustainFrame sustain_frame(const RunConfig& config, const sim::EnergyReport& energy,
                           std::span<const sim::UnitReport> units, sim::Time elapsed);

/// A clock that the governor may choose, and the results of the frames at this clock.
struct SustainStep {
  double factor = 1;                 ///< clock divided by the configured clock
  std::vector<SustainFrame> frames;  ///< the frames of the sequence, which repeats, at this clock
};

/// Device, governor and duration of a sustained run.
struct SustainSetup {
  sim::ThermalConfig thermal;
  /// Temperature in C at which SustainFrame::leakage_w holds, and rise in K that doubles leakage.
  double leakage_temperature = 75, leakage_doubling = 25;
  /// Between frames: share of the leakage power that remains, and power of the memory in W.
  double idle_leakage = 0, idle_memory_w = 0;
  double seconds = 600, loop = 60, fps = 0;
};

/// Returns the setup that a configuration describes: for thermal.minutes, in loops of at most one minute, with frames
/// that begin at the rate frame.fps.
SustainSetup sustain_setup(const RunConfig& config);

/// Results of one loop of a sustained run: means over the loop, and temperatures at its end.
struct SustainLoop {
  double fps = 0, watt = 0, factor = 0;
  double least_factor = 0;
  sim::Temperatures temperatures{};
};

/// Result of a repeated frame or sequence in a device with a governor.
struct Sustained {
  std::vector<SustainLoop> loops;
  std::uint64_t frames = 0;
  double seconds = 0;
  double energy_j = 0;        ///< energy of the GPU and its memory
  sim::Temperatures hottest;  ///< highest temperature of each thermal node, at different times
  std::size_t changes = 0;    ///< number of clock changes
  double first_fps = 0;       ///< mean frame rate of the first loop
  double sustained_fps = 0;   ///< mean frame rate of the last loop
  double stability() const;   ///< frame rate of the slowest loop divided by that of the fastest
};

/// Returns the governor's clocks as factors of the configured clock, the fastest first.
std::vector<double> governor_factors(const sim::ThermalConfig& config);
/// Returns a configuration for each of the governor's clocks, with the voltage that the clock needs.
std::vector<RunConfig> governor_configs(const RunConfig& config);

/// Repeats the sequence of frames for `setup.seconds`, starting with a device at ambient temperature. `steps`: governor
/// clocks, the fastest first. Throws InputError for more than 1e9 frames.
Sustained sustain(const std::vector<SustainStep>& steps, const SustainSetup& setup);

/// Returns the steady temperatures at a fixed clock without the governor; none if leakage causes thermal runaway.
std::optional<sim::Temperatures> steady_temperatures(const SustainStep& step, const SustainSetup& setup);

/// Returns a warning if even the slowest clocks exceed a temperature limit, so that the governor cannot hold the limit.
std::vector<std::string> limit_warnings(const std::vector<SustainStep>& steps, const SustainSetup& setup);

}  // namespace tools
