#include "tools/run/representative_frames.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "sim/error.h"
#include "tools/host/process.h"
#include "tools/run/frame/machine_run.h"
#include "tools/sampling/frame_counts.h"
#include "tools/sampling/pilot.h"
#include "tools/sampling/tile_sampling.h"
#include "tools/sampling/weighted_sum.h"

namespace tools {
namespace {

/// Relative half-width of the intervals of cycles and energy below which --representative auto adds no more frames.
constexpr double kTargetWidth = 0.03;
/// Relative half-width of an interval that has rounding errors only.
constexpr double kExactWidth = 1e-9;
/// Least number of frames to simulate, unless frames of a cluster are equal. Chosen: intervals of fewer may be too
/// narrow by chance.
constexpr std::size_t kLeastFrames = 12;
/// Largest share of the frames to simulate; a sequence that needs more is simulated whole.
constexpr double kMostFramesShare = 0.4;

void check_sequence(const Inputs& inputs) {
  if (inputs.frames() < 2) {
    throw sim::InputError("--representative: one frame represents no others; allowed: several frames, --frames A:B");
  }
  if (inputs.config.render.primary != kernels::Primary::kRays) {
    throw sim::InputError("--representative: the work of a rasteriser is not counted; allowed: render.primary=rays");
  }
  if (inputs.config.render.effect_rate != kernels::EffectRate::kFull) {
    throw sim::InputError(
        "--representative: effects of a reduced rate are not counted; allowed: render.effect_rate=full");
  }
  if (inputs.config.programs.denoise.filter != kernels::DenoiseFilter::kOff) {
    throw sim::InputError("--representative: the denoiser needs every frame; allowed: denoise.filter=off");
  }
  const traces::BuildPolicy policy = inputs.config.build.policy;
  if (policy == traces::BuildPolicy::kPeriod || policy == traces::BuildPolicy::kCost) {
    throw sim::InputError(
        "--representative: trees of this build.policy depend on earlier frames; allowed: update, refit, rebuild");
  }
  if (inputs.config.thermal.minutes > 0) {
    throw sim::InputError("--representative: the governor needs every frame; allowed: thermal.minutes=0");
  }
}

/// Checks the inputs, then counts the work of all frames.
std::vector<FrameCounts> count_checked_frames(Inputs& inputs, const kernels::ProgramSpec& program,
                                              std::uint32_t threads, Progress* progress) {
  check_sequence(inputs);
  return count_frames(inputs, program, threads, progress);
}

/// Returns the number of frames to add if the intervals are `off` times too wide: at most a quarter of those before,
/// because widths estimated from few frames vary much.
std::size_t next_round_frames(std::size_t spent, std::size_t all, double off) {
  const auto before = static_cast<double>(spent);
  const double more = std::ceil(std::min(before * (off * off - 1), before / 4));
  return before + more > kMostFramesShare * static_cast<double>(all) ? all - spent : static_cast<std::size_t>(more);
}

/// Returns the weighted sums of the counts of frames, without pictures.
RenderResult sum_counts(std::span<const FrameResult* const> frames, std::span<const double> weights) {
  RenderResult sum;
  const auto set = [&](auto&& count_of) {
    double total = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      total += weights[i] * static_cast<double>(count_of(frames[i]->rendered));
    }
    count_of(sum) = round_count(std::max(0.0, total));
  };
  for (std::size_t k = 0; k < std::size(sum.rays); ++k) set([k](auto& r) -> auto& { return r.rays[k]; });
  set([](auto& r) -> auto& { return r.continued; });
  set([](auto& r) -> auto& { return r.traversal_steps; });
  set([](auto& r) -> auto& { return r.sampling.wanted; });
  set([](auto& r) -> auto& { return r.sampling.traced; });
  set([](auto& r) -> auto& { return r.sampling.background; });
  set([](auto& r) -> auto& { return r.sampling.traced_background; });
  for (const FrameResult* frame : frames) {
    sum.seconds += frame->rendered.seconds;
    sum.waited += frame->rendered.waited;
    sum.next_cpu_seconds += frame->rendered.next_cpu_seconds;
  }
  return sum;
}

}  // namespace

RepresentativeFrames::RepresentativeFrames(Inputs& inputs, const RunPlan& plan, std::uint32_t threads,
                                           Progress* progress)
    : inputs_(inputs),
      sampling_(*plan.frame_sampling()),
      threads_(threads),
      progress_(progress),
      first_(inputs.config.scene.first_frame),
      first_builds_(inputs.builds),
      frames_(inputs, plan, threads, progress),
      sample_(count_checked_frames(inputs, plan.program, threads, progress), sampling_.clusters, sampling_.draw),
      counting_seconds_(sim::seconds_since(begin_)),
      results_(inputs.frames()) {
  go_to_next_chosen();
}

FrameResult RepresentativeFrames::simulate(const SimulateOptions& extras) {
  FrameResult frame = frames_.simulate(extras);
  FrameResult& kept = results_[inputs_.frame - first_].emplace(frame);
  kept.rendered.rgb.clear();
  kept.rendered.pixels.clear();
  kept.tile_accounts.clear();
  kept.caches = nullptr;
  return frame;
}

FrameResult RepresentativeFrames::simulate_reference(const SimulateOptions&) {
  throw std::logic_error("representative frames have no reference");
}

bool RepresentativeFrames::go_to_next_chosen() {
  const auto next =
      std::ranges::find_if(sample_.chosen(), [&](std::uint32_t frame) { return !results_[frame].has_value(); });
  if (next == sample_.chosen().end()) return false;
  go_to_frame(inputs_, first_ + *next, threads_, progress_);
  if (*next == 0) {  // built, even if later frames refit its tree
    inputs_.builds = first_builds_;
    inputs_.refitted = false;
  }
  return true;
}

bool RepresentativeFrames::advance_frame() {
  return go_to_next_chosen() || (sampling_.clusters == 0 && add_frames() && go_to_next_chosen());
}

std::vector<const FrameResult*> RepresentativeFrames::chosen_results() const {
  std::vector<const FrameResult*> out;
  for (const std::uint32_t frame : sample_.chosen()) out.push_back(&*results_[frame]);
  return out;
}

bool RepresentativeFrames::add_frames() {
  const auto width = [](const Interval& total) { return total.half_width() / total.estimate; };
  const double of_cycles = width(estimate_cycles()), of_energy = width(estimate_energy());
  const double widest = std::max(of_cycles, of_energy);
  if (widest < kExactWidth || sample_.has_all_frames()) return false;
  const std::size_t missing = kLeastFrames - std::min(kLeastFrames, sample_.chosen().size());
  if (widest <= kTargetWidth && missing == 0) return false;
  std::vector<double> observed;
  for (const FrameResult* frame : chosen_results()) {
    observed.push_back(of_cycles > of_energy ? static_cast<double>(frame->cycles) : frame->energy.total_pj.nominal);
  }
  const std::size_t more = next_round_frames(sample_.chosen().size(), results_.size(), widest / kTargetWidth);
  sample_.add_frames(std::max(missing, more), observed);
  rounds_ += 1;
  if (progress_ != nullptr) progress_->expect_parts(frame_count());
  return true;
}

Interval RepresentativeFrames::estimate_cycles() const {
  std::vector<double> observed;
  std::vector<Interval> errors;
  for (const FrameResult* frame : chosen_results()) {
    observed.push_back(static_cast<double>(frame->cycles));
    if (frame->sampled) errors.push_back(frame->sampled->cycles);
  }
  return sample_.total(observed, errors);
}

Interval RepresentativeFrames::estimate_energy() const {
  std::vector<double> observed;
  std::vector<Interval> errors;
  for (const FrameResult* frame : chosen_results()) {
    observed.push_back(frame->energy.total_pj.nominal);
    if (frame->sampled) errors.push_back(frame->sampled->energy_pj);
  }
  return sample_.total(observed, errors);
}

RepresentedFrames RepresentativeFrames::summarise_sample() const {
  RepresentedFrames out{.frames = static_cast<std::uint32_t>(results_.size()),
                        .simulated = frame_count(),
                        .rounds = rounds_,
                        .asked = sampling_.clusters,
                        .draw = sampling_.draw,
                        .first = first_,
                        .cluster_of = sample_.clusters().of_frame,
                        .cluster_sizes = sample_.clusters().sizes,
                        .cycles = estimate_cycles(),
                        .energy_pj = estimate_energy(),
                        .counters = {},
                        .counting_seconds = counting_seconds_};
  std::map<std::string, std::vector<double>> seen;
  for (const FrameResult* frame : chosen_results()) {
    for (const auto& [path, value] : summed_counters(frame->units)) seen[path].push_back(value);
  }
  for (const auto& [path, values] : seen) out.counters[path] = sample_.total(values);
  return out;
}

FrameResult RepresentativeFrames::estimate_total() const {
  const std::vector<const FrameResult*> results = chosen_results();
  const std::vector<double>& weights = sample_.weights();
  const FrameResult& first = *results.front();
  FrameResult total;
  total.program = first.program;
  total.machine = first.machine;
  total.frames = static_cast<std::uint32_t>(results_.size());
  total.kernels = first.kernels;
  total.tiles = total.finished_tiles = first.tiles;
  total.represented = summarise_sample();
  total.rendered = sum_counts(results, weights);
  total.units = first.units;
  std::vector<Activity> parts;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const FrameResult& frame = *results[i];
    parts.push_back({frame.units, frame.kernel_use});
    total.wall_seconds += frame.wall_seconds;
    if (i > 0) sim::add_reports(total.units, frame.units);  // peak values are maxima
  }
  for (std::size_t u = 0; u < total.units.size(); ++u) {
    double elapsed = 0;
    for (std::size_t i = 0; i < results.size(); ++i) {
      elapsed += weights[i] * static_cast<double>(results[i]->units[u].elapsed);
    }
    total.units[u].elapsed = round_count(std::max(0.0, elapsed));
  }
  set_weighted_units(total.units, parts, weights);
  total.kernel_use = weighted_kernels(parts, weights);
  total.cycles = round_count(total.represented->cycles.estimate);
  total.elapsed = total.cycles * (first.elapsed / first.cycles);
  total.energy = energy_of(total.units, total.elapsed, inputs_.config);
  total.represented->energy_pj.estimate = total.energy.total_pj.nominal;
  return total;
}

void RepresentativeFrames::complete_result(RunResult& result) const {
  if (result.partial) throw Interrupted{};
  result.total = estimate_total();
  std::vector<sim::Json> frames(result.frames.begin(), result.frames.end());
  std::ranges::sort(frames, {}, [](const sim::Json& frame) { return frame["frame"].get<std::uint32_t>(); });
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i]["cluster"] = sample_.clusters().of_frame[sample_.chosen()[i]];
    frames[i]["weight"] = sample_.weights()[i];
  }
  result.frames = std::move(frames);
}

}  // namespace tools
