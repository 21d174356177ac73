#include "tools/sampling/slice_sum.h"

#include <cmath>
#include <span>
#include <utility>

#include "tools/analysis/units.h"
#include "tools/run/frame/machine_run.h"

namespace tools {
namespace {

/// Half-width of the error of a border that the probes do not show, in tiles (docs/slices.md).
constexpr double kBorderError = 4;

/// Work of a machine in units that rendering counts as well.
struct Work {
  double steps = 0, rays = 0;
  explicit Work(std::span<const sim::UnitReport> reports) {
    const Units<hw::Trv> trvs(reports);
    const Units<hw::Ist> ists(reports);
    steps = static_cast<double>(trvs.counted(&hw::Trv::Stats::visits) -
                                trvs.counted(&hw::Trv::Stats::restarted_visits) + ists.counted(&hw::Ist::Stats::tests));
    rays = static_cast<double>(Units<hw::Srp>(reports).counted(&hw::SrpStats::rays));
  }
};

/// Ratio of the frame's work to the work that its slices simulated, which differs because tiles in flight at a border
/// progress differently on both machines. Mean of the ratios of steps and rays.
double undone(const FrontEnd::Result& function, const Work& done) {
  return (static_cast<double>(function.traversal_steps) / done.steps +
          static_cast<double>(function.all_rays()) / done.rays) /
         2;
}

void scale(Stretch& all, double factor) {
  const auto by = [factor](auto& value) {
    value = static_cast<std::uint64_t>(std::llround(factor * static_cast<double>(value)));
  };
  by(all.time);
  for (sim::UnitReport& unit : all.units) {
    unit.elapsed = 0;
    for (auto& [reason, cycles] : unit.cycles_by_reason) {
      by(cycles);
      unit.elapsed += cycles;
    }
    for (sim::CounterReport& counter : unit.counters) {
      if (counter.kind != sim::CounterKind::kPeak) by(counter.value);
    }
  }
  for (hw::KernelUse& use : all.kernels) {
    for (std::uint64_t* value : {&use.launches, &use.items, &use.idle, &use.cycles, &use.starved}) by(*value);
  }
}

/// Adds times and counters to the first slice. Returns the half-widths over all borders.
Probe add_all(std::vector<PlayedSlice>& played, std::uint32_t probe) {
  Probe error;
  const auto add_error = [probe](double& sum, double filled, double under_way) {
    sum = std::hypot(sum, filled - under_way, kBorderError * under_way / probe);
  };
  for (std::size_t i = 1; i < played.size(); ++i) {
    played.front().own.add(played[i].own);
    add_error(error.time, played[i].before.time, played[i - 1].after.time);
    add_error(error.energy_pj, played[i].before.energy_pj, played[i - 1].after.energy_pj);
  }
  return error;
}

}  // namespace

FrameResult add_up(const SlicePlayer& player, const kernels::ProgramSpec& program, FrontEnd::Result function,
                   std::vector<PlayedSlice> played) {
  const RunConfig& config = player.inputs().config;
  FrameResult s;
  s.program = program;
  s.machine = config.gpu;
  s.kernels = player.kernels();
  s.function = std::move(function);
  s.tiles = s.finished_tiles = player.tiles();
  SlicedFrame& sliced = s.sliced.emplace();
  sliced.slices = static_cast<std::uint32_t>(played.size());
  sliced.tiles = player.tiles();
  for (const PlayedSlice& one : played) {
    sliced.again += one.slice.lead;
    sliced.warmed += one.slice.warming;
    sliced.seconds.push_back(one.seconds);
    sliced.timing_seconds += one.timing_seconds;
  }

  const Probe error = add_all(played, player.shape().probe);
  Stretch& all = played.front().own;
  if (played.size() > 1) scale(all, undone(s.function, Work(all.units)));
  const sim::Clock clock = config.gpu->clocks.tni.clock();
  s.elapsed = clock.edge_at_or_after(all.time);
  s.cycles = clock.cycles(s.elapsed);
  s.units = std::move(all.units);
  s.kernel_use = std::move(all.kernels);
  s.energy = energy_of(s.units, s.elapsed, config);
  sliced.cycles = {static_cast<double>(s.cycles), error.time / static_cast<double>(clock.period()), 0};
  sliced.energy_pj = {s.energy.total_pj.nominal, error.energy_pj, 0};
  return s;
}

}  // namespace tools
