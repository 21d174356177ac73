#include "tools/studies/bottleneck/bottleneck.h"

#include <algorithm>

#include "tools/analysis/limiter.h"
#include "tools/simulation/run_job.h"

namespace tools {

Bottleneck find_bottleneck(const JobOptions& options) {
  Inputs inputs = load_inputs(options);
  const kernels::ProgramSpec program = kernels::parse_program(options.program);
  const Simulation measured = simulate(inputs, program, options.threads);
  const CoreTime time = top_down(measured.units, measured.machine).gpu;
  const std::vector<Estimate> estimates = estimate(time);
  Bottleneck found{.cycles = measured.cycles,
                   .limiter = limiter(estimates),
                   .time = time,
                   .named = most(estimates).resource,
                   .bounds = {}};
  for (const hw::IdealConfig::Resource& resource : hw::IdealConfig::kResources) {
    bool& ideal = inputs.config.gpu.ideal.*resource.member;
    const bool configured = ideal;
    ideal = true;
    const double estimated = std::ranges::find(estimates, resource.name, &Estimate::resource)->speedup;
    found.bounds.push_back({resource.name, simulate(inputs, program, options.threads).cycles, estimated});
    ideal = configured;
  }
  return found;
}

}  // namespace tools
