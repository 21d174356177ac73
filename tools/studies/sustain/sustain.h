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
  double minutes = 0;  ///< simulated time in minutes; 0: thermal.minutes, or ten if that is 0
  double loop = 60;    ///< length in seconds of a loop over which frame rates are averaged
  double fps = 0;      ///< rate at which frames begin; 0: each begins when the previous one ends
};

/// Result of a sustained run: the governor's steps, their clocks, and their steady temperatures.
struct SustainStudy {
  std::vector<SustainStep> steps;
  std::vector<std::vector<double>> mhz, volt;  ///< for each step: clock and voltage of each clock domain
  /// For each step: temperatures that the phone reaches if the step is kept forever; none: thermal runaway.
  std::vector<std::optional<sim::Temperatures>> steady;
  SustainSetup setup;
  Sustained run;
  std::vector<std::string> warnings;
};

/// Records the frames once, simulates them at each of the governor's clocks, and then runs the governor. Throws
/// InputError, sim::Deadlock and Interrupted.
SustainStudy sustain_study(const SustainOptions& options, Progress* progress = nullptr);

std::string sustain_text(const SustainStudy& study);
sim::Json sustain_json(const SustainStudy& study);

}  // namespace tools
