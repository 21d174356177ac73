#include <chrono>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/report.h"
#include "tools/run_job.h"
#include "tools/verbs/verbs.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {

namespace {

struct Timing {
  std::string scene;
  double functional_rays_per_s = 0, simulated_rays_per_s = 0, ns_per_step = 0;
};

/// Both halves on one thread each after the other, so that the ratio holds whatever the host is doing.
Timing measure(const std::string& scene, const JobOptions& wanted) {
  JobOptions options = wanted;
  options.scene = scene;
  options.threads = 1;
  const Inputs inputs = load_inputs(options);
  const kernels::ProgramSpec program = kernels::parse_program(options.program);
  const Simulation s = simulate(inputs, program, 1);
  const auto rays = static_cast<double>(s.rays());
  const double timing = s.wall_seconds - s.function.waited;
  return {inputs.scene.name, rays / s.function.seconds, rays / s.wall_seconds,
          timing * 1e9 / static_cast<double>(s.function.traversal_steps)};
}

void bench(const JobOptions& options, const std::vector<std::string>& scenes, bool json) {
  nlohmann::ordered_json out = {{"schema", "raywatt-bench/1"}, {"scenes", nlohmann::ordered_json::array()}};
  sim::Table table({"scene (1 thread)", "functional rays/s", "simulated rays/s", "ratio", "timing ns/step"});
  for (const std::string& scene : scenes) {
    const Timing t = measure(scene, options);
    const double ratio = t.functional_rays_per_s / t.simulated_rays_per_s;
    table.row({t.scene, sim::si_text(t.functional_rays_per_s), sim::si_text(t.simulated_rays_per_s),
               fmt::format("{:.2f}", ratio), fmt::format("{:.1f}", t.ns_per_step)});
    out["scenes"].push_back({{"scene", t.scene},
                             {"functional_rays_per_s", t.functional_rays_per_s},
                             {"simulated_rays_per_s", t.simulated_rays_per_s},
                             {"ratio", ratio},
                             {"ns_per_step", t.ns_per_step},
                             {"peak_rss_mb", peak_rss_mib()}});
  }
  fmt::print("{}", json ? sim::json_text(out) : table.text());
}

}  // namespace

void add_bench(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("bench", "How fast the simulator is: functional half and whole, in one run");
  const auto options = std::make_shared<JobOptions>();
  const auto scenes = std::make_shared<std::vector<std::string>>(std::vector<std::string>{"cornell", "teapot"});
  const auto json = std::make_shared<bool>(false);
  add_config_options(*verb, options->config, options->sets);
  verb->add_option("--scene", *scenes, "scenes to measure (repeatable)")->capture_default_str();
  verb->add_option("--resolution", options->resolution, "WIDTHxHEIGHT (default: the configuration's)");
  verb->add_flag("--json", *json, "as JSON");
  verb->footer("Example: raywatt bench --resolution 1024x512");
  verb->callback([=] { bench(*options, *scenes, *json); });
}

}  // namespace tools
