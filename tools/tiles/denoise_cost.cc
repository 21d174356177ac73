#include "tools/tiles/denoise_cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "shader_kernels/catalogue.h"
#include "tools/tiles/tile_energy.h"

namespace tools {
namespace {

using kernels::kKernelId, kernels::FilterLight, kernels::TapSource;

/// The kernels with which entries of the denoiser's passes begin.
constexpr auto kFirstKernels = std::to_array<traces::KernelId>(
    {kKernelId<kernels::AccumulateHistory<true>>, kKernelId<kernels::AccumulateHistory<false>>,
     kKernelId<kernels::UnpackTaps<true>>, kKernelId<kernels::UnpackTaps<false>>,
     kKernelId<FilterLight<true, TapSource::kMemory>>, kKernelId<FilterLight<false, TapSource::kMemory>>,
     kKernelId<kernels::ModulateAlbedo<true>>, kKernelId<kernels::ModulateAlbedo<false>>});

bool is_of_denoiser(const kernels::TileSummaries& summaries, std::size_t tile) {
  const std::uint64_t begin = tile == 0 ? 0 : summaries.tiles[tile - 1].kernels;
  return begin != summaries.tiles[tile].kernels &&
         std::ranges::find(kFirstKernels, summaries.kernels[begin].kernel) != kFirstKernels.end();
}

DenoiseCost external_cost(const RunConfig& config) {
  const kernels::DenoiseConfig& denoise = config.programs.denoise;
  const double pixels = std::pow(denoise.external_upscaling, 2) * config.render.width * config.render.height;
  constexpr double kFemtosecondsPerNanosecond = 1e6;
  return {.is_external = true,
          .time = static_cast<sim::Time>(std::llround(denoise.external_time * pixels * kFemtosecondsPerNanosecond)),
          .dram_bytes = static_cast<std::uint64_t>(std::llround(denoise.external_bytes * pixels)),
          .energy_pj = denoise.external_energy * pixels};
}

}  // namespace

std::optional<DenoiseCost> denoise_cost(const FrameResult& frame, const RunConfig& config) {
  if (config.programs.denoise.filter == kernels::DenoiseFilter::kExternal) return external_cost(config);
  if (!config.programs.denoise.has_kernels() || frame.tile_accounts.empty()) return {};
  DenoiseCost cost;
  const TileEnergy energy = tile_energy(frame, config);
  sim::Time begin = 0;
  for (std::size_t i = 0; i < frame.tile_accounts.size(); ++i) {
    const hw::TileAccount& account = frame.tile_accounts[i];
    if (!is_of_denoiser(frame.rendered.summaries, i)) {
      begin = std::max(begin, account.finished);
      continue;
    }
    cost.dram_bytes += (account.dram_reads + account.dram_writes) * hw::kLineBytes;
    cost.energy_pj += energy.tiles[i].nominal;
  }
  cost.time = frame.elapsed - std::min(begin, frame.elapsed);
  return cost;
}

}  // namespace tools
