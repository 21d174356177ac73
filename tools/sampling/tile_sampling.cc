#include "tools/sampling/tile_sampling.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "shader_kernels/programs/full.h"
#include "sim/error.h"
#include "sim/hash.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "tools/analysis/report_file.h"
#include "tools/analysis/units.h"
#include "tools/noise/noise.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/trace_header.h"
#include "tools/sampling/pilot.h"
#include "tools/sampling/timed_tiles.h"
#include "tools/sampling/weighted_sum.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/trace_file/trace_writer.h"
#include "traces/trace_file/tree_links.h"

namespace tools {
namespace {

/// Activity of the machine in the measured part of a block of tiles, which follows the tiles that only fill the
/// machine.
struct MeasuredPart {
  sim::Time time = 0;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernels;
  TileTraits traits;  ///< traits of the work in the measured part
};

/// Results of simulating some blocks of tiles on one machine.
struct SampledRun {
  /// Measured parts of the first and the last block. They are the start and end of the frame, which are not
  /// extrapolated.
  MeasuredPart begin, end;
  std::vector<MeasuredPart> parts;
  std::vector<sim::UnitReport> units;  ///< reports of the units after the whole run
  std::vector<hw::KernelSchedule> kernels;
  sim::Time elapsed = 0;
  sim::Time cycle = 0;  ///< period of the T&I clock
  std::uint64_t timed = 0, warmed = 0;
  double warming_seconds = 0;
};

/// Returns the increase of a machine's time and counters between the dispatches of two tiles.
MeasuredPart difference_of(const Mark& a, const Mark& b) {
  MeasuredPart part{b.time - a.time, b.units, b.kernels, {}};
  sim::subtract_reports(part.units, a.units);
  for (std::size_t k = 0; k < part.kernels.size(); ++k) part.kernels[k] -= a.kernels[k];
  return part;
}

/// Returns the traits of the work in the measured part of a block. Traits that the machine counts are exact; others are
/// sums over the tiles in flight, weighted by the share of each tile's time within the part.
TileTraits traits_of(const MeasuredPart& part, sim::Time begin, sim::Time end, const TimedTiles& tiles,
                     std::span<const TileTraits> traits, std::span<const hw::KernelSchedule> kernels) {
  TileTraits sum;
  for (const TimedTiles::TimedTile& tile : tiles.simulated_tiles()) {
    const sim::Time from = std::max(tile.begin, begin), to = std::min(tile.end, end);
    if (from < to)
      sum.add(traits[tile.tile], static_cast<double>(to - from) / static_cast<double>(tile.end - tile.begin));
  }
  const Units<hw::Trv> trvs(part.units);
  sum.visits =
      static_cast<double>(trvs.sum_of(&hw::Trv::Stats::visits) - trvs.sum_of(&hw::Trv::Stats::restarted_visits));
  sum.tests = static_cast<double>(Units<hw::Ist>(part.units).sum_of(&hw::Ist::Stats::tests));
  sum.array = 0;
  for (std::size_t k = 0; k < kernels.size(); ++k)
    sum.array += static_cast<double>(part.kernels[k].items) * kernels[k].ii;
  return sum;
}

/// Simulates blocks of a frame. `traits`: traits of each tile from the pilot. `warm`: called with the machine before
/// its first cycle, if set.
SampledRun run_blocks(const Inputs& inputs, RunTiles& source, const kernels::FrameRequirements& requirements,
                      std::span<const TimedBlock> blocks, std::span<const TileTraits> traits,
                      const std::function<void(hw::Gpu&)>& warm) {
  std::vector<std::uint32_t> marked;
  for (const TimedBlock& block : blocks) {
    if (block.first != blocks.front().first) marked.push_back(block.first);
    if (marked.empty() || block.measured != marked.back()) marked.push_back(block.measured);
  }
  TimedTiles tiles(source, {blocks.begin(), blocks.end()}, std::move(marked));
  const auto gpu = make_gpu(inputs, requirements, tiles);
  tiles.set_gpu(*gpu);
  source.set_gpu(*gpu);
  if (warm) warm(*gpu);
  run_to_end(*gpu);
  tiles.finish_tile_times();

  SampledRun run;
  run.units = gpu->unit_reports();
  run.kernels = gpu->kernel_schedules();
  run.elapsed = gpu->elapsed_time();
  run.cycle = gpu->elapsed_time() / gpu->elapsed_cycles();
  run.timed = tiles.simulated_tiles().size();
  run.warmed = tiles.warmed_tiles();
  run.warming_seconds = tiles.warming_seconds();
  // A measured part ends at the dispatch of the next block; the last one ends with the run.
  const Mark finished{0, gpu->elapsed_time(), gpu->unit_reports(), gpu->kernel_use()};
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const bool is_last = i + 1 == blocks.size();
    const Mark &begin = tiles.snapshot_at(blocks[i].measured),
               &end = is_last ? finished : tiles.snapshot_at(blocks[i + 1].first);
    MeasuredPart part = difference_of(begin, end);
    part.traits = traits_of(part, begin.time, end.time, tiles, traits, run.kernels);
    if (i == 0) {
      run.begin = std::move(part);
    } else if (is_last) {
      run.end = std::move(part);
    } else {
      run.parts.push_back(std::move(part));
    }
  }
  return run;
}

/// Returns the weighted sum of times and counters over the measured parts of blocks; a counter that records a peak gets
/// the maximum over all simulated parts.
MeasuredPart weighted_sum(std::span<const MeasuredPart* const> parts, std::span<const double> part_weights,
                          const SampledRun& run) {
  std::vector<Activity> activities = {{run.begin.units, run.begin.kernels}, {run.end.units, run.end.kernels}};
  std::vector<double> weights = {1, 1};
  double time = static_cast<double>(run.begin.time) + static_cast<double>(run.end.time);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    activities.push_back({parts[k]->units, parts[k]->kernels});
    weights.push_back(part_weights[k]);
    time += part_weights[k] * static_cast<double>(parts[k]->time);
  }
  MeasuredPart whole;
  whole.time = round_count(std::max(0.0, time));
  whole.units = run.units;
  const double longer = static_cast<double>(whole.time) / static_cast<double>(run.elapsed);
  for (sim::UnitReport& unit : whole.units) unit.elapsed = round_count(longer * static_cast<double>(unit.elapsed));
  set_weighted_units(whole.units, activities, weights);
  whole.kernels = weighted_kernels(activities, weights);
  return whole;
}

}  // namespace

std::map<std::string, double> summed_counters(std::vector<sim::UnitReport> units) {
  for (sim::UnitReport& unit : units) {
    std::erase_if(unit.counters, [](const sim::CounterReport& c) { return c.kind == sim::CounterKind::kPeak; });
  }
  constexpr std::string_view kUnits = "units.";
  std::map<std::string, double> sums;
  for (const ReportNumber& number : unit_sums({{"units", sim::units_json(units)}})) {
    if (number.path.find(".counters.") != std::string::npos) sums[number.path.substr(kUnits.size())] = number.value;
  }
  return sums;
}

namespace {

using Eigen::Index;

Eigen::Map<const Eigen::VectorXd> as_vector(std::span<const double> values) {
  return {values.data(), static_cast<Index>(values.size())};
}

/// Traits of the measured blocks of tiles and of the whole frame, divided by their sizes and standardised over the
/// blocks. Traits that are equal in all blocks become 0.
struct StandardisedTraits {
  Eigen::MatrixXd parts;  ///< one row per measured block
  Eigen::VectorXd whole;
};

StandardisedTraits standardise_traits(std::span<const SamplePart> parts, const SamplePart& whole) {
  const auto n = static_cast<Index>(parts.size()), p = static_cast<Index>(whole.traits.size());
  StandardisedTraits traits{Eigen::MatrixXd::Zero(n, p), Eigen::VectorXd::Zero(p)};
  for (std::size_t j = 0; j < whole.traits.size(); ++j) {
    Eigen::VectorXd rates(n);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      rates[static_cast<Index>(i)] = parts[i].traits[j] / parts[i].size;
    }
    const double mean = rates.mean();
    rates.array() -= mean;
    const double spread = std::sqrt(rates.squaredNorm() / static_cast<double>(n));
    if (!(spread > 1e-9 * std::abs(mean))) continue;
    traits.parts.col(static_cast<Index>(j)) = rates / spread;
    traits.whole[static_cast<Index>(j)] = (whole.traits[j] / whole.size - mean) / spread;
  }
  return traits;
}

}  // namespace

SampleWeights::SampleWeights(std::span<const SamplePart> parts, const SamplePart& whole, double ridge) {
  const auto count = static_cast<double>(parts.size());
  for (const SamplePart& part : parts) sizes_.push_back(part.size);
  const StandardisedTraits z = standardise_traits(parts, whole);
  Eigen::MatrixXd normal = z.parts.transpose() * z.parts;
  normal.diagonal().array() += count * std::max(ridge, 1e-9);
  const Eigen::MatrixXd solved = normal.llt().solve(z.parts.transpose());
  const Eigen::MatrixXd smoother = (z.parts * solved).array() + 1 / count;
  const Eigen::VectorXd shares = whole.size * ((solved.transpose() * z.whole).array() + 1 / count);
  smoother_.assign(smoother.data(), smoother.data() + smoother.size());
  shares_.assign(shares.begin(), shares.end());
  for (std::size_t i = 0; i < parts.size(); ++i) weights_.push_back(shares_[i] / sizes_[i]);
  degrees_ = std::max(1.0, count - smoother.trace());
}

double SampleWeights::total(std::span<const double> observed) const {
  return as_vector(weights_).dot(as_vector(observed));
}

double SampleWeights::half_width(std::span<const double> observed) const {
  const Eigen::VectorXd rates = as_vector(observed).cwiseQuotient(as_vector(sizes_));
  const Eigen::Map<const Eigen::MatrixXd> smoother(smoother_.data(), rates.size(), rates.size());
  const double left = (rates - smoother * rates).squaredNorm();
  return student_t_quantile(degrees_) * std::sqrt(left / degrees_ * as_vector(shares_).squaredNorm());
}

namespace {

constexpr double kRidge = 0.2;
/// Relative half-width of the systematic error of sampling. Causes: other neighbouring tiles than in the frame, caches
/// that are not quite warm, errors of the pilot's totals (docs/sampling.md).
constexpr double kModelError = 0.01;
/// Largest share of the frame's work to sample; a frame that needs more is simulated whole.
constexpr double kMostShare = 0.4;

/// Returns the entries of the tile list that blocks need, including the tiles that warm their caches.
std::vector<std::uint32_t> tile_indices_of(std::span<const TimedBlock> blocks) {
  std::vector<std::uint32_t> tile_indices;
  for (const TimedBlock& block : blocks) {
    for (std::uint32_t tile = block.first - block.warming; tile < block.end; ++tile) tile_indices.push_back(tile);
  }
  return tile_indices;
}

SamplePart to_sample_part(const TileTraits& traits, double cost) {
  SamplePart part{cost, {}};
  for (const auto member : TileTraits::kAll) part.traits.push_back(traits.*member);
  return part;
}

/// Time, energy and counters of a whole frame, estimated from simulations of some blocks of its tiles.
struct Estimates {
  MeasuredPart whole;
  Interval time, energy;
  std::map<std::string, Interval> counters;
  /// Returns the larger of the relative half-widths of time and energy.
  double relative_width() const {
    return std::max(time.half_width() / time.estimate, energy.half_width() / energy.estimate);
  }
};

/// Returns the results of a run in which all tiles were simulated. They have no sampling error.
Estimates exact_estimates(const SampledRun& run) {
  return {{run.elapsed, run.units, run.begin.kernels, {}}, {}, {}, {}};
}

/// Returns `estimate` with its 95 % interval, computed from the values `seen` in the measured parts of blocks.
Interval interval_around(double estimate, const SampleWeights& weights, std::span<const double> seen) {
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
    intervals[path] = interval_around(estimate, weights, seen.at(path));
  }
  return intervals;
}

Estimates estimate_frame(const Inputs& inputs, const Pilot& pilot, const TilePlan& plan,
                         std::span<const SampledRun> runs) {
  const TilePilot measure(*inputs.config.gpu, inputs.image.layout, {}, 1, 0);
  std::vector<const MeasuredPart*> parts;
  std::vector<SamplePart> samples;
  std::vector<double> times, energies;
  for (const SampledRun& run : runs) {
    for (const MeasuredPart& part : run.parts) {
      parts.push_back(&part);
      samples.push_back(to_sample_part(part.traits, measure.estimate_cost(part.traits)));
      times.push_back(static_cast<double>(part.time));
      energies.push_back(energy_of(part.units, part.time, inputs.config).total_pj.nominal);
    }
  }
  TileTraits rest;
  for (std::uint32_t tile = plan.begin; tile < plan.end; ++tile) rest.add(pilot.traits[tile]);
  const SampleWeights weights(samples, to_sample_part(rest, measure.estimate_cost(rest)), kRidge);
  Estimates e;
  e.whole = weighted_sum(parts, weights.part_weights(), runs.front());
  e.time = interval_around(static_cast<double>(e.whole.time), weights, times);
  e.energy = interval_around(energy_of(e.whole.units, e.whole.time, inputs.config).total_pj.nominal, weights, energies);
  e.counters = counter_intervals(e.whole, parts, weights);
  return e;
}

/// Copies all members of a render result except its picture.
void copy_counts(const RenderResult& from, RenderResult& to) {
  to = from;
  to.rgb.clear();
}

/// Returns the lengths of blocks for a machine. The measured part of a block has as many tiles as the machine has in
/// flight, at least 12.
PlanShape choose_block_lengths(const hw::GpuConfig& gpu, std::uint32_t tile_samples) {
  const std::uint32_t in_flight = gpu.cores * gpu.tile_buffer.tiles_in_flight;
  PlanShape shape;
  shape.edge = 2 * in_flight;
  shape.measured = std::max(12U, in_flight);
  shape.lead = std::max(4U, in_flight / 3);
  shape.warming = warming_tiles(gpu, tile_samples);
  return shape;
}

void add_round_counts(const SampledRun& run, SampledFrame& sampled) {
  sampled.rounds += 1;
  sampled.timed += run.timed;
  sampled.warmed += run.warmed;
  sampled.warming_seconds += run.warming_seconds;
  sampled.blocks += run.parts.size();
  for (const MeasuredPart& part : run.parts) sampled.measured += round_count(part.traits.tiles);
}

/// Returns the share of the frame's work to simulate in the next round if confidence intervals are `off` times too
/// wide. The share is at most twice the share `spent` so far, because `off` is a rough estimate.
double next_round_share(double spent, double off) {
  const double share = std::clamp(spent * (off * off - 1), spent / 2, 2 * spent);
  return spent + share > kMostShare ? 1 : share;
}

/// Copies the estimates of a frame into its result.
void set_estimates(Estimates&& estimates, const Inputs& inputs, const SampledRun& run, SampledFrame& sampled,
                   FrameResult& s) {
  const auto cycles = [&](double time) { return time / static_cast<double>(run.cycle); };
  s.cycles = round_count(cycles(static_cast<double>(estimates.whole.time)));
  s.elapsed = s.cycles * run.cycle;
  s.units = std::move(estimates.whole.units);
  s.kernel_use = std::move(estimates.whole.kernels);
  s.kernels = run.kernels;
  s.energy = energy_of(s.units, s.elapsed, inputs.config);
  sampled.cycles = {static_cast<double>(s.cycles), cycles(estimates.time.random), cycles(estimates.time.systematic)};
  sampled.energy_pj = {s.energy.total_pj.nominal, estimates.energy.random, estimates.energy.systematic};
  sampled.counters = std::move(estimates.counters);
}

void check_programs(const RunConfig& config) {
  const kernels::RenderConfig& render = config.render;
  if (config.programs.denoise.filter != kernels::DenoiseFilter::kOff) {
    throw sim::InputError("--tile-sampling: a denoiser reads all tiles; allowed: denoise.filter=off");
  }
  if (config.build.engine != traces::BuildEngine::kHost) {
    throw sim::InputError(
        "--tile-sampling: building trees is no part that tiles stand for; allowed: build.engine=host");
  }
  if (render.primary != kernels::Primary::kRays) {
    throw sim::InputError(
        "--tile-sampling: a rasteriser's geometry pass is no part that tiles stand for; allowed: render.primary=rays");
  }
  if (render.effect_rate != kernels::EffectRate::kFull) {
    throw sim::InputError(
        "--tile-sampling: tiles wait for what effects found in others; allowed: render.effect_rate=full");
  }
  if (config.gpu->tni.predictor.enabled) {
    throw sim::InputError("--tile-sampling: a predictor learns from all tiles; allowed: tni.predictor.enabled=false");
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

double simulated_share(const RunConfig& config, const kernels::ProgramSpec& program, const TileSampling& sampling) {
  const std::uint32_t side = tile_side(config.render, program);
  const PlanShape shape = choose_block_lengths(*config.gpu, side * side);
  const double samples = double{1} * config.render.width * config.render.height * program.samples;
  const double tiles = samples / (double{1} * side * side);
  const double blocks = std::max<double>(shape.least, sampling.share * tiles / shape.measured);
  return std::min(1.0, (2 * shape.edge + blocks * (shape.lead + shape.measured)) / tiles);
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
  check_programs(inputs.config);
  const traces::BvhTracer tracer(inputs.image);
  double thinning = 1;
  kernels::FullProgram pilot = make_pilot(inputs, program, thinning);
  const auto make_frame = [&]() -> std::unique_ptr<kernels::FrameProgram> {
    return std::make_unique<kernels::FullProgram>(inputs.image, inputs.camera, inputs.config.render, program.samples,
                                                  inputs.frame);
  };
  return simulate_sampled(inputs, program, {make_frame, pilot, thinning, tracer}, threads, sampling, progress);
}

FrameResult simulate_sampled(const Inputs& inputs, const kernels::ProgramSpec& program, const SampledWork& work,
                             std::uint32_t threads, const TileSampling& sampling, Progress* progress) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  const traces::Tracer& tracer = work.tracer;
  const Pilot pilot =
      survey_tiles(inputs, work.pilot, work.thinning, work.make_frame()->requirements(), tracer, threads, progress);
  const std::uint32_t side = tile_side(inputs.config.render, program);
  const PlanShape shape = choose_block_lengths(*inputs.config.gpu, side * side);

  FrameResult s;
  s.program = program;
  s.machine = inputs.config.gpu;
  s.rendered = scale_to_frame(pilot, inputs, program);
  SampledFrame sampled;
  sampled.tiles = pilot.costs.size();
  sampled.asked = sampling.target == 0 ? sampling.share : 0;
  sampled.pilot_seconds = sim::seconds_since(begin);
  double waited = pilot.rendered.waited, functional = pilot.rendered.seconds;

  std::vector<SampledRun> runs;
  ProgressBase reported;
  Estimates estimates;
  for (double share = sampling.share, spent = 0;;) {
    const TilePlan plan = plan_tiles(pilot.costs, share, shape, sim::hash(inputs.frame, runs.size()));
    const bool picture = sampling.full_image && runs.empty();
    const std::unique_ptr<kernels::FrameProgram> made = work.make_frame();
    kernels::FrameProgram& frame = *made;
    const std::vector<std::uint32_t> tile_indices =
        picture ? std::vector<std::uint32_t>{} : tile_indices_of(plan.blocks);
    FrontEnd front_end(frame, tracer, host_threads(threads) - 1, true, tile_indices);
    RunTiles source(front_end, picture ? frame.tiles() : static_cast<std::uint32_t>(tile_indices.size()), progress,
                    false, &reported);
    source.begin_part("simulating", inputs.frame);
    std::function<void(hw::Gpu&)> warm;
    if (inputs.config.frame.start == FrameStart::kWarm) {
      warm = [&](hw::Gpu& gpu) { warm_with_last_tiles(gpu, frame, tracer, host_threads(threads) - 1); };
    }
    runs.push_back(run_blocks(inputs, source, frame.requirements(), plan.blocks, pilot.traits, warm));
    const SampledRun& run = runs.back();
    const RenderResult& function = front_end.result();
    waited += function.waited;
    functional += function.seconds;
    add_round_counts(run, sampled);
    if (picture) s.rendered = function;
    if (plan.all) {
      if (!sampling.full_image) copy_counts(function, s.rendered);
      sampled.timed = sampled.measured = run.timed;
      sampled.warmed = sampled.blocks = 0;
      estimates = exact_estimates(run);
      break;
    }
    estimates = estimate_frame(inputs, pilot, plan, runs);
    spent += share;
    const double off = estimates.relative_width() / sampling.target;
    if (sampling.target == 0 || off <= 1) break;
    share = next_round_share(spent, off);
  }
  reported.report_to(progress);
  s.rendered.waited = waited;
  s.rendered.seconds = functional;
  set_estimates(std::move(estimates), inputs, runs.front(), sampled, s);
  s.sampled = sampled;
  s.wall_seconds = sim::seconds_since(begin);
  return s;
}

void record_sampled_work(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                         traces::TraceWriter& trace) {
  check_programs(inputs.config);
  const traces::BvhTracer tracer(inputs.image);
  render_frame(inputs, program, tracer, threads, {.trace = &trace});
  double thinning = 1;
  kernels::FullProgram pilot = make_pilot(inputs, program, thinning);
  FrontEnd front_end(pilot, tracer, host_threads(threads));
  RunTiles tiles(front_end, pilot.tiles(), nullptr);
  trace.begin_part({.frame = inputs.frame, .pilot = true}, traces::links_of(inputs.image),
                   traces::counts_of(inputs.image), pilot.requirements());
  tiles.set_recorders(&trace, nullptr);
  while (const traces::TileWork* tile = tiles.next()) tiles.release_work(tile);
  sim::Json result = recorded_result(front_end.result());
  result["thinning"] = thinning;
  trace.end_part(std::move(result));
  trace.end_frame(recorded_frame(inputs.frame, {}));
}

void Interval::add_estimate(const Interval& other) {
  estimate += other.estimate;
  random = std::hypot(random, other.random);
  systematic += other.systematic;
}

void SampledFrame::add(const SampledFrame& other) {
  tiles += other.tiles;
  timed += other.timed;
  measured += other.measured;
  warmed += other.warmed;
  blocks += other.blocks;
  rounds += other.rounds;
  cycles.add_estimate(other.cycles);
  energy_pj.add_estimate(other.energy_pj);
  for (const auto& [path, interval] : other.counters) counters[path].add_estimate(interval);
  pilot_seconds += other.pilot_seconds;
  warming_seconds += other.warming_seconds;
}

}  // namespace tools
