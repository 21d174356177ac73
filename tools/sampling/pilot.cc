#include "tools/sampling/pilot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hw_models/frame/tile_lines.h"
#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/schedule.h"
#include "hw_models/srp/tile_buffer.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/full.h"
#include "shader_kernels/programs/path_program.h"
#include "tools/host/process.h"

namespace tools {
namespace {

/// The pilot render traces one sample per square of samples. The square's side is the first of these numbers that
/// divides the side of a tile.
constexpr std::array kSides = {4U, 5U, 3U, 2U, 1U};
/// Possible sides of the squares of samples in which estimate_costs() traces one sample. The estimate needs less
/// precision than the pilot render.
constexpr std::array kEstimateSides = {8U, 4U, 5U, 3U, 2U, 1U};
/// Least number of samples of a picture that only counts work. Chosen: 512 samples make errors of totals a third
/// larger.
constexpr double kCountedSamples = 2048;
/// Host time of a reflected or refracted ray in addition to its traversal, divided by the host time of a traversal step
/// (docs/slices.md).
constexpr std::uint64_t kStepsOfARay = 15;

/// Returns the program of the pilot render: one sample per square, and the same number of tiles as the frame.
kernels::FullProgram pilot_program(const Inputs& inputs, const kernels::ProgramSpec& spec,
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

kernels::FullProgram make_pilot(const Inputs& inputs, const kernels::ProgramSpec& spec, double& thinning) {
  return pilot_program(inputs, spec, kSides, thinning);
}

std::unique_ptr<kernels::FullProgram> make_counting_pilot(const Inputs& inputs, const kernels::ProgramSpec& spec,
                                                          double& thinning) {
  const double samples = double{1} * inputs.config.render.width * inputs.config.render.height * spec.samples;
  kernels::RenderConfig render = inputs.config.render;
  const auto grid = static_cast<std::uint32_t>(std::lround(std::sqrt(spec.samples)));
  const auto square = static_cast<std::uint32_t>(std::max(1.0, std::sqrt(samples / kCountedSamples)));
  render.width = (render.width * grid + square - 1) / square;
  render.height = (render.height * grid + square - 1) / square;
  render.tile = tile_side(render, spec);
  thinning = samples / (double{1} * render.width * render.height);
  if (spec.kind == kernels::ProgramSpec::Kind::kPath) {
    return std::make_unique<kernels::PathProgram>(inputs.image, inputs.camera, render, inputs.config.programs.path, 1,
                                                  inputs.frame);
  }
  return std::make_unique<kernels::FullProgram>(inputs.image, inputs.camera, render, 1, inputs.frame);
}

std::uint32_t count_tests(const std::uint32_t* walk) {
  std::uint32_t tests = 0;
  for (const std::uint32_t* step = walk; traces::kind_of(*step) != traces::StepKind::kEnd; ++step) {
    if (traces::is_wide(*step)) {
      ++step;  // skips the word of hits
      continue;
    }
    if (traces::kind_of(*step) != traces::StepKind::kLeaf || traces::is_enter(*step)) continue;
    tests += traces::count_of(*step);
    ++step;
  }
  return tests;
}

Pilot survey_tiles(const Inputs& inputs, kernels::FrameProgram& program, double thinning,
                   const kernels::FrameRequirements& requirements, const traces::Tracer& tracer, std::uint32_t threads,
                   Progress* progress) {
  if (progress != nullptr) progress->set_phase("looking at all tiles");
  Pilot pilot;
  pilot.thinning = thinning;
  std::vector<hw::KernelSchedule> kernels;
  for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) {
    kernels.push_back(hw::schedule_kernel(kernel.graph, inputs.config.gpu->srp));
  }
  const hw::GpuConfig& gpu = *inputs.config.gpu;
  const hw::TilesInFlight tiles = hw::tiles_in_flight(gpu.tile_buffer, requirements, gpu.ideal.tile_buffer);
  const hw::TileBuffer buffer(gpu.tile_buffer, requirements, gpu.clocks.srp.clock(), gpu.ideal.tile_buffer);
  TilePilot tile_pilot(gpu, inputs.image.layout, kernels, pilot.thinning,
                       static_cast<double>(buffer.slot_count()) / tiles.first);
  FrontEnd front_end(program, tracer, host_threads(threads) - 1);
  while (const traces::TileWork* work = front_end.next()) {
    if (is_interrupted()) throw Interrupted{};
    pilot.traits.push_back(tile_pilot.measure_tile(*work));
    pilot.costs.push_back(tile_pilot.estimate_cost(pilot.traits.back()));
    front_end.release_work(work);
  }
  pilot.rendered = front_end.result();
  return pilot;
}

std::vector<double> estimate_costs(const Inputs& inputs, const kernels::ProgramSpec& spec, const traces::Tracer& tracer,
                                   std::uint32_t threads) {
  double thinning = 0;
  kernels::FullProgram program = pilot_program(inputs, spec, kEstimateSides, thinning);
  FrontEnd front_end(program, tracer, host_threads(threads) - 1);
  const RenderResult& function = front_end.result();
  std::vector<double> costs;
  double before = 0;
  while (const traces::TileWork* work = front_end.next()) {
    if (is_interrupted()) throw Interrupted{};
    front_end.release_work(work);
    const std::uint64_t sent_on = function.rays[static_cast<std::size_t>(traces::RayKind::kReflection)] +
                                  function.rays[static_cast<std::size_t>(traces::RayKind::kRefraction)];
    const double all = static_cast<double>(function.traversal_steps + kStepsOfARay * sent_on);
    costs.push_back(all - before);
    before = all;
  }
  return costs;
}

RenderResult scale_to_frame(const Pilot& pilot, const Inputs& inputs, const kernels::ProgramSpec& spec) {
  const auto whole = [&](std::uint64_t count) { return round_count(pilot.thinning * static_cast<double>(count)); };
  RenderResult f;
  for (std::size_t k = 0; k < std::size(f.rays); ++k) f.rays[k] = whole(pilot.rendered.rays[k]);
  f.continued = whole(pilot.rendered.continued);
  f.traversal_steps = whole(pilot.rendered.traversal_steps);
  f.sampling.wanted = std::uint64_t{inputs.config.render.width} * inputs.config.render.height * spec.samples;
  f.sampling.traced = f.sampling.wanted;
  f.sampling.background = f.sampling.traced_background = whole(pilot.rendered.sampling.background);
  return f;
}

namespace {

// Latencies in T&I cycles of a tile that is alone on the machine: start of a chunk, transfer of a ray to the T&I unit
// and back, and a step of the longest ray with cache hits.
constexpr double kLaunchCycles = 10, kRayCycles = 20, kStepCycles = 12;

/// Reads a line from a cache and fills it after a miss. Returns true for a hit.
bool access_line(hw::CacheTags& tags, hw::Addr line) {
  if (tags.probe(line)) return true;
  tags.fill_line(line);
  return false;
}

}  // namespace

TilePilot::TilePilot(const hw::GpuConfig& config, const traces::Layout& layout,
                     std::span<const hw::KernelSchedule> kernels, double thinning, double slots)
    : config_(config),
      layout_(layout),
      kernels_(kernels),
      thinning_(thinning),
      slots_(slots),
      srp_cycle_(static_cast<double>(config.clocks.srp.clock().period()) /
                 static_cast<double>(config.clocks.tni.clock().period())),
      l2_(config.l2.cache) {
  for (std::uint32_t c = 0; c < config.cores; ++c) {
    cores_.push_back({std::vector<hw::CacheTags>(config.tni.trvs, hw::CacheTags(config.tni.trv.l1)),
                      hw::CacheTags(config.tni.ist.l1), hw::CacheTags(config.srp.data_cache)});
  }
}

TileTraits TilePilot::measure_tile(const traces::TileWork& work) {
  Core& core = cores_[work.tile % cores_.size()];
  steps_.assign(work.ray_begin.size(), 0);
  std::uint64_t visits = 0, l1_misses = 0, data_misses = 0, l2_misses = 0;
  const auto second_level = [&](hw::Addr line) { l2_misses += !access_line(l2_, line); };
  const std::size_t trvs = core.trvs.size();
  hw::for_each_line_of_tile(
      work, layout_, 0,
      [&](std::uint32_t ray, hw::Addr line) {
        visits += 1;
        steps_[ray] += 1;
        if (access_line(core.trvs[ray % trvs], line)) return;
        l1_misses += 1;
        second_level(line);
      },
      [&](std::uint32_t, hw::Addr line) {
        if (access_line(core.ist, line)) return;
        l1_misses += 1;
        second_level(line);
      },
      [&](hw::Addr line) {
        if (access_line(core.data, line)) return;
        data_misses += 1;
        second_level(line);
      });
  TileTraits t{.tiles = 1,
               .visits = thinning_ * static_cast<double>(visits),
               .l1_misses = thinning_ * static_cast<double>(l1_misses),
               .data_misses = thinning_ * static_cast<double>(data_misses),
               .l2_misses = thinning_ * static_cast<double>(l2_misses)};
  std::uint64_t tests = 0;
  for (std::size_t i = 0; i < work.ray_begin.size(); ++i) {
    const std::uint32_t of_ray = count_tests(&work.walk[work.ray_begin[i]]);
    tests += of_ray;
    steps_[i] += of_ray;
  }
  t.tests = thinning_ * static_cast<double>(tests);
  for (const traces::WorkNode& node : work.nodes) {
    if (node.kind == traces::WorkNode::Kind::kLaunch)
      t.array += thinning_ * static_cast<double>(node.items + node.idle) * kernels_[node.kernel].ii;
  }
  t.spills = spilled_slots(work);
  t.path = critical_path(work);
  return t;
}

double TilePilot::spilled_slots(const traces::TileWork& work) {
  made_.assign(work.nodes.size(), 0);
  for (const traces::WorkNode& node : work.nodes) {
    if (node.kind == traces::WorkNode::Kind::kRays) made_[node.inputs.front().node] += thinning_ * node.items;
  }
  double spilled = 0;
  for (const double rays : made_) spilled += std::max(0.0, rays - slots_);
  return spilled;
}

double TilePilot::critical_path(const traces::TileWork& work) {
  done_.assign(work.nodes.size(), 0);
  double last = 0;
  for (std::size_t n = 0; n < work.nodes.size(); ++n) {
    const traces::WorkNode& node = work.nodes[n];
    double at = 0;
    for (const traces::Edge& edge : node.inputs) at = std::max(at, done_[edge.node]);
    if (node.kind == traces::WorkNode::Kind::kLaunch) {
      const hw::KernelSchedule& kernel = kernels_[node.kernel];
      at += kLaunchCycles + srp_cycle_ * (kernel.depth + thinning_ * (node.items + node.idle) * kernel.ii);
    } else if (node.kind == traces::WorkNode::Kind::kRays) {
      const auto first = steps_.begin() + node.first;
      const std::uint32_t longest = *std::max_element(first, first + node.items);
      double all = 0;
      for (std::uint32_t i = 0; i < node.items; ++i) all += first[i];
      at += kRayCycles + std::max(kStepCycles * longest, thinning_ * all / config_.tni.trvs);
    }
    done_[n] = at;
    last = std::max(last, at);
  }
  return last;
}

double TilePilot::estimate_cost(const TileTraits& t) const {
  const double cores = config_.cores;
  return (0.8 * t.array * srp_cycle_ + 0.9 * t.tests + 0.3 * t.visits / config_.tni.trvs + 0.8 * t.data_misses +
          240 * t.tiles) /
             cores +
         0.15 * t.l2_misses;
}

}  // namespace tools
