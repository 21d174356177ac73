#include "tools/jobs/plain_report.h"

#include <optional>
#include <utility>

#include "sim/io/json.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report.h"
#include "tools/jobs/outcome.h"

namespace tools {
namespace {

/// A frame program and what it carries from frame to frame.
struct Program {
  Program(const std::string& name, const Inputs& inputs)
      : spec(kernels::parse_program(name)), rates(inputs.config.programs.multirate) {}
  kernels::ProgramSpec spec;
  kernels::RateMap rates;
};

}  // namespace

sim::Json plain_report(Inputs inputs, const JobOptions& options, Progress* progress) {
  Program program(options.program, inputs);
  std::optional<Program> reference;
  if (!options.reference.empty()) reference.emplace(options.reference, inputs);
  const auto simulated = [&](Program& p) {
    return simulate(inputs, p.spec, options.threads,
                    {.rates = &p.rates,
                     .progress = progress,
                     .reference = reference && &p == &*reference,
                     .replicates = options.replicates});
  };
  Outcome out;
  for_each_frame(inputs, options.threads, progress, [&] {
    Simulation frame = simulated(program);
    std::optional<Simulation> compared;
    if (reference) compared = simulated(*reference);
    const double error = compared ? mean_squared_error(frame.function.rgb, compared->function.rgb) : 0;
    out.add(inputs.frame, std::move(frame), std::move(compared), error);
  });
  const Result result = out.result();
  return report_json({inputs, options, result, out.frames, false, 0});
}

}  // namespace tools
