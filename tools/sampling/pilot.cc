#include "tools/sampling/pilot.h"

#include <algorithm>
#include <cmath>

#include "hw_models/srp/schedule.h"
#include "hw_models/srp/tile_buffer.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/full.h"
#include "tools/host/interrupt.h"

namespace tools {
namespace {

/// Side of the squares of samples of which one is traced: a divisor of the tile's.
std::uint32_t thinning_side(std::uint32_t tile_side) {
  for (const std::uint32_t side : {4U, 5U, 3U, 2U}) {
    if (tile_side % side == 0) return side;
  }
  return 1;
}

/// The frame with one sample of each square, as a program of as many tiles.
kernels::FullProgram thin_program(const Inputs& inputs, const kernels::ProgramSpec& spec, double& thinning) {
  kernels::RenderConfig render = inputs.config.render;
  const auto grid = static_cast<std::uint32_t>(std::lround(std::sqrt(spec.samples)));
  const std::uint32_t side = tile_side(render, spec);
  const std::uint32_t square = thinning_side(side);
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
  kernels::FullProgram program = thin_program(inputs, spec, pilot.thinning);
  std::vector<hw::KernelSchedule> kernels;
  for (const kernels::KernelInfo& kernel : kernels::catalogue()) {
    kernels.push_back(hw::schedule(kernel.graph, inputs.config.gpu.srp));
  }
  const hw::GpuConfig& gpu = inputs.config.gpu;
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
