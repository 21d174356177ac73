#include "tools/simulation/machine_run.h"

#include "hw_models/dram/dram_energy.h"
#include "sim/engine.h"

namespace tools {

std::unique_ptr<hw::Gpu> make_gpu(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                  hw::TileSource& tiles, const hw::Perturbation& perturbation) {
  const bool dma_encodes = inputs.config.render.srgb == kernels::SrgbEncoder::kDma;
  return std::make_unique<hw::Gpu>(inputs.config.gpu,
                                   hw::Gpu::Workload{inputs.image, inputs.parents, requirements, dma_encodes}, tiles,
                                   perturbation);
}

sim::EnergyReport energy_of(const hw::Gpu& gpu, const Inputs& inputs) {
  return sim::compute_energy(gpu.report(), inputs.config.energy, hw::dram_energy_events(inputs.config.gpu.dram),
                             gpu.elapsed());
}

void run_to_end(hw::Gpu& gpu) { gpu.finish(sim::run(gpu)); }

void take(const hw::Gpu& gpu, const Inputs& inputs, Simulation& s) {
  s.units = gpu.report();
  s.kernel_use = gpu.kernel_use();
  s.kernels = gpu.kernels();
  s.cycles = gpu.cycles();
  s.elapsed = gpu.elapsed();
  s.energy = energy_of(gpu, inputs);
}

}  // namespace tools
