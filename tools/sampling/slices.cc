#include "tools/sampling/slices.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "shader_kernels/programs/full.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/printable.h"
#include "tools/analysis/units.h"
#include "tools/host/parallel.h"
#include "tools/run/frame/machine_run.h"
#include "tools/sampling/pilot.h"
#include "tools/sampling/slice_file.h"
#include "tools/sampling/slice_player.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {
namespace {

/// Automatic length of slices in leads: leads cost less than a tenth, in small frames up to 15 %.
constexpr std::uint32_t kTilesOfALead = 10;

/// Simulates all slices, `threads` at a time. Further threads render ahead.
std::vector<PlayedSlice> run_all_slices(const SlicePlayer& player, SharedFrame& frame, const traces::Tracer& tracer,
                                        std::span<const Slice> slices, std::uint32_t threads) {
  const std::uint32_t at_once = std::min(threads, static_cast<std::uint32_t>(slices.size()));
  std::vector<PlayedSlice> played(slices.size());
  parallel_for(slices.size(), at_once, [&](std::size_t i, std::size_t thread) {
    const std::uint32_t workers = threads / at_once - 1 + (thread < threads % at_once ? 1 : 0);
    played[i] = player.run_slice(frame, tracer, slices[i], workers);
  });
  return played;
}

kernels::FullProgram full_program(const Inputs& inputs, const kernels::ProgramSpec& program) {
  return {inputs.image, inputs.camera, inputs.config.render, program.samples, inputs.frame};
}

void check_sliceable(const kernels::RenderConfig& render) {
  if (render.primary != kernels::Primary::kRays) {
    throw sim::InputError(
        "--slices: all tiles wait for a rasteriser's geometry pass, which no slice has; allowed: render.primary=rays");
  }
  if (render.effect_rate != kernels::EffectRate::kFull) {
    throw sim::InputError(
        "--slices: tiles wait for what effects found in others, of other slices; allowed: render.effect_rate=full");
  }
}

/// A frame, its program and tracer, and its slices.
struct SlicedProgram {
  SlicedProgram(const Inputs& inputs, const kernels::ProgramSpec& spec, std::uint32_t threads, std::uint32_t slices)
      : tracer(inputs.image),
        program(full_program(inputs, spec)),
        player(inputs, program),
        plan(plan_slices(estimate_costs(inputs, spec, tracer, threads), slices, player.plan_shape())) {}

  const traces::BvhTracer tracer;
  kernels::FullProgram program;
  const SlicePlayer player;
  const std::vector<Slice> plan;
};

}  // namespace

std::uint32_t parse_slices(const std::string& text) {
  if (text == "auto") return kAutoSlices;
  std::uint32_t slices = 0;
  const char* end = text.data() + text.size();
  const auto [rest, bad] = std::from_chars(text.data(), end, slices);
  if (bad == std::errc{} && rest == end && slices != 0) return slices;
  throw sim::InputError(
      fmt::format("--slices '{}' is neither a number from 1 on, e.g. 2, nor auto", sim::printable(text)));
}

void check_slices(const kernels::ProgramSpec& program) {
  if (program.kind == kernels::ProgramSpec::Kind::kFull) return;
  throw sim::InputError(fmt::format(
      "--slices: tiles of {} wait for what their neighbours found, which may be in other slices; allowed: full:N",
      program.name()));
}

std::uint32_t slice_count(const RunConfig& config, const kernels::ProgramSpec& program, std::uint32_t asked) {
  check_sliceable(config.render);
  const traces::MemoryImage no_scene;  // the tiles do not depend on the scene
  const kernels::FullProgram frame(no_scene, {}, config.render, program.samples, 0);
  const SliceShape shape = slice_shape(*config.gpu, frame.requirements());
  if (asked == kAutoSlices) return std::max(1U, frame.tiles() / (kTilesOfALead * shape.lead));
  const std::uint32_t most = std::max(1U, frame.tiles() / shape.lead);
  if (asked <= most) return asked;
  throw sim::InputError(
      fmt::format("--slices {}: too many for a frame of {} tile{}, as each slice needs {} to fill this machine; "
                  "allowed: at most {}",
                  asked, frame.tiles(), frame.tiles() == 1 ? "" : "s", shape.lead, most));
}

FrameResult simulate_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                            std::uint32_t slices, Progress* progress) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  threads = host_threads(threads);
  SlicedProgram cut(inputs, program, threads, slices);
  if (progress != nullptr) progress->begin_part("simulating", inputs.frame, cut.program.tiles());
  SharedFrame frame(cut.program, progress);
  std::vector<PlayedSlice> played = run_all_slices(cut.player, frame, cut.tracer, cut.plan, threads);
  FrameResult s = sum_slices(cut.player, program, frame.take_result(), std::move(played));
  s.wall_seconds = sim::seconds_since(begin);
  return s;
}

sim::Json simulate_slice(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                         std::uint32_t slices, std::uint32_t index) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  threads = host_threads(threads);
  SlicedProgram cut(inputs, program, threads, slices);
  SharedFrame frame(cut.program, nullptr);
  SlicePart part;
  part.played = cut.player.run_slice(frame, cut.tracer, cut.plan.at(index), threads - 1);
  part.rendered = frame.take_result();
  part.wall_seconds = sim::seconds_since(begin);
  return slice_json(part);
}

FrameResult join_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::span<const sim::Json> slices) {
  const SlicePlayer player(inputs, full_program(inputs, program));
  const MachineSpan nothing = player.initial_state();
  std::vector<PlayedSlice> played;
  RenderResult function;
  double wall_seconds = 0;
  std::uint32_t next = 0;
  const auto read = [&](const sim::Json& slice) {
    try {
      return read_slice(slice, nothing);
    } catch (const sim::InputError& error) {
      throw sim::InputError(fmt::format("slice {}: {}", played.size() + 1, error.what()));
    }
  };
  for (const sim::Json& slice : slices) {
    SlicePart part = read(slice);
    const bool follows = part.played.slice.first == next && part.played.slice.end > next;
    next = part.played.slice.end;
    if (!follows || (next == player.tile_count()) != (played.size() + 1 == slices.size())) {
      throw sim::InputError(fmt::format("slice {}: its tiles do not follow those before it", played.size() + 1));
    }
    function.add(part.rendered);
    wall_seconds += part.wall_seconds;
    played.push_back(std::move(part.played));
  }
  FrameResult s = sum_slices(player, program, std::move(function), std::move(played));
  s.wall_seconds = wall_seconds;
  return s;
}

SlicedFrame as_single_slice(const FrameResult& s) {
  return {.tiles = s.tiles,
          .cycles = {static_cast<double>(s.cycles), 0, 0},
          .energy_pj = {s.energy.total_pj.nominal, 0, 0},
          .seconds = {}};
}

void SlicedFrame::add(const SlicedFrame& other) {
  tiles += other.tiles;
  again += other.again;
  warmed += other.warmed;
  cycles.add(other.cycles);
  energy_pj.add(other.energy_pj);
  for (std::size_t i = 0; i < seconds.size(); ++i) seconds[i] += other.seconds[i];
  timing_seconds += other.timing_seconds;
}

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
double work_ratio(const RenderResult& function, const Work& done) {
  return (static_cast<double>(function.traversal_steps) / done.steps +
          static_cast<double>(function.all_rays()) / done.rays) /
         2;
}

void scale_counts(MachineSpan& all, double factor) {
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

FrameResult sum_slices(const SlicePlayer& player, const kernels::ProgramSpec& program, RenderResult function,
                       std::vector<PlayedSlice> played) {
  const RunConfig& config = player.inputs().config;
  FrameResult s;
  s.program = program;
  s.machine = config.gpu;
  s.kernels = player.kernel_schedules();
  s.rendered = std::move(function);
  s.tiles = s.finished_tiles = player.tile_count();
  SlicedFrame& sliced = s.sliced.emplace();
  sliced.slices = static_cast<std::uint32_t>(played.size());
  sliced.tiles = player.tile_count();
  for (const PlayedSlice& one : played) {
    sliced.again += one.slice.lead;
    sliced.warmed += one.slice.warming;
    sliced.seconds.push_back(one.seconds);
    sliced.timing_seconds += one.timing_seconds;
  }

  const Probe error = add_all(played, player.plan_shape().probe);
  MachineSpan& all = played.front().own;
  if (played.size() > 1) scale_counts(all, work_ratio(s.rendered, Work(all.units)));
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
