#include "tools/studies/sustain/sustain.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/io/json.h"
#include "sim/report/table.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/power.h"
#include "tools/run/frame/run_job.h"

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

namespace {

using sim::Json;

/// Joins the values of all clock domains into a text: "500/1000/500".
std::string join_domain_values(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{:.4g}", text.empty() ? "" : "/", value);
  return text;
}

Json temperatures_json(const sim::Temperatures& t) { return {{"die_c", t.die}, {"body_c", t.body}}; }

}  // namespace

std::string sustain_text(const SustainStudy& study) {
  const SustainSetup& setup = study.setup;
  sim::Table clocks({"clocks x", "MHz", "V", "ms", "frames/s", "steady die, C", "steady body, C"});
  for (std::size_t i = 0; i < study.steps.size(); ++i) {
    const SustainStep& step = study.steps[i];
    double seconds = 0;
    for (const SustainFrame& frame : step.frames) seconds += frame.seconds;
    const double mean = seconds / static_cast<double>(step.frames.size());
    const auto celsius = [&](double sim::Temperatures::*node) {
      return study.steady[i] ? fmt::format("{:.1f}", *study.steady[i].*node) : std::string("runs away");
    };
    clocks.add_row({fmt::format("{:.3g}", step.factor), join_domain_values(study.mhz[i]),
                    join_domain_values(study.volt[i]), sim::four_digit_text(1000 * mean),
                    sim::four_digit_text(1 / mean), celsius(&sim::Temperatures::die),
                    celsius(&sim::Temperatures::body)});
  }
  sim::Table loops({"min", "frames/s", "W", "clocks x", "least", "die, C", "body, C"});
  for (std::size_t i = 0; i < study.run.loops.size(); ++i) {
    const SustainLoop& loop = study.run.loops[i];
    loops.add_row({fmt::format("{:.3g}", static_cast<double>(i + 1) * setup.loop / 60), sim::four_digit_text(loop.fps),
                   sim::four_digit_text(loop.watt), fmt::format("{:.3f}", loop.factor),
                   fmt::format("{:.3g}", loop.least_factor), fmt::format("{:.1f}", loop.temperatures.die),
                   fmt::format("{:.1f}", loop.temperatures.body)});
  }
  const Sustained& run = study.run;
  return fmt::format(
      "clocks of T&I units / shader cores / L2, and the temperatures that each leads to if it is kept\n\n{}\n"
      "in loops of {} s; limits: die {:.4g} C, body {:.4g} C\n\n{}\n"
      "sustained {} frames/s, stability {:.1f} % (worst over best loop), {} changes of the clock\n"
      "{} frames in {:.1f} s, {} J\n",
      clocks.text(), sim::four_digit_text(setup.loop), setup.thermal.die_limit, setup.thermal.body_limit, loops.text(),
      sim::four_digit_text(run.sustained_fps), 100 * run.stability(), run.changes, run.frames, run.seconds,
      sim::four_digit_text(run.energy_j));
}

Json sustain_json(const SustainStudy& study) {
  Json steps = Json::array(), loops = Json::array();
  for (std::size_t i = 0; i < study.steps.size(); ++i) {
    const SustainStep& step = study.steps[i];
    Json mhz = Json::object(), volt = Json::object(), frames = Json::array();
    for (std::size_t d = 0; d < clock_domains().size(); ++d) {
      mhz[std::string(clock_domains()[d].name)] = study.mhz[i][d];
      volt[std::string(clock_domains()[d].name)] = study.volt[i][d];
    }
    for (const SustainFrame& f : step.frames) {
      frames.push_back({{"time_ms", 1000 * f.seconds},
                        {"dynamic_mj", 1000 * f.dynamic_j},
                        {"leakage_mw", 1000 * f.leakage_w},
                        {"memory_mj", 1000 * f.memory_j}});
    }
    steps.push_back({{"factor", step.factor},
                     {"mhz", mhz},
                     {"volt", volt},
                     {"frames", frames},
                     {"steady", study.steady[i] ? temperatures_json(*study.steady[i]) : Json(nullptr)}});
  }
  for (const SustainLoop& loop : study.run.loops) {
    loops.push_back({{"fps", loop.fps},
                     {"power_w", loop.watt},
                     {"factor", loop.factor},
                     {"least_factor", loop.least_factor},
                     {"end", temperatures_json(loop.temperatures)}});
  }
  const Sustained& run = study.run;
  return {{"schema", "raywatt-sustain/1"},
          {"first_fps", run.first_fps},
          {"sustained_fps", run.sustained_fps},
          {"stability", run.stability()},
          {"frames", run.frames},
          {"seconds", run.seconds},
          {"energy_j", run.energy_j},
          {"clock_changes", run.changes},
          {"hottest", temperatures_json(run.hottest)},
          {"loop_s", study.setup.loop},
          {"warnings", study.warnings},
          {"steps", steps},
          {"loops", loops}};
}

}  // namespace tools
