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

/// Everything a run depends on but the frame program: one YAML file. The machine's keys stand at the top level.
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

/// The configuration that a run works with: the file, then the workload if --scene names one, then --set, then --scene,
/// --camera, --frames and --resolution. InputError.
RunConfig load_run_config(const JobOptions& options);

/// A line for each setting of the command line that does not do what it seems to.
std::vector<std::string> idle_settings(const JobOptions& options, const RunConfig& config);

/// InputError for a name that no scene or workload has and that is no file's.
void check_scene(const std::string& name);

// Its first step; config_variants.h has the others.
/// The file, then the workload, if `scene` names one. Not checked yet.
RunConfig load_base_config(const std::string& config, const std::string& scene);

// Its last steps, for configurations that come from elsewhere.
void apply_ideal(RunConfig& config, const std::vector<std::string>& resources);
/// Checks limits, rules, and that there are energy figures; `origin` is where the configuration comes from.
void check_run_config(RunConfig& config, const std::string& origin);

}  // namespace tools

/// Compiled once, in load_config.cc: the machine has many keys.
extern template sim::ConfigNode sim::config_tree(tools::RunConfig& config);
