#pragma once
#include <optional>
#include <span>
#include <vector>

#include "sim/report/energy.h"
#include "sim/unit_report.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// Returns the units of the chip, without the memory's, with the counts of a millisecond in which all are idle.
std::vector<sim::UnitReport> idle_for_a_millisecond(std::span<const sim::UnitReport> units);

/// Returns what remains between frames of the chip's leakage and of the clock of its idle units, by power.idle.
template <class Energy>
Energy between_frames(const sim::PowerConfig& power, const Energy& leakage, const Energy& idle_clock) {
  switch (power.idle) {
    case sim::ChipIdle::kPowerGated:
      return leakage * power.idle_leakage;
    case sim::ChipIdle::kClockGated:
      return leakage;
    case sim::ChipIdle::kClocked:
      break;
  }
  return leakage + idle_clock;
}

/// Returns the power between frames, in mW: the chip in the state of power.idle, and the memory. `units`: all units of
/// the machine; their counts do not matter.
sim::Band idle_power_mw(const RunConfig& config, std::span<const sim::UnitReport> units);

/// Finished frames.
struct FinishedFrames {
  const sim::EnergyReport& energy;         ///< of all frames
  std::span<const sim::UnitReport> units;  ///< of the machine
  double count = 1;
  double time_ms = 0;     ///< of all frames
  double slowest_ms = 0;  ///< of the slowest frame
};

/// An operating point of the chip: all its clocks times a factor, each at the voltage that it needs.
struct RatedClocks {
  double factor = 1;
  std::vector<double> mhz, volt;  ///< of each clock domain
  sim::Band power_w;              ///< mean over a period, at the target rate
};

/// Frames at the target rate frame.fps: each begins a period after the one before, and the machine idles in between.
struct FrameRate {
  double fps = 0, period_ms = 0, slowest_ms = 0;
  double busy = 0;                     ///< mean share of a period in which the machine works
  sim::Band idle_mw;                   ///< power between frames
  sim::Band power_w;                   ///< mean power; if the rate is not met, energy per frame times rate
  double clock_factor = 0;             ///< of the slowest clocks that meet the rate if cycles stay the same
  std::optional<RatedClocks> slowest;  ///< these clocks, if the rate is met
  std::optional<RatedClocks> best;     ///< the clocks between these and the configured ones with the least power

  /// Rate of the slowest frame over the target.
  double margin() const { return period_ms / slowest_ms; }
  double slack_ms() const { return period_ms - slowest_ms; }
  bool is_met() const;
};

/// Returns the frames at the rate frame.fps, which is above 0. Operating points assume that a frame takes equally many
/// cycles at lower clocks: the memory keeps its clock, so it takes fewer.
FrameRate at_frame_rate(const RunConfig& config, const FinishedFrames& frames);

}  // namespace tools
