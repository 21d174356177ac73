#include "tools/sampling/tile_sampling.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "hw_models/memory/dram_energy.h"
#include "hw_models/srp/schedule.h"
#include "hw_models/srp/tile_buffer.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/full.h"
#include "sim/error.h"
#include "sim/hash.h"
#include "sim/host_clock.h"
#include "sim/io/printable.h"
#include "tools/host/interrupt.h"
#include "tools/sampling/sample_weights.h"
#include "tools/sampling/sampled_run.h"
#include "tools/sampling/tile_plan.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {

namespace {

constexpr double kRidge = 0.2;
/// What blocks cannot tell, as half of a 95 % interval: neighbours that are others than the frame's, caches that are
/// nearly warm, the pilot's totals (docs/sampling.md).
constexpr double kModelError = 0.01;
/// Of the frame's work; a frame of which more would have to be measured is timed whole.
constexpr double kMostShare = 0.4;
/// Bytes of caches for each sample of the tiles that warm them before a block: of the L2, and of all first-level
/// caches. The usual machine comes to eight of its tiles by either.
constexpr std::uint64_t kSecondLevelBytes = 128, kFirstLevelBytes = 224;

std::uint64_t rounded(double x) { return static_cast<std::uint64_t>(std::llround(x)); }

/// A thin picture, all of whose tiles are looked at: one of `thinning` samples of each of the frame's.
struct Pilot {
  std::vector<TileTraits> traits;  ///< of the frame's tiles
  std::vector<double> costs;
  double thinning = 1;
  FrontEnd::Result function;
};

/// Side of the squares of samples of which one is traced: a divisor of the tile's.
std::uint32_t thinning_side(std::uint32_t tile_side) {
  for (const std::uint32_t side : {4U, 5U, 3U, 2U}) {
    if (tile_side % side == 0) return side;
  }
  return 1;
}

/// In samples.
std::uint32_t tile_side(const kernels::RenderConfig& render, const kernels::ProgramSpec& spec) {
  const auto grid = static_cast<std::uint32_t>(std::lround(std::sqrt(spec.samples)));
  return std::max(1U, render.tile / grid) * grid;
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
  const hw::TileBuffer buffer(gpu.tile_buffer, requirements.tile_samples, requirements.attribute_bytes,
                              gpu.clocks.srp.clock(), gpu.ideal.tile_buffer);
  TilePilot look(gpu, inputs.image.layout, kernels, pilot.thinning, static_cast<double>(buffer.slots()));
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

/// What the frame's function would have come to, from the pilot's.
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

/// Entries of the frame's list that blocks need.
std::vector<std::uint32_t> places_of(std::span<const TimedBlock> blocks) {
  std::vector<std::uint32_t> places;
  for (const TimedBlock& block : blocks) {
    for (std::uint32_t tile = block.first - block.warming; tile < block.end; ++tile) places.push_back(tile);
  }
  return places;
}

SamplePart as_sample(const TileTraits& traits, double cost) {
  SamplePart part{cost, {}};
  for (const auto member : TileTraits::kAll) part.traits.push_back(traits.*member);
  return part;
}

sim::EnergyReport energy_of(const Inputs& inputs, std::span<const sim::UnitReport> units, sim::Time time) {
  return sim::compute_energy(units, inputs.config.energy, hw::dram_energy_events(inputs.config.gpu.dram), time);
}

/// What a frame comes to, by the runs of its blocks.
struct Estimates {
  MeasuredPart whole;
  Interval time, energy;
  std::map<std::string, Interval> counters;
  /// The larger of the first two, as a part of its estimate.
  double relative_width() const {
    return std::max(time.half_width() / time.estimate, energy.half_width() / energy.estimate);
  }
};

/// Of a run of all tiles.
Estimates known(const SampledRun& run) { return {{run.elapsed, run.units, run.begin.kernels, {}}, {}, {}, {}}; }

/// Of what parts of a frame were seen to take, one by one.
Interval interval(double estimate, const SampleWeights& weights, std::span<const double> seen) {
  return {estimate, weights.half_width(seen), kModelError * estimate};
}

std::map<std::string, Interval> counter_intervals(const MeasuredPart& whole, std::span<const MeasuredPart* const> parts,
                                                  const SampleWeights& weights) {
  std::map<std::string, std::vector<double>> seen;
  for (const MeasuredPart* part : parts) {
    for (const auto& [path, value] : summed_counters(part->units)) seen[path].push_back(value);
  }
  std::map<std::string, Interval> intervals;
  for (const auto& [path, estimate] : summed_counters(whole.units)) {
    intervals[path] = interval(estimate, weights, seen.at(path));
  }
  return intervals;
}

Estimates estimate(const Inputs& inputs, const Pilot& pilot, const TilePlan& plan, std::span<const SampledRun> runs) {
  const TilePilot measure(inputs.config.gpu, inputs.image.layout, {}, 1, 0);
  std::vector<const MeasuredPart*> parts;
  std::vector<SamplePart> samples;
  std::vector<double> times, energies;
  for (const SampledRun& run : runs) {
    for (const MeasuredPart& part : run.parts) {
      parts.push_back(&part);
      samples.push_back(as_sample(part.traits, measure.cost(part.traits)));
      times.push_back(static_cast<double>(part.time));
      energies.push_back(energy_of(inputs, part.units, part.time).total_pj.nominal);
    }
  }
  TileTraits rest;
  for (std::uint32_t tile = plan.begin; tile < plan.end; ++tile) rest.add(pilot.traits[tile]);
  const SampleWeights weights(samples, as_sample(rest, measure.cost(rest)), kRidge);
  Estimates e;
  e.whole = weighted_sum(parts, weights.weights(), runs.front());
  e.time = interval(static_cast<double>(e.whole.time), weights, times);
  e.energy = interval(energy_of(inputs, e.whole.units, e.whole.time).total_pj.nominal, weights, energies);
  e.counters = counter_intervals(e.whole, parts, weights);
  return e;
}

/// All but the picture.
void copy_counts(const FrontEnd::Result& from, FrontEnd::Result& to) {
  to = from;
  to.rgb.clear();
}

/// Blocks overlap the neighbours of as many tiles as are in flight, so they are as long.
PlanShape shape_of(const hw::GpuConfig& gpu, std::uint32_t tile_samples) {
  const std::uint32_t in_flight = gpu.cores * gpu.tile_buffer.tiles_in_flight;
  PlanShape shape;
  shape.edge = 2 * in_flight;
  shape.measured = std::max(12U, in_flight);
  shape.lead = std::max(4U, in_flight / 3);
  const std::uint64_t first_level = gpu.cores * (gpu.tni.trvs * gpu.tni.trv.l1.size.bytes + gpu.tni.ist.l1.size.bytes +
                                                 gpu.srp.data_cache.size.bytes);
  const std::uint64_t samples = std::max(gpu.l2.cache.size.bytes / kSecondLevelBytes, first_level / kFirstLevelBytes);
  shape.warming = std::max(shape.warming, static_cast<std::uint32_t>(samples / tile_samples));
  return shape;
}

}  // namespace

TileSampling parse_tile_sampling(const std::string& sampling, const std::string& image) {
  TileSampling s;
  s.full_image = image != "none";
  if (sampling == "auto") {
    s.share = 0.03;
    s.target = 0.02;
    return s;
  }
  double percent = 0;
  const char* end = sampling.data() + sampling.size();
  const auto [rest, bad] = std::from_chars(sampling.data(), end, percent);
  if (bad != std::errc{} || rest + 1 != end || *rest != '%' || !(percent >= 0.1 && percent <= 100)) {
    throw sim::InputError(fmt::format("--tile-sampling '{}' is neither a share from 0.1% to 100%, e.g. 5%, nor auto",
                                      sim::printable(sampling)));
  }
  s.share = percent / 100;
  return s;
}

void check_tile_sampling(const kernels::ProgramSpec& program) {
  if (program.kind == kernels::ProgramSpec::Kind::kFull) return;
  throw sim::InputError(fmt::format(
      "--tile-sampling: tiles of {} trace what their neighbours' samples call for, which neither single tiles nor a "
      "thin picture can tell; allowed: full:N",
      program.name()));
}

Simulation simulate_sampled(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                            const TileSampling& sampling, Progress* progress) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  const traces::BvhTracer tracer(inputs.image);
  const Pilot pilot = look_at_all(inputs, program, tracer, threads, progress);
  const std::uint32_t side = tile_side(inputs.config.render, program);
  const PlanShape shape = shape_of(inputs.config.gpu, side * side);

  Simulation s;
  s.program = program;
  s.machine = inputs.config.gpu;
  s.function = scaled(pilot, inputs, program);
  SampledFrame sampled;
  sampled.tiles = pilot.costs.size();
  sampled.pilot_seconds = sim::seconds_since(begin);
  double waited = pilot.function.waited, functional = pilot.function.seconds;

  std::vector<SampledRun> runs;
  FormerTiles told;
  Estimates estimates;
  for (double share = sampling.share, spent = 0;;) {
    const TilePlan plan = plan_tiles(pilot.costs, share, shape, sim::hash(inputs.frame, runs.size()));
    const bool picture = sampling.full_image && runs.empty();
    kernels::FullProgram frame(inputs.image, inputs.camera, inputs.config.render, program.samples, inputs.frame);
    const std::vector<std::uint32_t> places = picture ? std::vector<std::uint32_t>{} : places_of(plan.blocks);
    FrontEnd front_end(frame, tracer, host_threads(threads) - 1, true, places);
    ProgressTileSource source(front_end, picture ? frame.tiles() : static_cast<std::uint32_t>(places.size()), progress,
                              false, &told);
    source.begin("simulating", inputs.frame);
    runs.push_back(run_blocks(inputs, source, frame.requirements(), plan.blocks, pilot.traits));
    const SampledRun& run = runs.back();
    const FrontEnd::Result& function = front_end.result();
    waited += function.waited;
    functional += function.seconds;
    sampled.rounds += 1;
    sampled.timed += run.timed;
    sampled.warmed += run.warmed;
    sampled.warming_seconds += run.warming_seconds;
    if (picture) s.function = function;
    if (plan.all) {
      if (!sampling.full_image) copy_counts(function, s.function);
      sampled.timed = sampled.measured = run.timed;
      sampled.warmed = sampled.blocks = 0;
      estimates = known(run);
      break;
    }
    sampled.blocks += run.parts.size();
    for (const MeasuredPart& part : run.parts) sampled.measured += rounded(part.traits.tiles);
    estimates = estimate(inputs, pilot, plan, runs);
    spent += share;
    const double off = estimates.relative_width() / sampling.target;
    if (sampling.target == 0 || off <= 1) break;
    // As many blocks more as should do, but not so many that they rest on a bad guess.
    share = std::clamp(spent * (off * off - 1), spent / 2, 2 * spent);
    if (spent + share > kMostShare) share = 1;
  }
  told.end(progress);
  const sim::Time cycle = runs.front().cycle;
  const auto cycles = [&](double time) { return time / static_cast<double>(cycle); };
  s.cycles = rounded(cycles(static_cast<double>(estimates.whole.time)));
  s.elapsed = s.cycles * cycle;
  s.units = std::move(estimates.whole.units);
  s.kernel_use = std::move(estimates.whole.kernels);
  s.kernels = runs.front().kernels;
  s.energy = energy_of(inputs, s.units, s.elapsed);
  s.function.waited = waited;
  s.function.seconds = functional;
  sampled.cycles = {static_cast<double>(s.cycles), cycles(estimates.time.chance), cycles(estimates.time.method)};
  sampled.energy_pj = {s.energy.total_pj.nominal, estimates.energy.chance, estimates.energy.method};
  sampled.counters = std::move(estimates.counters);
  s.sampled = sampled;
  s.wall_seconds = sim::seconds_since(begin);
  return s;
}

void Interval::add(const Interval& other) {
  estimate += other.estimate;
  chance = std::hypot(chance, other.chance);
  method += other.method;
}

void SampledFrame::add(const SampledFrame& other) {
  tiles += other.tiles;
  timed += other.timed;
  measured += other.measured;
  warmed += other.warmed;
  blocks += other.blocks;
  rounds += other.rounds;
  cycles.add(other.cycles);
  energy_pj.add(other.energy_pj);
  for (const auto& [path, interval] : other.counters) counters[path].add(interval);
  pilot_seconds += other.pilot_seconds;
  warming_seconds += other.warming_seconds;
}

}  // namespace tools
