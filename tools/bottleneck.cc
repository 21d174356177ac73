#include "tools/bottleneck.h"

#include "tools/limiter.h"
#include "tools/run_job.h"

namespace tools {

Bottleneck find_bottleneck(const JobOptions& options) {
  Inputs inputs = load_inputs(options);
  const kernels::ProgramSpec program = kernels::parse_program(options.program);
  const Simulation measured = simulate(inputs, program, options.threads);
  Bottleneck found{.cycles = measured.cycles, .limiter = limiter(measured.units), .named = {}, .bounds = {}};
  for (const auto& [name, member] : hw::IdealConfig::kResources) {
    bool& ideal = inputs.config.gpu.ideal.*member;
    const bool configured = ideal;
    ideal = true;
    found.bounds.push_back({std::string(name), simulate(inputs, program, options.threads).cycles});
    ideal = configured;
  }
  return found;
}

}  // namespace tools
