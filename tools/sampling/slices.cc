#include "tools/sampling/slices.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "shader_kernels/programs/full.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/printable.h"
#include "tools/analysis/units.h"
#include "tools/host/on_threads.h"
#include "tools/sampling/pilot.h"
#include "tools/sampling/slice_program.h"
#include "tools/sampling/slice_tiles.h"
#include "tools/simulation/machine_run.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {
namespace {

/// Tiles of a slice for each of a lead, where the number of slices is free: leads cost less than a tenth.
constexpr std::uint32_t kTilesOfALead = 10;
/// Error of a border that tiles played twice do not tell, in such tiles, as half of a 95 % interval (docs/slices.md).
constexpr double kBorderError = 4;

/// Time and counters of a machine between two times.
struct Stretch {
  sim::Time time = 0;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernels;

  explicit Stretch(const hw::Gpu& gpu) : time(gpu.elapsed()), units(gpu.report()), kernels(gpu.kernel_use()) {}
  explicit Stretch(const SliceTiles::Mark& mark) : time(mark.time), units(mark.units), kernels(mark.kernels) {}
  void take_off(const SliceTiles::Mark& earlier) {
    time -= earlier.time;
    sim::take_off_reports(units, earlier.units);
    for (std::size_t k = 0; k < kernels.size(); ++k) kernels[k] -= earlier.kernels[k];
  }
  void add(const Stretch& other) {
    time += other.time;
    sim::add_reports(units, other.units);
    for (std::size_t k = 0; k < kernels.size(); ++k) kernels[k] += other.kernels[k];
  }
};

/// Work that a machine has done: what the functional half counts as well, whatever the machine.
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

/// Ratio of a frame's work to what its slices have done: tiles under way at a border were not equally far on both
/// machines. Mean of those of steps and rays.
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
    for (auto& [reason, cycles] : unit.why) {
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

/// Cost of tiles that two machines have played.
struct Probe {
  double time = 0, energy_pj = 0;
};

/// Results of one slice.
struct PlayedSlice {
  std::optional<Stretch> own;
  Probe before, after;                     ///< those of the last tiles of its lead and of its own, if there is a border
  double seconds = 0, timing_seconds = 0;  ///< host: of its thread, and without making tiles
};

/// Plays the slices of a frame, as many at once as there are threads. More threads render ahead of them.
class SlicePlays {
 public:
  SlicePlays(const Inputs& inputs, SharedFrame& frame, const traces::Tracer& tracer, std::span<const Slice> slices,
             const SliceShape& shape, std::uint32_t threads)
      : inputs_(inputs),
        frame_(frame),
        tracer_(tracer),
        slices_(slices),
        probe_(shape.probe),
        at_once_(std::min(threads, static_cast<std::uint32_t>(slices.size()))),
        threads_(threads),
        scheduled_(std::make_shared<const hw::ScheduledKernels>(hw::schedule_kernels(inputs.config.gpu))),
        played_(slices.size()) {}

  std::vector<PlayedSlice> play() {
    on_threads(at_once_, [this](std::size_t thread) {
      const std::uint32_t workers = threads_ / at_once_ - 1 + (thread < threads_ % at_once_ ? 1 : 0);
      try {
        for (std::size_t i = next_++; i < slices_.size(); i = next_++) play_one(i, workers);
      } catch (...) {
        next_ = slices_.size();
        throw;
      }
    });
    return std::move(played_);
  }
  const std::vector<hw::KernelSchedule>& kernels() const { return scheduled_->kernels; }

 private:
  void play_one(std::size_t i, std::uint32_t workers) {
    const double begin = sim::thread_seconds();
    const Slice& slice = slices_[i];
    SliceProgram program(frame_, slice);
    const bool is_last = slice.end == program.tiles();
    std::vector<std::uint32_t> tile_indices((is_last ? slice.end : slice.end + 1) - slice.begin());
    std::iota(tile_indices.begin(), tile_indices.end(), slice.begin());
    FrontEnd front_end(program, tracer_, workers, true, std::move(tile_indices));
    SliceTiles tiles(front_end, slice, probe_, is_last);
    const auto gpu = make_gpu(inputs_, inputs_.config, program.requirements(), tiles, {}, {}, scheduled_);
    tiles.connect(*gpu);
    run_to_end(*gpu);

    PlayedSlice& played = played_[i];
    Stretch& own = is_last ? played.own.emplace(*gpu) : played.own.emplace(tiles.at(slice.end));
    if (slice.first != 0) {
      own.take_off(tiles.at(slice.first));
      played.before = probe(tiles, slice.first);
    }
    if (!is_last) played.after = probe(tiles, slice.end);
    frame_.add_times(front_end.result());
    played.seconds = sim::thread_seconds() - begin;
    played.timing_seconds = played.seconds - tiles.making_seconds();
  }
  Probe probe(const SliceTiles& tiles, std::uint32_t border) const {
    Stretch stretch(tiles.at(border));
    stretch.take_off(tiles.at(border - probe_));
    return {static_cast<double>(stretch.time), energy_of(stretch.units, stretch.time, inputs_.config).total_pj.nominal};
  }

  const Inputs& inputs_;
  SharedFrame& frame_;
  const traces::Tracer& tracer_;
  const std::span<const Slice> slices_;
  const std::uint32_t probe_, at_once_, threads_;
  const std::shared_ptr<const hw::ScheduledKernels> scheduled_;
  std::vector<PlayedSlice> played_;
  std::atomic<std::size_t> next_ = 0;
};

/// Adds up what slices came to, and how far they disagree about the `probe` tiles at each border.
void take(std::vector<PlayedSlice> played, std::uint32_t probe, const RunConfig& config, Simulation& s,
          SlicedFrame& sliced) {
  Stretch& all = *played.front().own;
  double time = 0, energy = 0;
  const auto add_error = [probe](double& error, double filled, double under_way) {
    error = std::hypot(error, filled - under_way, kBorderError * under_way / probe);
  };
  for (std::size_t i = 1; i < played.size(); ++i) {
    all.add(*played[i].own);
    add_error(time, played[i].before.time, played[i - 1].after.time);
    add_error(energy, played[i].before.energy_pj, played[i - 1].after.energy_pj);
  }
  for (const PlayedSlice& slice : played) {
    sliced.seconds.push_back(slice.seconds);
    sliced.timing_seconds += slice.timing_seconds;
  }
  if (played.size() > 1) scale(all, undone(s.function, Work(all.units)));
  const sim::Clock clock = config.gpu.clocks.tni.clock();
  s.elapsed = clock.edge_at_or_after(all.time);
  s.cycles = clock.cycles(s.elapsed);
  s.units = std::move(all.units);
  s.kernel_use = std::move(all.kernels);
  s.energy = energy_of(s.units, s.elapsed, config);
  sliced.cycles = {static_cast<double>(s.cycles), time / static_cast<double>(clock.period()), 0};
  sliced.energy_pj = {s.energy.total_pj.nominal, energy, 0};
}

kernels::FullProgram frame_of(const Inputs& inputs, const kernels::ProgramSpec& program) {
  return {inputs.image, inputs.camera, inputs.config.render, program.samples, inputs.frame};
}

void check_render(const kernels::RenderConfig& render) {
  if (render.primary != kernels::Primary::kRays) {
    throw sim::InputError(
        "--slices: all tiles wait for a rasteriser's geometry pass, which no slice has; allowed: render.primary=rays");
  }
  if (render.effect_rate != kernels::EffectRate::kFull) {
    throw sim::InputError(
        "--slices: tiles wait for what effects found in others, of other slices; allowed: render.effect_rate=full");
  }
}

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

std::uint32_t slices_of(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t asked) {
  check_render(inputs.config.render);
  const kernels::FullProgram frame = frame_of(inputs, program);
  const SliceShape shape = slice_shape(inputs.config.gpu, frame.requirements());
  if (asked == kAutoSlices) return std::max(1U, frame.tiles() / (kTilesOfALead * shape.lead));
  const std::uint32_t most = std::max(1U, frame.tiles() / shape.lead);
  if (asked <= most) return asked;
  throw sim::InputError(
      fmt::format("--slices {}: too many for a frame of {} tile{}, as each slice needs {} to fill this machine; "
                  "allowed: at most {}",
                  asked, frame.tiles(), frame.tiles() == 1 ? "" : "s", shape.lead, most));
}

Simulation simulate_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                           std::uint32_t slices, Progress* progress) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  threads = host_threads(threads);
  const traces::BvhTracer tracer(inputs.image);
  kernels::FullProgram full = frame_of(inputs, program);
  const SliceShape shape = slice_shape(inputs.config.gpu, full.requirements());
  const std::vector<Slice> plan = plan_slices(guess_costs(inputs, program, tracer, threads), slices, shape);
  if (progress != nullptr) progress->begin_part("simulating", inputs.frame, full.tiles());
  SharedFrame frame(full, progress);
  SlicePlays plays(inputs, frame, tracer, plan, shape, threads);

  Simulation s;
  s.program = program;
  s.machine = inputs.config.gpu;
  s.kernels = plays.kernels();
  SlicedFrame& sliced = s.sliced.emplace();
  sliced.slices = slices;
  sliced.tiles = full.tiles();
  for (const Slice& slice : plan) sliced.again += slice.lead, sliced.warmed += slice.warming;
  std::vector<PlayedSlice> played = plays.play();
  s.function = frame.take_function();
  take(std::move(played), shape.probe, inputs.config, s, sliced);
  s.tiles = s.finished_tiles = full.tiles();
  s.wall_seconds = sim::seconds_since(begin);
  return s;
}

SlicedFrame uncut(const Simulation& s) {
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

}  // namespace tools
