#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "sim/config/field.h"
#include "sim/io/json.h"
#include "tools/run/frame/job_options.h"

namespace tools {

class Progress;

struct DvfsOptions {
  JobOptions job;
  std::vector<double> factors = {0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.1, 1.2};  ///< times the configured clocks
  std::vector<std::string> domains = {"tni", "srp", "l2"};                         ///< those whose clocks move
  double fps = 0;  ///< frames a second that are wanted; 0: those of the slowest point
};

/// The frame at clocks that are a factor times the configured ones.
struct DvfsPoint {
  double factor = 1;
  std::vector<double> mhz, volt;  ///< clock and voltage of each domain
  std::uint64_t cycles = 0;       ///< cycles of the T&I clock
  double ms = 0;
  sim::Band mj;           ///< a frame
  double idle_mw = 0;     ///< between frames
  double period_mj = -1;  ///< a frame and the rest of its period; negative: it takes longer than that
  double watt() const { return mj.nominal / ms; }
  double fps() const { return 1000 / ms; }
};

/// Figures of a frame over the clock, by rising factor, with the memory's clock as it is.
struct DvfsCurve {
  std::vector<DvfsPoint> points;
  double period_ms = 0;
  std::vector<std::string> warnings;
  std::size_t energy_optimal = 0;  ///< least energy a frame, whatever becomes of the time after it
  std::size_t race_to_idle = 0;    ///< the fastest, then idle for the rest of the period
  std::size_t least_a_period = 0;  ///< least energy of frame and rest
};

/// Names the points of a curve whose frames are known: period energies, and which points are which.
void choose_points(DvfsCurve& curve, double period_ms);

/// The first frame, recorded once and played on a machine for each factor. InputError, sim::Deadlock, Interrupted.
DvfsCurve dvfs_curve(const DvfsOptions& options, Progress* progress = nullptr);

std::string dvfs_text(const DvfsCurve& curve);
sim::Json dvfs_json(const DvfsCurve& curve);

}  // namespace tools
