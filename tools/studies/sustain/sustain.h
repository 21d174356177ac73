#pragma once
#include <optional>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/run/frame/job_options.h"
#include "tools/run/frame/sustained.h"

namespace tools {

class Progress;

struct SustainOptions {
  JobOptions job;
  double minutes = 0;  ///< simulated time in minutes; 0: thermal.minutes of the configuration, or ten if that is 0
  double loop = 60;    ///< length in seconds of the intervals ("loops") over which frame rates are averaged
  double fps = 0;      ///< rate at which frames begin, in 1/s; 0: frame.fps
};

/// Result of a sustained run under a thermal governor: the governor's clock steps and their steady temperatures.
struct SustainStudy {
  std::vector<SustainStep> steps;
  std::vector<std::vector<double>> mhz, volt;  ///< for each step: clock and voltage of each clock domain
  /// For each step: the temperatures that the phone reaches if it stays at this step; nothing for thermal runaway.
  std::vector<std::optional<sim::Temperatures>> steady;
  SustainSetup setup;
  Sustained run;
  std::vector<std::string> warnings;
};

/// Records the frames once, simulates them at each clock setting of the thermal governor, and then simulates the
/// governor over time. Throws InputError, sim::Deadlock and Interrupted.
SustainStudy sustain_study(const SustainOptions& options, Progress* progress = nullptr);

std::string sustain_text(const SustainStudy& study);
sim::Json sustain_json(const SustainStudy& study);

}  // namespace tools
