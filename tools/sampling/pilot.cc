#include "tools/sampling/pilot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/schedule.h"
#include "hw_models/srp/tile_buffer.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/full.h"
#include "tools/host/interrupt.h"

namespace tools {
namespace {

/// A pilot traces one sample of each square. Sides of the square to try, until one divides the tile's side.
constexpr std::array kSides = {4U, 5U, 3U, 2U, 1U};
/// Sides for guess_costs(), which needs less precision.
constexpr std::array kGuessSides = {8U, 4U, 5U, 3U, 2U, 1U};
/// Host cost of a reflected or refracted ray besides its traversal, in traversal steps (docs/slices.md).
constexpr std::uint64_t kStepsOfARay = 15;

/// The frame with one sample per square and the same number of tiles.
kernels::FullProgram thin_program(const Inputs& inputs, const kernels::ProgramSpec& spec,
                                  std::span<const std::uint32_t> sides, double& thinning) {
  kernels::RenderConfig render = inputs.config.render;
  const auto grid = static_cast<std::uint32_t>(std::lround(std::sqrt(spec.samples)));
  const std::uint32_t side = tile_side(render, spec);
  const std::uint32_t square = *std::ranges::find_if(sides, [&](std::uint32_t s) { return side % s == 0; });
  const auto thinned = [&](std::uint32_t pixels) { return (pixels * grid + square - 1) / square; };
  thinning = static_cast<double>(render.width) * render.height * spec.samples;
  render.width = thinned(render.width);
  render.height = thinned(render.height);
  render.tile = side / square;
  thinning /= static_cast<double>(render.width) * render.height;
  return {inputs.image, inputs.camera, render, 1, inputs.frame};
}

}  // namespace

std::uint32_t tile_side(const kernels::RenderConfig& render, const kernels::ProgramSpec& spec) {
  const auto grid = static_cast<std::uint32_t>(std::lround(std::sqrt(spec.samples)));
  return std::max(1U, render.tile / grid) * grid;
}

Pilot look_at_all(const Inputs& inputs, const kernels::ProgramSpec& spec, const traces::Tracer& tracer,
                  std::uint32_t threads, Progress* progress) {
  if (progress != nullptr) progress->phase("looking at all tiles");
  Pilot pilot;
  kernels::FullProgram program = thin_program(inputs, spec, kSides, pilot.thinning);
  std::vector<hw::KernelSchedule> kernels;
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    kernels.push_back(hw::schedule(kernel.graph, inputs.config.gpu->srp));
  }
  const hw::GpuConfig& gpu = *inputs.config.gpu;
  const kernels::FrameRequirements requirements =
      kernels::FullProgram(inputs.image, inputs.camera, inputs.config.render, spec.samples, inputs.frame)
          .requirements();
  const hw::TilesInFlight tiles = hw::tiles_in_flight(gpu.tile_buffer, requirements, gpu.ideal.tile_buffer);
  const hw::TileBuffer buffer(gpu.tile_buffer, requirements, gpu.clocks.srp.clock(), gpu.ideal.tile_buffer);
  TilePilot look(gpu, inputs.image.layout, kernels, pilot.thinning, static_cast<double>(buffer.slots()) / tiles.first);
  FrontEnd front_end(program, tracer, host_threads(threads) - 1);
  while (const traces::TileWork* work = front_end.next()) {
    if (interrupted()) throw Interrupted{};
    pilot.traits.push_back(look.look(*work));
    pilot.costs.push_back(look.cost(pilot.traits.back()));
    front_end.give_back(work);
  }
  pilot.function = front_end.result();
  return pilot;
}

std::vector<double> guess_costs(const Inputs& inputs, const kernels::ProgramSpec& spec, const traces::Tracer& tracer,
                                std::uint32_t threads) {
  double thinning = 0;
  kernels::FullProgram program = thin_program(inputs, spec, kGuessSides, thinning);
  FrontEnd front_end(program, tracer, host_threads(threads) - 1);
  const FrontEnd::Result& function = front_end.result();
  std::vector<double> costs;
  double before = 0;
  while (const traces::TileWork* work = front_end.next()) {
    if (interrupted()) throw Interrupted{};
    front_end.give_back(work);
    const std::uint64_t sent_on = function.rays[static_cast<std::size_t>(traces::RayKind::kReflection)] +
                                  function.rays[static_cast<std::size_t>(traces::RayKind::kRefraction)];
    const double all = static_cast<double>(function.traversal_steps + kStepsOfARay * sent_on);
    costs.push_back(all - before);
    before = all;
  }
  return costs;
}

FrontEnd::Result scaled(const Pilot& pilot, const Inputs& inputs, const kernels::ProgramSpec& spec) {
  const auto whole = [&](std::uint64_t count) { return rounded(pilot.thinning * static_cast<double>(count)); };
  FrontEnd::Result f;
  for (std::size_t k = 0; k < std::size(f.rays); ++k) f.rays[k] = whole(pilot.function.rays[k]);
  f.continued = whole(pilot.function.continued);
  f.traversal_steps = whole(pilot.function.traversal_steps);
  f.sampling.wanted = std::uint64_t{inputs.config.render.width} * inputs.config.render.height * spec.samples;
  f.sampling.traced = f.sampling.wanted;
  f.sampling.background = f.sampling.traced_background = whole(pilot.function.sampling.background);
  return f;
}

}  // namespace tools
