#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/run_job.h"

namespace tools {

inline constexpr double kMilliwattsPerWatt = 1000;

/// Returns reports of the chip's units, without the memory's, for a millisecond in which all of them are idle.
std::vector<sim::UnitReport> idle_millisecond_reports(std::span<const sim::UnitReport> units);

/// Returns the energy or power of the chip between frames: the part of leakage and idle clocks that power.idle keeps.
template <class Energy>
Energy remaining_between_frames(const sim::PowerConfig& power, const Energy& leakage, const Energy& idle_clock) {
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

/// Returns the power between frames in mW: of the chip in the state power.idle, and of the memory. `units`: all units
/// of the machine; their counts are not used.
sim::Band idle_power_mw(const RunConfig& config, std::span<const sim::UnitReport> units);

/// Returns the nominal power of the chip's clock between frames, in mW: 0 unless power.idle is clocked.
double idle_clock_mw(const RunConfig& config, std::span<const sim::UnitReport> units);

/// Energy, units and times of the finished frames of a run.
struct FinishedFrames {
  const sim::EnergyReport& energy;         ///< energy of all frames
  std::span<const sim::UnitReport> units;  ///< units of the machine
  double count = 1;
  double time_ms = 0;     ///< time of all frames together
  double slowest_ms = 0;  ///< time of the slowest frame
};

/// An operating point of the chip: all its clocks multiplied by a factor, each with the voltage that it needs.
struct OperatingPoint {
  double factor = 1;
  std::vector<double> mhz, volt;  ///< clock and voltage of each clock domain
  sim::Band power_w;              ///< mean power over a frame period at the target rate
};

/// A run at the target rate frame.fps: each frame begins a period after the one before; the machine idles in between.
struct FrameRate {
  double fps = 0, period_ms = 0, slowest_ms = 0;
  double busy = 0;          ///< mean share of a period in which the machine works
  sim::Band idle_mw;        ///< power between frames, in mW
  sim::Band power_w;        ///< mean power; if the rate is not met, energy per frame times rate
  double clock_factor = 0;  ///< factor of the slowest clocks that meet the rate if the number of cycles stays the same
  std::optional<OperatingPoint> slowest;  ///< operating point with clock_factor; empty if not met or without curves
  std::optional<OperatingPoint> best;  ///< operating point of least power between `slowest` and the configured clocks

  /// Returns the frame rate of the slowest frame divided by the target rate.
  double rate_margin() const { return period_ms / slowest_ms; }
  double slack_ms() const { return period_ms - slowest_ms; }
  bool is_met() const;
};

/// Evaluates finished frames at the target rate frame.fps, which must be above 0. Operating points assume that a frame
/// takes equally many cycles at lower clocks. In fact it takes fewer, because the memory keeps its clock.
FrameRate evaluate_frame_rate(const RunConfig& config, const FinishedFrames& frames);

/// The target rate frame.fps of a run, and the time of its slowest frame over the mean frame time.
struct TargetRate {
  const RunConfig& config;
  double slowest_share = 1;
};

/// Returns the target rate of a run; nothing if frame.fps is 0. `frames`: the report's list of frames.
std::optional<TargetRate> target_rate(const FrameResult& run, const sim::Json& frames, const RunConfig& config);

/// Returns the members at_fps, power_at_fps_w and fps_margin of the totals of a run or of one of its replicates.
sim::Json frame_rate_json(const FrameResult& run, const TargetRate& target);
/// Returns the members at_fps, power_at_fps_w and fps_margin of a report's totals.
sim::Json frame_rate_json(const FrameRate& rate);

/// Returns one line on the target frame rate: "60 frames/s met, 3.1 ms to spare, 0.81 W; between frames 95 mW".
std::string frame_rate_text(const sim::Json& totals);
/// Returns one line on the clocks that meet the target rate: the slowest, and those with the least power; may be empty.
std::string operating_points_text(const sim::Json& totals);

}  // namespace tools
