#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/frame/front_end.h"
#include "hw_models/srp/schedule.h"
#include "hw_models/srp/srp_stats.h"
#include "shader_kernels/programs/program_spec.h"
#include "sim/report/energy.h"
#include "sim/report/unit_report.h"
#include "tools/options.h"
#include "tools/run_config.h"
#include "traces/accel/memory_image.h"
#include "traces/scene/info.h"

namespace tools {

/// Everything a run reads, read.
struct Inputs {
  RunConfig config;
  traces::SceneInfo scene;
  std::string scene_sha256;
  std::vector<std::string> warnings;
  traces::Camera camera;
  traces::MemoryImage image;
  std::vector<std::uint32_t> parents;  ///< of each node of the tree
  double load_seconds = 0;
};

/// The configuration with --set and --resolution applied. InputError.
RunConfig load_run_config(const JobOptions& options);
/// Reads scene and configuration and builds the tree. InputError.
Inputs load_inputs(const JobOptions& options);

/// A frame on the machine.
struct Simulation {
  kernels::ProgramSpec program;
  hw::FrontEnd::Result function;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernel_use;
  std::vector<hw::KernelSchedule> kernels;
  sim::EnergyReport energy;
  std::uint64_t cycles = 0;  ///< of the T&I clock
  sim::Time elapsed = 0;
  double wall_seconds = 0;  ///< host, functional and timing together
  std::uint64_t rays() const;
};

/// Runs a frame program on the machine. `threads` of the host: one plays the machine, the others run ahead of it.
/// sim::Deadlock if the machine is stuck.
Simulation simulate(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads);

/// The picture alone, traced by `tracer`.
hw::FrontEnd::Result render(const Inputs& inputs, const kernels::ProgramSpec& program, const traces::Tracer& tracer,
                            std::uint32_t threads);

/// 0 means all the host has.
std::uint32_t host_threads(std::uint32_t wanted);

}  // namespace tools
