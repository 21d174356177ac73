#include "tools/studies/sustain/sustain.h"

#include <algorithm>
#include <cstddef>

#include "hw_models/machines/gpu_config.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/power.h"
#include "tools/run/frame/run_job.h"
#include "tools/run/frame/table_warnings.h"

namespace tools {

SustainStudy sustain_study(const SustainOptions& options, Progress* progress) {
  constexpr double kUsualMinutes = 10, kHzPerMhz = 1e6;
  JobOptions job = options.job;
  job.sets.emplace_back("power.voltage=dvfs");  // every frequency has its own voltage
  Inputs inputs = load_inputs(job, progress);
  print_warnings(inputs.warnings, progress);
  check_table_names(idle_unit_reports(*inputs.config.gpu, {}, inputs.config.bvh), inputs.config);
  double& minutes = inputs.config.thermal.minutes;
  if (options.minutes > 0) minutes = options.minutes;
  if (minutes == 0) minutes = kUsualMinutes;
  SustainStudy study;
  study.setup = sustain_setup(inputs.config);
  study.setup.loop = std::min(options.loop, study.setup.seconds);
  if (options.fps > 0) study.setup.fps = options.fps;
  study.warnings = inputs.warnings;
  const std::vector<double> factors = governor_factors(inputs.config.thermal);
  const std::vector<RunConfig> configs = governor_configs(inputs.config);
  for (std::size_t i = 0; i < configs.size(); ++i) {
    study.steps.push_back({factors[i], {}});
    std::vector<double>&mhz = study.mhz.emplace_back(), &volt = study.volt.emplace_back();
    for (const ClockDomain& domain : clock_domains()) {
      mhz.push_back(static_cast<double>((configs[i].gpu->clocks.*domain.clock).hz) / kHzPerMhz);
      volt.push_back(voltage_needed(configs[i], domain));
    }
    add_warnings(study.warnings, technology_table_warnings(configs[i]));
  }
  const kernels::ProgramSpec program = kernels::parse_program(options.job.program);
  for_each_frame(inputs, options.job.threads, progress, [&] {
    if (progress != nullptr) progress->expect_parts(static_cast<std::uint32_t>(configs.size()) + 1);
    const RecordedFrame frame(inputs, program, "sustain", options.job.threads, progress);
    const std::vector<FrameResult> played = frame.simulate(configs);
    for (std::size_t i = 0; i < played.size(); ++i) {
      const FrameResult& result = played[i];
      study.steps[i].frames.push_back(sustain_frame(configs[i], result.energy, result.units, result.elapsed));
    }
  });
  add_warnings(study.warnings, limit_warnings(study.steps, study.setup));
  for (const SustainStep& step : study.steps) study.steady.push_back(steady_temperatures(step, study.setup));
  study.run = sustain(study.steps, study.setup);
  print_warnings({study.warnings.begin() + static_cast<std::ptrdiff_t>(inputs.warnings.size()), study.warnings.end()},
                 progress);
  return study;
}

}  // namespace tools
