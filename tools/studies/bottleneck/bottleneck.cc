#include "tools/studies/bottleneck/bottleneck.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/trv.h"
#include "tools/analysis/report.h"
#include "tools/analysis/top_down.h"
#include "tools/analysis/units.h"
#include "tools/host/progress.h"
#include "tools/noise/noise.h"
#include "tools/run/frame/run_job.h"

namespace tools {
namespace {

double ratio_or_zero(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// Returns the share of the time with rays in which T&I subunits of a kind wait for cache lines.
template <class Unit>
double miss_share(const Units<Unit>& units) {
  using Reason = typename Unit::CycleReason;
  const double there = 1 - units.share(Reason::kStarved);
  return there > 0
             ? (units.share(Reason::kL1Miss) + units.share(Reason::kMshrFull) + units.share(Reason::kRauFull)) / there
             : 0;
}

template <class Unit>
CacheShare tree_cache(const char* name, const Units<Unit>& units, double share) {
  using Stats = typename Unit::Stats;
  return {name, ratio_or_zero(units.sum_of(&Stats::l1_hits), units.sum_of(&Stats::l1_accesses)),
          ratio_or_zero(units.sum_of(&Stats::l1_miss_cycles), units.sum_of(&Stats::l1_fills)), share};
}

/// Returns mean and deviation of the cycle counts of a run and its replicates.
Draws cycle_draws(const FrameResult& run) {
  std::vector<double> cycles = {static_cast<double>(run.cycles)};
  for (const FrameResult& replicate : run.replicates) cycles.push_back(static_cast<double>(replicate.cycles));
  return draw_statistics(cycles);
}

std::vector<CacheShare> cache_shares(std::span<const sim::UnitReport> units, const CoreTime& time) {
  const Units<hw::Trv> trvs(units);
  const Units<hw::Ist> ists(units);
  const Units<hw::Srp> srps(units);
  // Assumption: a ray in the intersection unit and the unit itself wait for lines for the same share of their time.
  const double there = 1 - trvs.share(hw::Trv::CycleReason::kStarved);
  const double at_ist = there > 0 ? trvs.share(hw::Trv::CycleReason::kIst) / there : 0;
  const double nodes = miss_share(trvs), triangles = at_ist * miss_share(ists), all = nodes + triangles;
  const double of_nodes = all > 0 ? time.tree_misses * nodes / all : 0;
  using Srp = hw::Srp::Stats;
  return {tree_cache("node", trvs, of_nodes),
          tree_cache("triangle", ists, time.tree_misses - of_nodes),
          {"data", ratio_or_zero(srps.sum_of(&Srp::cache_hits), srps.sum_of(&Srp::cache_accesses)),
           ratio_or_zero(srps.sum_of(&Srp::cache_miss_cycles), srps.sum_of(&Srp::cache_fills)), time.data_misses}};
}

}  // namespace

NoisySpeedup noisy_speedup(const Bottleneck& found, const Bound& bound) {
  const auto seen = [&](const Draws& plays) {
    return plays.count > 1 ? MeasuredMetric{plays.mean, plays} : MeasuredMetric{plays.mean, {}, found.assumed_noise};
  };
  const MeasuredMetric plain = seen(found.plays), ideal = seen(bound.plays);
  const MeanDifference saved = difference_of(ideal, plain);
  return {plain.value / ideal.value, saved.half_width() / ideal.value, std::abs(saved.value) > saved.half_width()};
}

Bottleneck find_bottleneck(const JobOptions& options, Progress* progress) {
  Inputs inputs = load_inputs(options, progress);
  print_warnings(inputs.warnings, progress);
  const kernels::ProgramSpec program = kernels::parse_program(options.program);
  const auto play = [&](const char* what) {
    if (progress != nullptr) progress->expect_parts(options.replicates, what);
    return simulate_frame(inputs, program, options.threads, {.progress = progress, .replicates = options.replicates});
  };
  const FrameResult measured = play("as configured");
  const double pixels = double{1} * inputs.config.render.width * inputs.config.render.height;
  const CoreTime time = top_down(measured.units, *measured.machine).gpu;
  const std::vector<Estimate> estimates = estimate_speedups(time);
  Bottleneck found{.cycles = measured.cycles,
                   .limiter = limiter_text(estimates),
                   .time = time,
                   .named = largest_speedup(estimates).resource,
                   .bounds = {},
                   .caches = cache_shares(measured.units, time),
                   .plays = cycle_draws(measured),
                   .assumed_noise = default_noise(pixels, "cycles"),
                   .warnings = inputs.warnings};
  for (const hw::IdealConfig::Resource& resource : hw::IdealConfig::kResources) {
    bool& ideal = inputs.config.gpu->ideal.*resource.member;
    const bool configured = ideal;
    ideal = true;
    const double estimated = std::ranges::find(estimates, resource.name, &Estimate::resource)->speedup;
    const FrameResult bound = play(resource.words);
    found.bounds.push_back({resource.name, bound.cycles, estimated, cycle_draws(bound)});
    ideal = configured;
  }
  return found;
}

}  // namespace tools
