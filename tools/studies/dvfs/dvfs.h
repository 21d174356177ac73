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
  /// Multiples of the configured clock frequencies.
  std::vector<double> factors = {0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.1, 1.2};
  std::vector<std::string> domains = {"tni", "srp", "l2"};  ///< domains whose clocks are scaled
  double fps = 0;  ///< target frame rate in 1/s; 0: frame rate of the slowest point
};

/// Results of the frame with the scaled clocks multiplied by one factor.
struct DvfsPoint {
  double factor = 1;
  std::vector<double> mhz, volt;  ///< frequency and voltage of each clock domain
  std::uint64_t cycles = 0;       ///< cycles of the T&I clock
  double ms = 0;
  sim::Band mj;        ///< per frame
  double idle_mw = 0;  ///< power between frames
  /// Energy of a period: the frame and the idle time after it; negative if the frame exceeds the period.
  double period_mj = -1;
  double power_w() const { return mj.nominal / ms; }
  double frames_per_second() const { return 1000 / ms; }
};

/// Operating points of a frame in order of ascending core clock; the memory clock is constant.
struct DvfsCurve {
  std::vector<DvfsPoint> points;
  double period_ms = 0;
  std::vector<std::string> warnings;
  std::size_t energy_optimal = 0;          ///< point with the least energy per frame
  std::size_t race_to_idle = 0;            ///< fastest point; idle for the rest of the period
  std::size_t least_a_period = 0;          ///< point with the least energy per period
  std::optional<std::size_t> slowest_met;  ///< with a target rate: the slowest point that meets it
};

/// Computes the energy per period of all points, and the three special points.
void choose_points(DvfsCurve& curve, double period_ms);

/// Returns factors between those of the points, at which the slowest point that meets the period and that with the
/// least energy per period are to be searched; none if both are known to 0.5 %. At least one point meets the period.
std::vector<double> factors_to_try(const DvfsCurve& curve);

/// Records the first frame once and simulates it with its clocks multiplied by each factor. A target rate adds points
/// until two of them are known to 0.5 %: the slowest clocks that meet the rate, and the clocks with the least energy
/// per period. Caches are warm unless frame.start is set. Throws InputError, sim::Deadlock, Interrupted.
DvfsCurve dvfs_curve(const DvfsOptions& options, Progress* progress = nullptr);

std::string dvfs_text(const DvfsCurve& curve);
sim::Json dvfs_json(const DvfsCurve& curve);

}  // namespace tools
