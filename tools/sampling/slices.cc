#include "tools/sampling/slices.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "shader_kernels/programs/full.h"
#include "shader_kernels/programs/programs.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/analysis/units.h"
#include "tools/host/parallel.h"
#include "tools/run/frame/machine_run.h"
#include "tools/sampling/pilot.h"
#include "traces/accel/bvh_tracer.h"

namespace tools {
namespace {

/// A frame program that several threads execute concurrently. Each tile is committed and counted once.
class SharedFrame {
 public:
  SharedFrame(kernels::FrameProgram& program, Progress* progress) : program_(program), progress_(progress) {}
  const kernels::FrameProgram& frame_program() const { return program_; }

  void commit_tile(const kernels::TileResult& tile) {
    const std::lock_guard lock(mutex_);
    program_.commit_tile(tile);
    for (std::size_t k = 0; k < std::size(result_.rays); ++k) result_.rays[k] += tile.rays[k];
    result_.continued += tile.continued;
    result_.traversal_steps += tile.traversal_steps;
    tiles_ += 1;
    if (progress_ != nullptr) progress_->set_tiles_done(tiles_, result_.all_rays(), 0);
  }
  /// Adds the host times of one slice's thread to the results.
  void add_times(const RenderResult& rendered) {
    const std::lock_guard lock(mutex_);
    result_.seconds += rendered.seconds;
    result_.waited += rendered.waited;
  }
  /// Returns the results of rendering. Call it after all threads have finished.
  RenderResult take_result() {
    result_.rgb = program_.move_picture_out();
    result_.sampling = program_.sampling();
    return std::move(result_);
  }

 private:
  kernels::FrameProgram& program_;
  Progress* const progress_;
  std::mutex mutex_;
  RenderResult result_;
  std::uint32_t tiles_ = 0;
};

/// View of a shared frame for one slice. It commits only the tiles of the slice. Throws Interrupted.
class SliceProgram final : public kernels::FrameProgram {
 public:
  SliceProgram(SharedFrame& frame, const Slice& slice) : FrameProgram(0, 0), frame_(frame), slice_(slice) {}

  std::uint32_t tiles() const override { return frame_.frame_program().tiles(); }
  kernels::FrameRequirements requirements() const override { return frame_.frame_program().requirements(); }
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override {
    if (is_interrupted()) throw Interrupted{};
    frame_.frame_program().run_tile(tile_index, tracer, record, out);
  }
  void commit_tile(const kernels::TileResult& tile) override {
    if (slice_.has_tile(tile.work.tile)) frame_.commit_tile(tile);
  }

 private:
  SharedFrame& frame_;
  const Slice slice_;
};

/// Simulates slices of a frame, each on a machine of its own.
class SliceSimulator {
 public:
  /// `frame`: program of the frame. `inputs` must outlive this object.
  SliceSimulator(const Inputs& inputs, const kernels::FrameProgram& frame)
      : inputs_(inputs),
        requirements_(frame.requirements()),
        tiles_(frame.tiles()),
        shape_(slice_shape(*inputs.config.gpu, requirements_)),
        scheduled_(std::make_shared<const hw::ScheduledKernels>(hw::schedule_kernels(*inputs.config.gpu))) {}

  const Inputs& inputs() const { return inputs_; }
  const SliceShape& plan_shape() const { return shape_; }
  const std::vector<hw::KernelSchedule>& kernel_schedules() const { return scheduled_->kernels; }
  std::uint32_t tile_count() const { return tiles_; }

  /// Simulates one slice. Thread-safe for different slices. `workers`: threads that render ahead. Throws sim::Deadlock,
  /// Interrupted.
  SliceResult run_slice(SharedFrame& frame, const traces::Tracer& tracer, const Slice& slice,
                        std::uint32_t workers) const {
    const double begin = sim::thread_seconds();
    SliceProgram program(frame, slice);
    const bool is_last = slice.end == tiles_;
    std::vector<std::uint32_t> tile_indices((is_last ? slice.end : slice.end + 1) - slice.begin());
    std::iota(tile_indices.begin(), tile_indices.end(), slice.begin());
    FrontEnd front_end(program, tracer, workers, true, std::move(tile_indices));
    std::vector<std::uint32_t> marked;
    if (slice.first != 0) marked = {slice.first - shape_.probe, slice.first};
    if (!is_last) marked.insert(marked.end(), {slice.end - shape_.probe, slice.end});
    std::optional<std::uint32_t> stop_at;
    if (!is_last) stop_at = slice.end;
    TimedTiles tiles(front_end, {{slice.lead_begin(), slice.first, is_last ? slice.end : slice.end + 1, slice.warming}},
                     std::move(marked), stop_at);
    const auto gpu = make_machine(tiles);
    tiles.set_gpu(*gpu);
    if (inputs_.config.frame.start == FrameStart::kWarm) {
      SliceProgram previous(frame, slice);
      warm_with_last_tiles(*gpu, previous, tracer, workers);
    }
    run_to_end(*gpu);

    SliceResult played;
    played.slice = slice;
    played.own = is_last ? MachineSpan(*gpu) : MachineSpan(tiles.snapshot_at(slice.end));
    if (slice.first != 0) {
      played.own.subtract_mark(tiles.snapshot_at(slice.first));
      played.before = measure_probe(tiles, slice.first);
    }
    if (!is_last) played.after = measure_probe(tiles, slice.end);
    frame.add_times(front_end.result());
    played.seconds = sim::thread_seconds() - begin;
    played.timing_seconds = played.seconds - front_end.result().next_cpu_seconds;
    return played;
  }
  /// Returns the counters of the machine before its first cycle.
  MachineSpan initial_state() const {
    hw::TileSource none;
    return MachineSpan(*make_machine(none));
  }

 private:
  std::unique_ptr<hw::Gpu> make_machine(hw::TileSource& tiles) const {
    return make_gpu(inputs_, inputs_.config, requirements_, tiles, {}, {}, scheduled_);
  }
  Probe measure_probe(const TimedTiles& tiles, std::uint32_t border) const {
    MachineSpan stretch(tiles.snapshot_at(border));
    stretch.subtract_mark(tiles.snapshot_at(border - shape_.probe));
    return {static_cast<double>(stretch.time), energy_of(stretch.units, stretch.time, inputs_.config).total_pj.nominal};
  }

  const Inputs& inputs_;
  const kernels::FrameRequirements requirements_;
  const std::uint32_t tiles_;
  const SliceShape shape_;
  const std::shared_ptr<const hw::ScheduledKernels> scheduled_;
};

/// Length of an automatically sized slice, as a multiple of the length of its lead (tiles that only fill the machine).
/// Leads then cost less than a tenth of the time, in small frames up to 15 %.
constexpr std::uint32_t kTilesOfALead = 10;

/// Simulates all slices, `threads` at a time. Threads in excess of the number of slices render ahead.
std::vector<SliceResult> run_all_slices(const SliceSimulator& player, SharedFrame& frame, const traces::Tracer& tracer,
                                        std::span<const Slice> slices, std::uint32_t threads) {
  const std::uint32_t at_once = std::min(threads, static_cast<std::uint32_t>(slices.size()));
  std::vector<SliceResult> played(slices.size());
  parallel_for(slices.size(), at_once, [&](std::size_t i, std::size_t thread) {
    const std::uint32_t workers = threads / at_once - 1 + (thread < threads % at_once ? 1 : 0);
    played[i] = player.run_slice(frame, tracer, slices[i], workers);
  });
  return played;
}

/// Makes a program whose tiles do not depend on each other: full:N or path:N.
std::unique_ptr<kernels::FrameProgram> sliceable_program(const Inputs& inputs, const kernels::ProgramSpec& spec) {
  const kernels::RateMap no_rates(inputs.config.programs.multirate);
  return kernels::make_program(spec, {inputs.image, inputs.camera, inputs.config.render, inputs.config.programs,
                                      no_rates, inputs.frame, inputs.scene_size});
}

void check_sliceable(const RunConfig& config) {
  const kernels::RenderConfig& render = config.render;
  if (config.programs.denoise.filter != kernels::DenoiseFilter::kOff) {
    throw sim::InputError("--slices: a denoiser reads all tiles, which no slice has; allowed: denoise.filter=off");
  }
  if (config.build.engine != traces::BuildEngine::kHost) {
    throw sim::InputError(
        "--slices: all tiles wait for the frame's trees, which no slice builds; allowed: "
        "build.engine=host");
  }
  if (render.primary != kernels::Primary::kRays) {
    throw sim::InputError(
        "--slices: all tiles wait for a rasteriser's geometry pass, which no slice has; allowed: render.primary=rays");
  }
  if (render.effect_rate != kernels::EffectRate::kFull) {
    throw sim::InputError(
        "--slices: tiles wait for what effects found in others, of other slices; allowed: render.effect_rate=full");
  }
  if (config.gpu->tni.predictor.enabled) {
    throw sim::InputError(
        "--slices: a predictor learns from tiles of other slices; allowed: tni.predictor.enabled=false");
  }
}

/// The frame program of a frame, its tracer, and the slices of the frame.
struct SlicedProgram {
  SlicedProgram(const Inputs& inputs, const kernels::ProgramSpec& spec, std::uint32_t threads, std::uint32_t slices)
      : tracer(inputs.image),
        program(sliceable_program(inputs, spec)),
        player(inputs, *program),
        plan(plan_slices(estimate_costs(inputs, spec, tracer, threads), slices, player.plan_shape())) {}

  const traces::BvhTracer tracer;
  const std::unique_ptr<kernels::FrameProgram> program;
  const SliceSimulator player;
  const std::vector<Slice> plan;
};

/// Half-width of the error at a border between slices that probe tiles cannot measure, as a number of tiles
/// (docs/slices.md).
constexpr double kBorderError = 4;

/// Work of a machine in quantities that rendering also counts: traversal steps and rays.
struct Work {
  double steps = 0, rays = 0;
  explicit Work(std::span<const sim::UnitReport> reports) {
    const Units<hw::Trv> trvs(reports);
    const Units<hw::Ist> ists(reports);
    steps = static_cast<double>(trvs.sum_of(&hw::Trv::Stats::visits) - trvs.sum_of(&hw::Trv::Stats::restarted_visits) +
                                ists.sum_of(&hw::Ist::Stats::tests));
    rays = static_cast<double>(Units<hw::Srp>(reports).sum_of(&hw::SrpStats::rays));
  }
};

/// Returns the ratio of the frame's work to the work that its slices simulated: the mean of the ratios of steps and
/// rays. The two ratios differ, because a tile in flight at a border between slices progresses differently on the
/// machines of these slices.
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
    for (const auto& [name, count] : hw::KernelUse::kCounts) by(use.*count);
  }
}

/// Adds times and counters of all slices to the first slice. Returns the half-widths of the errors of time and energy,
/// combined over all borders between slices.
Probe sum_slice_spans(std::vector<SliceResult>& played, std::uint32_t probe) {
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

/// Adds up times and counters of all slices of a frame. Derives confidence intervals from the differences at their
/// borders (docs/slices.md). `function`: picture and ray counts of the frame.
FrameResult sum_slices(const SliceSimulator& player, const kernels::ProgramSpec& program, RenderResult function,
                       std::vector<SliceResult> played) {
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
  for (const SliceResult& one : played) {
    sliced.again += one.slice.lead;
    sliced.warmed += one.slice.warming;
    sliced.seconds.push_back(one.seconds);
    sliced.timing_seconds += one.timing_seconds;
  }

  const Probe error = sum_slice_spans(played, player.plan_shape().probe);
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
  if (program.has_independent_tiles()) return;
  throw sim::InputError(
      fmt::format("--slices: tiles of {} wait for what their neighbours found, which may be in other slices; allowed: "
                  "full:N, path:N",
                  program.name()));
}

std::uint32_t slice_count(const RunConfig& config, const kernels::ProgramSpec& program, std::uint32_t requested) {
  check_sliceable(config);
  const traces::MemoryImage no_scene;  // the list of tiles does not depend on the scene
  const kernels::FullProgram frame(no_scene, {}, config.render, program.samples, 0);
  const SliceShape shape = slice_shape(*config.gpu, frame.requirements());
  if (requested == kAutoSlices) return std::max(1U, frame.tiles() / (kTilesOfALead * shape.lead));
  const std::uint32_t most = std::max(1U, frame.tiles() / shape.lead);
  if (requested <= most) return requested;
  throw sim::InputError(
      fmt::format("--slices {}: too many for a frame of {} tile{}, as each slice needs {} to fill this machine; "
                  "allowed: at most {}",
                  requested, frame.tiles(), frame.tiles() == 1 ? "" : "s", shape.lead, most));
}

FrameResult simulate_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                            std::uint32_t slices, Progress* progress) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  threads = host_threads(threads);
  SlicedProgram cut(inputs, program, threads, slices);
  if (progress != nullptr) progress->begin_part("simulating", inputs.frame, cut.program->tiles());
  SharedFrame frame(*cut.program, progress);
  std::vector<SliceResult> played = run_all_slices(cut.player, frame, cut.tracer, cut.plan, threads);
  FrameResult s = sum_slices(cut.player, program, frame.take_result(), std::move(played));
  s.wall_seconds = sim::seconds_since(begin);
  return s;
}

sim::Json simulate_slice(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                         std::uint32_t slices, std::uint32_t index) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  threads = host_threads(threads);
  SlicedProgram cut(inputs, program, threads, slices);
  SharedFrame frame(*cut.program, nullptr);
  SlicePart part;
  part.played = cut.player.run_slice(frame, cut.tracer, cut.plan.at(index), threads - 1);
  part.rendered = frame.take_result();
  part.wall_seconds = sim::seconds_since(begin);
  return slice_json(part);
}

FrameResult join_slices(const Inputs& inputs, const kernels::ProgramSpec& program, std::span<const sim::Json> slices) {
  const SliceSimulator player(inputs, *sliceable_program(inputs, program));
  const MachineSpan nothing = player.initial_state();
  std::vector<SliceResult> played;
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

SlicedFrame to_single_slice(const FrameResult& s) {
  return {.tiles = s.tiles,
          .cycles = {static_cast<double>(s.cycles), 0, 0},
          .energy_pj = {s.energy.total_pj.nominal, 0, 0},
          .seconds = {}};
}

void SlicedFrame::add(const SlicedFrame& other) {
  tiles += other.tiles;
  again += other.again;
  warmed += other.warmed;
  cycles.add_estimate(other.cycles);
  energy_pj.add_estimate(other.energy_pj);
  for (std::size_t i = 0; i < seconds.size(); ++i) seconds[i] += other.seconds[i];
  timing_seconds += other.timing_seconds;
}

void MachineSpan::subtract_mark(const Mark& earlier) {
  time -= earlier.time;
  sim::subtract_reports(units, earlier.units);
  for (std::size_t k = 0; k < kernels.size(); ++k) kernels[k] -= earlier.kernels[k];
}

void MachineSpan::add(const MachineSpan& other) {
  time += other.time;
  sim::add_reports(units, other.units);
  for (std::size_t k = 0; k < kernels.size(); ++k) kernels[k] += other.kernels[k];
}

namespace {

using sim::Json;

/// JSON keys of counts of sampling and slices.
constexpr std::pair<const char*, std::uint64_t kernels::Sampling::*> kSamplingCounts[] = {
    {"wanted", &kernels::Sampling::wanted},
    {"traced", &kernels::Sampling::traced},
    {"background", &kernels::Sampling::background},
    {"traced_background", &kernels::Sampling::traced_background}};
constexpr std::pair<const char*, std::uint32_t Slice::*> kSliceTiles[] = {
    {"first", &Slice::first}, {"end", &Slice::end}, {"lead", &Slice::lead}, {"warming", &Slice::warming}};

/// Parses a count from JSON; parse_counts() parses an array of `size` counts.
std::uint64_t parse_count(const Json& json) { return sim::whole_number<std::uint64_t>(json, "a count"); }
const Json& parse_list(const Json& json, std::size_t size, const char* what) {
  if (json.is_array() && json.size() == size) return json;
  throw sim::InputError(fmt::format("{} are no list of {}", what, size));
}
double amount_in(const Json& json) {
  const double amount = json.is_number() ? json.get<double>() : -1;
  if (amount >= 0 && std::isfinite(amount)) return amount;
  throw sim::InputError("an amount is no number from 0 on");
}

template <class Members, class Counted>
Json counts_json(const Members& members, const Counted& counted) {
  Json out;
  for (const auto& [name, member] : members) out[name] = counted.*member;
  return out;
}
template <class Members, class Counted>
void read_counts(const Members& members, const Json& json, Counted& counted) {
  for (const auto& [name, member] : members) {
    using Count = std::remove_reference_t<decltype(counted.*member)>;
    counted.*member = sim::whole_number<Count>(json.at(name), name);
  }
}

Json unit_json(const sim::UnitReport& unit) {
  Json why = Json::array(), counters = Json::array();
  for (const auto& [reason, cycles] : unit.cycles_by_reason) why.push_back(cycles);
  for (const sim::CounterReport& counter : unit.counters) counters.push_back(counter.value);
  return {{"path", unit.path}, {"elapsed", unit.elapsed}, {"why", why}, {"counters", counters}};
}

void read_unit(const Json& json, sim::UnitReport& unit) {
  if (json.at("path") != unit.path) throw sim::InputError(fmt::format("there is no unit {}", unit.path));
  unit.elapsed = parse_count(json.at("elapsed"));
  const Json& why = parse_list(json.at("why"), unit.cycles_by_reason.size(), "a unit's reasons");
  for (std::size_t i = 0; i < unit.cycles_by_reason.size(); ++i) unit.cycles_by_reason[i].second = parse_count(why[i]);
  const Json& counters = parse_list(json.at("counters"), unit.counters.size(), "a unit's counters");
  for (std::size_t i = 0; i < unit.counters.size(); ++i) unit.counters[i].value = parse_count(counters[i]);
}

void read_span(const Json& json, MachineSpan& own) {
  own.time = parse_count(json.at("time"));
  const Json& units = parse_list(json.at("units"), own.units.size(), "units");
  for (std::size_t u = 0; u < own.units.size(); ++u) read_unit(units[u], own.units[u]);
  const Json& kernels = parse_list(json.at("kernels"), own.kernels.size(), "kernels");
  for (std::size_t k = 0; k < own.kernels.size(); ++k) read_counts(hw::KernelUse::kCounts, kernels[k], own.kernels[k]);
}

Json probe_json(const Probe& probe) { return {{"time", probe.time}, {"energy_pj", probe.energy_pj}}; }
Probe read_probe(const Json& json) { return {amount_in(json.at("time")), amount_in(json.at("energy_pj"))}; }

void read_function(const Json& json, RenderResult& function) {
  const Json& rays = parse_list(json.at("rays"), std::size(function.rays), "rays");
  for (std::size_t k = 0; k < std::size(function.rays); ++k) function.rays[k] = parse_count(rays[k]);
  function.continued = parse_count(json.at("continued"));
  function.traversal_steps = parse_count(json.at("traversal_steps"));
  read_counts(kSamplingCounts, json.at("sampling"), function.sampling);
}

}  // namespace

Json slice_json(const SlicePart& part) {
  const SliceResult& played = part.played;
  const RenderResult& function = part.rendered;
  Json units = Json::array(), kernels = Json::array();
  for (const sim::UnitReport& unit : played.own.units) units.push_back(unit_json(unit));
  for (const hw::KernelUse& use : played.own.kernels) kernels.push_back(counts_json(hw::KernelUse::kCounts, use));
  return {{"tiles", counts_json(kSliceTiles, played.slice)},
          {"time", played.own.time},
          {"units", units},
          {"kernels", kernels},
          {"before", probe_json(played.before)},
          {"after", probe_json(played.after)},
          {"function",
           {{"rays", std::span(function.rays)},
            {"continued", function.continued},
            {"traversal_steps", function.traversal_steps},
            {"sampling", counts_json(kSamplingCounts, function.sampling)}}},
          {"host",
           {{"slice_s", played.seconds},
            {"timing_s", played.timing_seconds},
            {"functional_s", function.seconds},
            {"waited_s", function.waited},
            {"wall_s", part.wall_seconds}}}};
}

SlicePart read_slice(const Json& json, MachineSpan initial_state) {
  try {
    SlicePart part;
    SliceResult& played = part.played;
    read_counts(kSliceTiles, json.at("tiles"), played.slice);
    played.own = std::move(initial_state);
    read_span(json, played.own);
    played.before = read_probe(json.at("before"));
    played.after = read_probe(json.at("after"));
    read_function(json.at("function"), part.rendered);
    const Json& host = json.at("host");
    played.seconds = amount_in(host.at("slice_s"));
    played.timing_seconds = amount_in(host.at("timing_s"));
    part.rendered.seconds = amount_in(host.at("functional_s"));
    part.rendered.waited = amount_in(host.at("waited_s"));
    part.wall_seconds = amount_in(host.at("wall_s"));
    return part;
  } catch (const sim::JsonError& error) {
    throw sim::InputError(sim::printable(error.what()));
  }
}

}  // namespace tools
