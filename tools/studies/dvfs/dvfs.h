#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/config/field.h"
#include "sim/io/json.h"
#include "tools/run/frame/job_options.h"

namespace tools {

class Progress;

struct DvfsOptions {
  JobOptions job;
  /// Multiples of the configured clock frequencies at which the frame is simulated.
  std::vector<double> factors = {0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.1, 1.2};
  std::vector<std::string> domains = {"tni", "srp", "l2"};  ///< domains whose clocks are scaled
  double fps = 0;  ///< target frame rate in 1/s; 0: frame.fps of the configuration, else the slowest point's rate
};

/// An operating point: results of the frame with its clocks multiplied by one factor.
struct DvfsPoint {
  double factor = 1;
  std::vector<double> mhz, volt;  ///< frequency and voltage of each clock domain
  std::uint64_t cycles = 0;       ///< cycles of the T&I clock
  double ms = 0;
  sim::Band mj;        ///< energy of the frame
  double idle_mw = 0;  ///< power while idle between frames
  /// Energy of the frame and the idle time until the period ends; negative if the frame is longer than the period.
  double period_mj = -1;
  double power_w() const { return mj.nominal / ms; }
  double frames_per_second() const { return 1000 / ms; }
};

/// Operating points of a frame, sorted by clock frequency. The memory clock is constant.
struct DvfsCurve {
  std::vector<DvfsPoint> points;
  double period_ms = 0;
  std::vector<std::string> warnings;
  std::size_t energy_optimal = 0;          ///< point with the least energy per frame
  std::size_t race_to_idle = 0;            ///< fastest point; idle for the rest of the period
  std::size_t least_a_period = 0;          ///< point with the least energy per period
  std::optional<std::size_t> slowest_met;  ///< slowest point that meets the target frame rate, if there is a target
};

/// Computes the energy per period of all points. Sets the indices energy_optimal, race_to_idle and least_a_period.
void find_special_points(DvfsCurve& curve, double period_ms);

/// Returns the next clock factors to simulate, halfway between neighbouring points of the curve. They refine the
/// slowest point that meets the target period and the point with the least energy per period. Empty if both clocks are
/// known to 0.5 %. At least one point must meet the period.
std::vector<double> next_clock_factors(const DvfsCurve& curve);

/// Records the first frame once and simulates it with its clocks multiplied by each factor. A target frame rate adds
/// points until two clocks are known to 0.5 %: the slowest that meet the rate, and those with the least energy per
/// period. Caches are warm unless frame.start is set. Throws InputError, sim::Deadlock, Interrupted.
DvfsCurve dvfs_curve(const DvfsOptions& options, Progress* progress = nullptr);

std::string dvfs_text(const DvfsCurve& curve);
sim::Json dvfs_json(const DvfsCurve& curve);

}  // namespace tools
