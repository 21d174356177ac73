#pragma once
#include <memory>
#include <span>

#include "hw_models/machines/gpu.h"
#include "tools/run/frame/run_job.h"

namespace tools {

/// A frame without tiles, for machines that are built but not run.
class NoTiles final : public hw::TileSource {
 public:
  const traces::TileWork* next() override { return nullptr; }
  void give_back(const traces::TileWork* /*work*/) override {}
};

/// The machine that `inputs` name, before its first cycle.
std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                  hw::TileSource& tiles, const hw::Perturbation& perturbation = {},
                                  hw::Observer* observer = nullptr);
/// The machine of another configuration, for the work of `inputs`. `scheduled`: kernels of a machine with the same
/// shader cores, if there is one.
std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const RunConfig& config,
                                  const kernels::FrameRequirements& requirements, hw::TileSource& tiles,
                                  const hw::Perturbation& perturbation = {}, hw::Observer* observer = nullptr,
                                  std::shared_ptr<const hw::ScheduledKernels> scheduled = nullptr);

/// InputError for a figure of energy or area that its units call for and the configuration lacks, or the other way
/// round.
void check_figures(const hw::Gpu& gpu, const RunConfig& config);

/// Plays all tiles, or until the machine is stopped. sim::Deadlock if the machine is stuck.
void run_to_end(hw::Gpu& gpu);

/// Energy of what it has done so far.
sim::EnergyReport energy_of(const hw::Gpu& gpu, const RunConfig& config);

/// Energy of what the units of a machine have counted in so much time.
sim::EnergyReport energy_of(std::span<const sim::UnitReport> units, sim::Time elapsed, const RunConfig& config);

/// Has a result say what a machine that has finished did.
void take(const hw::Gpu& gpu, const RunConfig& config, FrameResult& s);

}  // namespace tools
