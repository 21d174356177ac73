#include "tools/sampling/tile_sampling.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "shader_kernels/programs/full.h"
#include "sim/error.h"
#include "sim/hash.h"
#include "sim/host_clock.h"
#include "sim/io/printable.h"
#include "tools/run/frame/machine_run.h"
#include "tools/sampling/pilot.h"
#include "tools/sampling/sample_weights.h"
#include "tools/sampling/sampled_run.h"
#include "tools/sampling/tile_plan.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {
namespace {

constexpr double kRidge = 0.2;
/// Half-width of the systematic error, relative: neighbours other than in the frame, caches not quite warm, totals of
/// the pilot (docs/sampling.md).
constexpr double kModelError = 0.01;
/// Largest share of the frame's work to sample; a frame that needs more is simulated whole.
constexpr double kMostShare = 0.4;

/// Returns the entries of the tile list that blocks need.
std::vector<std::uint32_t> tile_indices_of(std::span<const TimedBlock> blocks) {
  std::vector<std::uint32_t> tile_indices;
  for (const TimedBlock& block : blocks) {
    for (std::uint32_t tile = block.first - block.warming; tile < block.end; ++tile) tile_indices.push_back(tile);
  }
  return tile_indices;
}

SamplePart as_sample(const TileTraits& traits, double cost) {
  SamplePart part{cost, {}};
  for (const auto member : TileTraits::kAll) part.traits.push_back(traits.*member);
  return part;
}

/// Estimates of a frame from runs of its blocks.
struct Estimates {
  MeasuredPart whole;
  Interval time, energy;
  std::map<std::string, Interval> counters;
  /// Larger relative half-width of time and energy.
  double relative_width() const {
    return std::max(time.half_width() / time.estimate, energy.half_width() / energy.estimate);
  }
};

/// Results of a run of all tiles, which are exact.
Estimates known(const SampledRun& run) { return {{run.elapsed, run.units, run.begin.kernels, {}}, {}, {}, {}}; }

/// Returns the interval of an estimate from the values `seen` in the parts.
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
  const TilePilot measure(*inputs.config.gpu, inputs.image.layout, {}, 1, 0);
  std::vector<const MeasuredPart*> parts;
  std::vector<SamplePart> samples;
  std::vector<double> times, energies;
  for (const SampledRun& run : runs) {
    for (const MeasuredPart& part : run.parts) {
      parts.push_back(&part);
      samples.push_back(as_sample(part.traits, measure.cost(part.traits)));
      times.push_back(static_cast<double>(part.time));
      energies.push_back(energy_of(part.units, part.time, inputs.config).total_pj.nominal);
    }
  }
  TileTraits rest;
  for (std::uint32_t tile = plan.begin; tile < plan.end; ++tile) rest.add(pilot.traits[tile]);
  const SampleWeights weights(samples, as_sample(rest, measure.cost(rest)), kRidge);
  Estimates e;
  e.whole = weighted_sum(parts, weights.weights(), runs.front());
  e.time = interval(static_cast<double>(e.whole.time), weights, times);
  e.energy = interval(energy_of(e.whole.units, e.whole.time, inputs.config).total_pj.nominal, weights, energies);
  e.counters = counter_intervals(e.whole, parts, weights);
  return e;
}

/// Copies everything except the picture.
void copy_counts(const FrontEnd::Result& from, FrontEnd::Result& to) {
  to = from;
  to.rgb.clear();
}

/// Blocks are as long as the number of tiles in flight, with which their neighbours overlap.
PlanShape shape_of(const hw::GpuConfig& gpu, std::uint32_t tile_samples) {
  const std::uint32_t in_flight = gpu.cores * gpu.tile_buffer.tiles_in_flight;
  PlanShape shape;
  shape.edge = 2 * in_flight;
  shape.measured = std::max(12U, in_flight);
  shape.lead = std::max(4U, in_flight / 3);
  shape.warming = warming_tiles(gpu, tile_samples);
  return shape;
}

void count_round(const SampledRun& run, SampledFrame& sampled) {
  sampled.rounds += 1;
  sampled.timed += run.timed;
  sampled.warmed += run.warmed;
  sampled.warming_seconds += run.warming_seconds;
  sampled.blocks += run.parts.size();
  for (const MeasuredPart& part : run.parts) sampled.measured += rounded(part.traits.tiles);
}

/// Share of the next round if intervals are `off` times too wide. Limited to twice the share so far, because the
/// estimate of `off` may be poor.
double next_share(double spent, double off) {
  const double share = std::clamp(spent * (off * off - 1), spent / 2, 2 * spent);
  return spent + share > kMostShare ? 1 : share;
}

/// Copies the estimates into the result.
void take(Estimates&& estimates, const Inputs& inputs, const SampledRun& run, SampledFrame& sampled, FrameResult& s) {
  const auto cycles = [&](double time) { return time / static_cast<double>(run.cycle); };
  s.cycles = rounded(cycles(static_cast<double>(estimates.whole.time)));
  s.elapsed = s.cycles * run.cycle;
  s.units = std::move(estimates.whole.units);
  s.kernel_use = std::move(estimates.whole.kernels);
  s.kernels = run.kernels;
  s.energy = energy_of(s.units, s.elapsed, inputs.config);
  sampled.cycles = {static_cast<double>(s.cycles), cycles(estimates.time.chance), cycles(estimates.time.method)};
  sampled.energy_pj = {s.energy.total_pj.nominal, estimates.energy.chance, estimates.energy.method};
  sampled.counters = std::move(estimates.counters);
}

void check_render(const kernels::RenderConfig& render) {
  if (render.primary != kernels::Primary::kRays) {
    throw sim::InputError(
        "--tile-sampling: a rasteriser's geometry pass is no part that tiles stand for; allowed: render.primary=rays");
  }
  if (render.effect_rate != kernels::EffectRate::kFull) {
    throw sim::InputError(
        "--tile-sampling: tiles wait for what effects found in others; allowed: render.effect_rate=full");
  }
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

FrameResult simulate_sampled(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                             const TileSampling& sampling, Progress* progress) {
  check_render(inputs.config.render);
  const sim::HostClock::time_point begin = sim::HostClock::now();
  const traces::BvhTracer tracer(inputs.image);
  const Pilot pilot = look_at_all(inputs, program, tracer, threads, progress);
  const std::uint32_t side = tile_side(inputs.config.render, program);
  const PlanShape shape = shape_of(*inputs.config.gpu, side * side);

  FrameResult s;
  s.program = program;
  s.machine = inputs.config.gpu;
  s.function = scaled(pilot, inputs, program);
  SampledFrame sampled;
  sampled.tiles = pilot.costs.size();
  sampled.asked = sampling.target == 0 ? sampling.share : 0;
  sampled.pilot_seconds = sim::seconds_since(begin);
  double waited = pilot.function.waited, functional = pilot.function.seconds;

  std::vector<SampledRun> runs;
  FormerTiles told;
  Estimates estimates;
  for (double share = sampling.share, spent = 0;;) {
    const TilePlan plan = plan_tiles(pilot.costs, share, shape, sim::hash(inputs.frame, runs.size()));
    const bool picture = sampling.full_image && runs.empty();
    kernels::FullProgram frame(inputs.image, inputs.camera, inputs.config.render, program.samples, inputs.frame);
    const std::vector<std::uint32_t> tile_indices =
        picture ? std::vector<std::uint32_t>{} : tile_indices_of(plan.blocks);
    FrontEnd front_end(frame, tracer, host_threads(threads) - 1, true, tile_indices);
    RunTiles source(front_end, picture ? frame.tiles() : static_cast<std::uint32_t>(tile_indices.size()), progress,
                    false, &told);
    source.begin("simulating", inputs.frame);
    runs.push_back(run_blocks(inputs, source, frame.requirements(), plan.blocks, pilot.traits));
    const SampledRun& run = runs.back();
    const FrontEnd::Result& function = front_end.result();
    waited += function.waited;
    functional += function.seconds;
    count_round(run, sampled);
    if (picture) s.function = function;
    if (plan.all) {
      if (!sampling.full_image) copy_counts(function, s.function);
      sampled.timed = sampled.measured = run.timed;
      sampled.warmed = sampled.blocks = 0;
      estimates = known(run);
      break;
    }
    estimates = estimate(inputs, pilot, plan, runs);
    spent += share;
    const double off = estimates.relative_width() / sampling.target;
    if (sampling.target == 0 || off <= 1) break;
    share = next_share(spent, off);
  }
  told.end(progress);
  s.function.waited = waited;
  s.function.seconds = functional;
  take(std::move(estimates), inputs, runs.front(), sampled, s);
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
