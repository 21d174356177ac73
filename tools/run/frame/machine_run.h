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

/// Builds the machine of `inputs`.
std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                  hw::TileSource& tiles, const hw::Perturbation& perturbation = {},
                                  hw::Observer* observer = nullptr);
/// Builds a machine of another configuration for the work of `inputs`. `scheduled`: kernel schedules of a machine with
/// the same shader cores, if any.
std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const RunConfig& config,
                                  const kernels::FrameRequirements& requirements, hw::TileSource& tiles,
                                  const hw::Perturbation& perturbation = {}, hw::Observer* observer = nullptr,
                                  std::shared_ptr<const hw::ScheduledKernels> scheduled = nullptr);

/// Throws InputError if the machine's units and the tables of energy and area do not match.
void check_figures(const hw::Gpu& gpu, const RunConfig& config);

/// Runs the machine until all tiles are done or it is stopped. sim::Deadlock if the machine is stuck.
void run_to_end(hw::Gpu& gpu);

/// Returns the energy of the machine so far.
sim::EnergyReport energy_of(const hw::Gpu& gpu, const RunConfig& config);

/// Returns the energy of the units' counts over `elapsed`.
sim::EnergyReport energy_of(std::span<const sim::UnitReport> units, sim::Time elapsed, const RunConfig& config);

/// Copies the results of a finished machine into `s`.
void take(const hw::Gpu& gpu, const RunConfig& config, FrameResult& s);

}  // namespace tools
