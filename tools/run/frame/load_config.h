#pragma once
#include <string>
#include <vector>

#include "shader_kernels/programs/programs.h"
#include "shader_kernels/programs/wavefront/render_config.h"
#include "sim/config/config_tree.h"
#include "sim/config/field.h"
#include "sim/named.h"
#include "sim/report/area.h"
#include "sim/report/energy.h"
#include "sim/report/power.h"
#include "tools/run/frame/cache_latency.h"
#include "tools/run/frame/job_options.h"
#include "tools/run/frame/machine_config.h"
#include "traces/accel/bvh_config.h"
#include "traces/scenes/workload.h"

namespace tools {

/// Everything that a run depends on, except the frame program: one YAML file. The machine's keys are at the top level.
struct RunConfig {
  MachineConfig gpu;
  kernels::RenderConfig render;
  kernels::ProgramConfig programs;
  traces::BvhConfig bvh;
  sim::EnergyConfig energy;
  sim::PowerConfig power;
  sim::AreaConfig area;
  LatencyConfig latency;
  traces::WorkloadConfig scene;
  traces::SceneLimits limits;

  static void describe(auto& c, auto&& field);
  void check(auto&& complain) const;
};

/// Loads the configuration of a run: the file, the workload if --scene names one, then --set, --scene, --camera,
/// --frames and --resolution. InputError.
RunConfig load_run_config(const JobOptions& options);

/// Returns a warning for each setting of the command line that has no effect.
std::vector<std::string> idle_settings(const JobOptions& options, const RunConfig& config);

/// Throws InputError if the name is not a scene, a workload or a file.
void check_scene(const std::string& name);

// First step of load_run_config(); ConfigVariants performs the others.
/// Loads the file, then the workload if `scene` names one. The result is not checked.
RunConfig load_base_config(const std::string& config, const std::string& scene);

// Last steps of load_run_config(), for configurations from other sources.
void apply_ideal(RunConfig& config, const std::vector<std::string>& resources);
/// Checks limits and rules, and that there are energy values. `origin`: name of the configuration in errors.
void check_run_config(RunConfig& config, const std::string& origin);

}  // namespace tools

/// Instantiated only in load_config.cc because the machine has many keys.
extern template sim::ConfigNode sim::config_tree(tools::RunConfig& config);
