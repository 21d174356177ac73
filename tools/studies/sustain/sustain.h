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
  double minutes = 0;  ///< simulated minutes; 0: thermal.minutes, or ten if that is 0
  double loop = 60;    ///< seconds of a loop, over which frame rates are averaged
  double fps = 0;      ///< frames begin at this rate; 0: each begins when the last ends
};

/// A sustained run, its clocks, and the steady temperatures of each clock.
struct SustainStudy {
  std::vector<SustainStep> steps;
  std::vector<std::vector<double>> mhz, volt;  ///< by step: clock and voltage of each clock domain
  /// By step: steady temperatures without the governor; none: thermal runaway.
  std::vector<std::optional<sim::Temperatures>> steady;
  SustainSetup setup;
  Sustained run;
  std::vector<std::string> warnings;
};

/// Records the frames once, plays them at each of the governor's clocks, then runs the governor. Throws InputError,
/// sim::Deadlock and Interrupted.
SustainStudy sustain_study(const SustainOptions& options, Progress* progress = nullptr);

std::string sustain_text(const SustainStudy& study);
sim::Json sustain_json(const SustainStudy& study);

}  // namespace tools
