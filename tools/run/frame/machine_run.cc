#include "tools/run/frame/machine_run.h"

#include <utility>

#include "hw_models/dram/dram_energy.h"
#include "sim/engine.h"
#include "tools/run/frame/power.h"
#include "tools/run/frame/table_names.h"

namespace tools {

std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                  hw::TileSource& tiles, const hw::Perturbation& perturbation, hw::Observer* observer) {
  return make_gpu(inputs, inputs.config, requirements, tiles, perturbation, observer);
}

std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const RunConfig& config,
                                  const kernels::FrameRequirements& requirements, hw::TileSource& tiles,
                                  const hw::Perturbation& perturbation, hw::Observer* observer,
                                  std::shared_ptr<const hw::ScheduledKernels> scheduled) {
  const bool dma_encodes = config.render.srgb == kernels::SrgbEncoder::kDma;
  return std::make_unique<hw::Gpu>(
      *config.gpu,
      hw::Gpu::Workload{inputs.image, inputs.parents, requirements, dma_encodes, observer, std::move(scheduled)}, tiles,
      perturbation);
}

void check_figures(const hw::Gpu& gpu, const RunConfig& config) {
  check_table_names(gpu.report(), config);
  energy_of(gpu, config);
  if (!config.area.arrays.empty()) sim::compute_area(gpu.report(), config.energy, config.area);
}

sim::EnergyReport energy_of(const hw::Gpu& gpu, const RunConfig& config) {
  return energy_of(gpu.report(), gpu.elapsed(), config);
}

sim::EnergyReport energy_of(std::span<const sim::UnitReport> units, sim::Time elapsed, const RunConfig& config) {
  return sim::compute_energy(units, config.energy, hw::dram_energy_events(config.gpu->dram), elapsed,
                             power_scales(config));
}

void run_to_end(hw::Gpu& gpu) {
  const sim::Time last_edge = sim::run(gpu);
  if (!gpu.stopped()) gpu.finish(last_edge);
}

void take(const hw::Gpu& gpu, const RunConfig& config, FrameResult& s) {
  s.units = gpu.report();
  s.kernel_use = gpu.kernel_use();
  s.kernels = gpu.kernels();
  s.cycles = gpu.cycles();
  s.elapsed = gpu.elapsed();
  s.energy = energy_of(gpu, config);
}

}  // namespace tools
