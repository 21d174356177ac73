#pragma once
#include <memory>

#include "hw_models/machines/gpu.h"
#include "tools/simulation/run_job.h"

namespace tools {

/// The machine that `inputs` name, before its first cycle.
std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                  hw::TileSource& tiles, const hw::Perturbation& perturbation = {});
/// The machine of another configuration, for the work of `inputs`. `scheduled`: kernels of a machine with the same
/// shader cores, if there is one.
std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const RunConfig& config,
                                  const kernels::FrameRequirements& requirements, hw::TileSource& tiles,
                                  const hw::Perturbation& perturbation = {},
                                  std::shared_ptr<const hw::ScheduledKernels> scheduled = nullptr);

/// Plays all tiles. sim::Deadlock if the machine is stuck.
void run_to_end(hw::Gpu& gpu);

/// Energy of what it has done so far.
sim::EnergyReport energy_of(const hw::Gpu& gpu, const RunConfig& config);

/// Has a result say what a machine that has finished did.
void take(const hw::Gpu& gpu, const RunConfig& config, Simulation& s);

}  // namespace tools
