#include "tools/run/frame/run_job.h"

#include <algorithm>
#include <memory>
#include <thread>

#include "hw_models/machines/gpu.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/programs.h"
#include "sim/config/config.h"
#include "sim/host_clock.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/host/process.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/frame/machine_run.h"
#include "tools/run/frame/replay_program.h"
#include "tools/run/frame/trace_header.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/scene/bounds.h"
#include "traces/scenes/workload.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {
namespace {

/// Returns an empty in-memory trace for the work of a frame. `requested_by`: option, key or verb in errors. Throws
/// InputError if the machine sorts rays.
InMemoryTrace make_in_memory_trace(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                   const kernels::FrameProgram& frame, const char* requested_by) {
  refuse_sorting(inputs.config, requested_by);
  traces::TileScope scope{traces::links_of(inputs.image),
                          traces::counts_of(inputs.image),
                          0,
                          requirements.region_bytes,
                          requirements.raster,
                          requirements.build};
  scope.look_ups = inputs.config.gpu->tni.predictor.enabled;
  if (const traces::TileScope* recorded = scope_of(frame)) scope = *recorded;
  scope.kernels = static_cast<std::uint32_t>(kernels::kernel_catalogue().size());
  scope.tile_bytes = traces::most_tile_bytes(requirements);
  return {std::move(scope), inputs.config.limits.memory.bytes, requested_by};
}

/// Begins the section of this frame in the trace file; no effect if no trace is recorded.
void begin_part(const Inputs& inputs, const kernels::FrameRequirements& requirements, const SimulateOptions& extras) {
  if (extras.trace == nullptr) return;
  extras.trace->begin_part({inputs.frame, extras.reference}, traces::links_of(inputs.image),
                           traces::counts_of(inputs.image), requirements);
}

/// Returns the render settings of a frame, or of its reference.
kernels::RenderConfig render_settings_of(const Inputs& inputs, bool is_reference) {
  return is_reference ? reference_render(inputs.config.render) : inputs.config.render;
}

/// The frame program of the current frame, and the tile rates with which the run's first frame starts.
struct PreparedProgram {
  PreparedProgram(const Inputs& inputs, const kernels::ProgramSpec& spec, const SimulateOptions& extras)
      : first(inputs.config.programs.multirate),
        programs(extras.reference ? reference_programs(inputs.config.programs) : inputs.config.programs),
        frame(kernels::make_program(
            spec, {inputs.image, inputs.camera, render_settings_of(inputs, extras.reference), programs,
                   extras.rates != nullptr ? *extras.rates : first, inputs.frame, inputs.scene_size,
                   inputs.config.build.engine == traces::BuildEngine::kHost ? nullptr : &inputs.builds,
                   extras.history != nullptr ? extras.history->get() : nullptr})) {
    if (extras.marks) frame->enable_marks();
  }
  /// Keeps what the next frame's program needs of the finished frame.
  void keep_state(const RenderResult& rendered, const SimulateOptions& extras) const {
    if (extras.rates != nullptr) extras.rates->update_rates(rendered.sampling);
    if (extras.history != nullptr) *extras.history = frame->make_history();
  }
  const kernels::RateMap first;
  const kernels::ProgramConfig programs;
  const std::unique_ptr<kernels::FrameProgram> frame;
};

/// Fills the machine's caches with the contents after the previous frame: `extras.caches` if given, otherwise what the
/// last tiles of `previous` leave.
void warm_start(hw::Gpu& gpu, kernels::FrameProgram& previous, const traces::Tracer& tracer, std::uint32_t threads,
                const SimulateOptions& extras) {
  if (extras.caches) return gpu.set_cache_contents(*extras.caches);
  if (extras.progress != nullptr) extras.progress->set_phase("warming caches");
  warm_with_last_tiles(gpu, previous, tracer, host_threads(threads) - 1);
}

float scene_size_in_frame_0(traces::Scene& scene, const traces::WorkloadConfig& workload) {
  if (workload.first_frame != 0) traces::pose_workload(scene, workload, 0);
  const traces::Bounds bounds = traces::world_bounds(scene);
  if (workload.first_frame != 0) traces::pose_workload(scene, workload, workload.first_frame);
  const glm::vec3 sides = bounds.upper - bounds.lower;
  return std::max({sides.x, sides.y, sides.z});
}

/// Simulates recorded work at each of the governor's clocks. `start`: contents of the caches at the start; null: empty.
std::vector<SustainStep> simulate_clocks(const Inputs& inputs, const kernels::FrameRequirements& requirements,
                                         const InMemoryTrace& work, const FrameResult& plain,
                                         const std::shared_ptr<const hw::CacheContents>& start, std::uint32_t threads,
                                         Progress* progress) {
  const std::vector<RunConfig> configs = governor_configs(inputs.config);
  std::vector<MachineVariant> variants;
  for (const RunConfig& config : configs) variants.push_back({config, {}, {}, start});
  const std::vector<FrameResult> played =
      simulate_variants(inputs, requirements, work, plain, variants, "simulating", threads, progress);
  std::vector<SustainStep> steps;
  const std::vector<double> factors = governor_factors(inputs.config.thermal);
  for (std::size_t i = 0; i < played.size(); ++i) {
    const FrameResult& frame = played[i];
    steps.push_back({factors[i], {sustain_frame(configs[i], frame.energy, frame.units, frame.elapsed)}});
  }
  return steps;
}

/// True if geometry moves from the frame before the first frame of a run to the first frame. Frame 0 has no frame
/// before it, and moves as frame 1 does. Leaves the scene as it was.
bool moves_before_first_frame(traces::Scene& scene, const traces::WorkloadConfig& workload) {
  if (scene.tracks.empty()) return false;
  const std::uint32_t first = workload.first_frame;
  traces::pose_workload(scene, workload, first == 0 ? 1 : first - 1);
  return traces::pose_workload(scene, workload, first).geometry;
}

/// True if the tree of a frame whose scene has moved is refitted instead of rebuilt.
bool is_refit(const Inputs& in) {
  const traces::BuildConfig& build = in.config.build;
  switch (build.policy) {
    case traces::BuildPolicy::kUpdate:
      break;
    case traces::BuildPolicy::kRefit:
      return true;
    case traces::BuildPolicy::kRebuild:
      return false;
    case traces::BuildPolicy::kPeriod:
      return in.frame % build.period != 0;
    case traces::BuildPolicy::kCost:
      return std::ranges::all_of(traces::cost_growth(in.built_costs, in.costs),
                                 [&](double growth) { return growth <= 1 + build.cost_growth; });
  }
  return in.config.bvh.update == traces::BvhUpdate::kRefit;
}

/// Records the cost of the trees after an update, if the policy or the report needs it.
void note_tree_costs(Inputs& in, bool refit) {
  const traces::BuildConfig& build = in.config.build;
  if (build.policy != traces::BuildPolicy::kCost && build.engine == traces::BuildEngine::kHost) return;
  in.refitted = refit;
  in.costs = traces::tree_costs(in.image, in.config.bvh);
  if (!refit) in.built_costs = in.costs;
}

/// Records the trees that the machine builds or refits for the current frame of `scene`.
void note_built_trees(Inputs& in, const traces::Scene& scene, bool refit) {
  const traces::BuildConfig& build = in.config.build;
  if (build.engine == traces::BuildEngine::kHost) return;
  in.builds =
      traces::tree_builds(in.image, refit, build.overlap == traces::BuildOverlap::kOn, in.config.bvh.ploc_radius);
  in.builds.engine = build.engine;
  in.builds.morton_bits = in.config.bvh.morton_bits;
  in.builds.pose = traces::pose_work(scene, in.config.bvh.instances);
}

}  // namespace

std::uint32_t host_threads(std::uint32_t wanted) {
  return wanted != 0 ? wanted : std::max(1U, std::thread::hardware_concurrency());
}

kernels::RenderConfig reference_render(kernels::RenderConfig render) {
  render.effect_rate = kernels::EffectRate::kFull;
  return render;
}

kernels::ProgramConfig reference_programs(kernels::ProgramConfig programs) {
  programs.denoise.filter = kernels::DenoiseFilter::kOff;
  return programs;
}

Inputs load_inputs(const JobOptions& options, Progress* progress) {
  if (progress != nullptr) progress->set_phase("loading");
  const RunConfig config = load_run_config(options);
  Inputs in = load_inputs(config, options.threads, progress);
  add_warnings(in.warnings, ineffective_setting_warnings(options, config));
  add_warnings(in.warnings, technology_table_warnings(config));
  add_warnings(in.warnings, tree_builder_warnings(config));
  return in;
}

Inputs load_inputs(const RunConfig& config, std::uint32_t threads, Progress* progress) {
  const auto phase = [&](const char* what) {
    if (progress != nullptr) progress->set_phase(what);
  };
  phase("loading");
  Inputs in;
  in.config = config;
  const sim::HostClock::time_point begin = sim::HostClock::now();
  traces::Scene scene = traces::open_workload(in.config.scene, in.config.limits);
  in.frame = in.config.scene.first_frame;
  in.scene_size = scene_size_in_frame_0(scene, in.config.scene);
  const bool charges = in.config.build.engine != traces::BuildEngine::kHost;
  const bool moves = charges && moves_before_first_frame(scene, in.config.scene);
  in.camera = scene.cameras.front();
  in.scene = traces::scene_info(scene);
  in.scene.name = sim::with_escaped_bytes(in.scene.name);
  in.scene_sha256 = scene.sha256;
  in.warnings = scene.warnings;
  if (in.frames() > 1 && scene.tracks.empty() && in.config.scene.camera_path == traces::CameraPath::kScene) {
    in.warnings.emplace_back(
        "all frames are equal: the scene has no animation; scene.camera_path=orbit moves the camera");
  }
  phase("building the tree");
  in.image = traces::build_memory_image(scene, in.config.bvh, host_threads(threads), is_interrupted,
                                        in.config.render.mip_maps, in.config.render.roughness());
  in.bvh_hash = traces::bvh_hash(in.image);
  in.stored_triangles = in.image.triangles.size();
  in.parents = traces::parent_indices(in.image);
  in.builds.engine = in.config.build.engine;
  note_tree_costs(in, false);
  if (moves) note_built_trees(in, scene, false);
  if (in.frames() > 1) in.moving = std::move(scene);
  in.load_seconds = sim::seconds_since(begin);
  return in;
}

void print_warnings(const std::vector<std::string>& lines, Progress* progress) {
  if (progress == nullptr) return;
  for (const std::string& line : lines) progress->print_line("raywatt: warning: " + line);
}

std::string inputs_text(const RunConfig& config) {
  std::string key;
  for (const sim::FieldInfo& field : sim::list_fields(config)) {
    const auto is_of = [&](std::string_view group) { return field.path.starts_with(group); };
    if (is_of("scene.") || is_of("bvh.") || is_of("build.") || is_of("limits.") || field.path == "render.mip_maps" ||
        field.path == "render.rough_reflections") {
      key += field.path + "=" + field.value + "\n";
    }
  }
  return key;
}

bool pose_frame(Inputs& in, std::uint32_t frame) {
  if (in.frame == frame) return false;
  const sim::HostClock::time_point begin = sim::HostClock::now();
  const traces::Moved moved = traces::pose_workload(in.moving, in.config.scene, frame);
  in.frame = frame;
  in.builds = {.engine = in.config.build.engine, .pose = {}, .trees = {}, .sizes = {}};
  in.camera = in.moving.cameras.front();
  if (moved.lights) in.image.lights = in.moving.lights;
  in.update_seconds += sim::seconds_since(begin);
  return moved.geometry;
}

void update_tree(Inputs& in, std::uint32_t threads, Progress* progress) {
  if (progress != nullptr) progress->set_phase("building the tree");
  const sim::HostClock::time_point begin = sim::HostClock::now();
  const bool refit = is_refit(in);
  traces::BvhConfig bvh = in.config.bvh;
  bvh.update = refit ? traces::BvhUpdate::kRefit : traces::BvhUpdate::kRebuild;
  traces::update_memory_image(in.moving, bvh, host_threads(threads), in.image, is_interrupted);
  in.parents = traces::parent_indices(in.image);
  note_tree_costs(in, refit);
  note_built_trees(in, in.moving, refit);
  in.update_seconds += sim::seconds_since(begin);
}

void go_to_frame(Inputs& in, std::uint32_t frame, std::uint32_t threads, Progress* progress) {
  if (in.frame == frame) return;
  const bool has_old_tree = pose_frame(in, frame == 0 ? 1 : frame - 1);
  const bool moved = pose_frame(in, frame);
  if (moved || has_old_tree) update_tree(in, threads, progress);
  if (!moved) in.builds = {.engine = in.config.build.engine, .pose = {}, .trees = {}, .sizes = {}};
}

bool advance_frame(Inputs& in, std::uint32_t threads, Progress* progress) {
  if (in.frame == in.config.scene.last_frame) return false;
  go_to_frame(in, in.frame + 1, threads, progress);
  return true;
}

kernels::TileGridSize tile_grid_size(const Inputs& inputs, const kernels::ProgramSpec& program) {
  return PreparedProgram(inputs, program, {}).frame->tile_grid_size();
}

std::uint64_t FrameResult::rays() const { return rendered.all_rays(); }
double FrameResult::time_ms() const { return static_cast<double>(elapsed) / sim::kFemtosecondsPerMillisecond; }
double FrameResult::energy_mj() const { return energy.total_pj.nominal / sim::kPicojoulesPerMillijoule; }

void FrameResult::add(const FrameResult& frame) {
  frames += frame.frames;
  rendered.add(frame.rendered);
  sim::add_reports(units, frame.units);
  for (std::size_t k = 0; k < kernel_use.size(); ++k) kernel_use[k] += frame.kernel_use[k];
  energy += frame.energy;
  cycles += frame.cycles;
  elapsed += frame.elapsed;
  wall_seconds += frame.wall_seconds;
  replicate_seconds += frame.replicate_seconds;
  if (sampled) sampled->add(*frame.sampled);
  if (sliced) sliced->add(*frame.sliced);
  if (denoise && frame.denoise) {
    denoise->time += frame.denoise->time;
    denoise->dram_bytes += frame.denoise->dram_bytes;
    denoise->energy_pj += frame.denoise->energy_pj;
  }
  for (std::size_t i = 0; i < replicates.size(); ++i) replicates[i].add(frame.replicates[i]);
  for (std::size_t i = 0; i < sustained.size(); ++i) {
    sustained[i].frames.insert(sustained[i].frames.end(), frame.sustained[i].frames.begin(),
                               frame.sustained[i].frames.end());
  }
}

FrameResult simulate_frame(const Inputs& inputs, const kernels::ProgramSpec& program, std::uint32_t threads,
                           const SimulateOptions& extras) {
  const PreparedProgram made(inputs, program, extras);
  const traces::BvhTracer tracer(inputs.image, inputs.config.gpu->tni.predictor);
  SimulateOptions own = extras;
  std::optional<PreparedProgram> previous;
  if (inputs.config.frame.start == FrameStart::kWarm && !extras.caches) {
    own.previous = previous.emplace(inputs, program, extras).frame.get();
  }
  FrameResult s = simulate_program(inputs, program, *made.frame, tracer, threads, own);
  if (!s.is_partial()) made.keep_state(s.rendered, extras);
  return s;
}

FrameResult simulate_program(const Inputs& inputs, const kernels::ProgramSpec& program, kernels::FrameProgram& frame,
                             const traces::Tracer& tracer, std::uint32_t threads, const SimulateOptions& extras) {
  const sim::HostClock::time_point begin = sim::HostClock::now();
  FrontEnd front_end(frame, tracer, host_threads(threads) - 1, true, {}, extras.itemised);
  RunTiles tiles(front_end, frame.tiles(), extras.progress, extras.keep_part);
  const kernels::FrameRequirements requirements = frame.requirements();
  std::optional<InMemoryTrace> kept;
  const bool sustains = inputs.config.thermal.minutes > 0 && !extras.reference;
  if (extras.replicates > 1 || sustains) {
    const char* by = extras.replicates > 1 ? extras.requested_by : "thermal.minutes";
    kept.emplace(make_in_memory_trace(inputs, requirements, frame, by));
  }
  begin_part(inputs, requirements, extras);
  tiles.set_recorders(extras.trace, kept ? &*kept : nullptr);
  hw::TileAccounting accounting(extras.itemised ? frame.tiles() : 0);
  hw::ObserverList observers;
  if (extras.itemised) observers.add(&accounting);
  observers.add(extras.observer);
  const std::unique_ptr<hw::Gpu> gpu = make_gpu(inputs, requirements, tiles, {}, observers.attached_observer());
  check_tables(*gpu, inputs.config);  // reports missing table entries before the simulation
  const bool is_warm = inputs.config.frame.start == FrameStart::kWarm;
  if (is_warm) warm_start(*gpu, extras.previous != nullptr ? *extras.previous : frame, tracer, threads, extras);
  std::shared_ptr<const hw::CacheContents> start;
  if (is_warm && kept) start = std::make_shared<const hw::CacheContents>(gpu->cache_contents());
  if (extras.intervals != nullptr) gpu->machine().record_intervals(*extras.intervals);
  tiles.begin_part("simulating", inputs.frame);
  tiles.set_gpu(*gpu);
  if (extras.on_start) extras.on_start({front_end, gpu->unit_reports(), extras.intervals});
  run_to_end(*gpu);
  if (extras.trace != nullptr && tiles.finished_tiles() == frame.tiles()) {
    extras.trace->end_part(recorded_result(front_end.result()));
  }

  FrameResult s;
  s.program = program;
  if (!inputs.costs.empty()) {
    const double growth = traces::cost_growth(inputs.built_costs, inputs.costs).front();
    s.tree = MovedTree{inputs.refitted, inputs.costs.front(), growth};
  }
  s.machine = inputs.config.gpu;
  s.rendered = front_end.result();
  collect_results(*gpu, inputs.config, s);
  if (is_warm) s.caches = std::make_shared<const hw::CacheContents>(gpu->cache_contents());
  s.tile_accounts = accounting.take_accounts();
  s.rest = accounting.account_without_tile();
  s.wall_seconds = sim::seconds_since(begin);
  s.tiles = frame.tiles();
  s.finished_tiles = tiles.finished_tiles();
  if (!kept || s.is_partial()) return s;
  try {
    if (sustains) {
      s.sustained = simulate_clocks(inputs, requirements, *kept, s, start, host_threads(threads), extras.progress);
    }
    if (extras.replicates > 1) {
      s.replicates = simulate_replicates(inputs, requirements, *kept, {s, gpu->scheduled_kernels(), start},
                                         extras.replicates - 1, host_threads(threads), extras.progress);
    }
    s.replicate_seconds = sim::seconds_since(begin) - s.wall_seconds;
  } catch (const Interrupted&) {
    if (!extras.keep_part) throw;
  }
  return s;
}

struct RecordedFrame::Work {
  kernels::FrameRequirements requirements;
  InMemoryTrace trace;
  FrameResult plain;
};

RecordedFrame::RecordedFrame(const Inputs& inputs, const kernels::ProgramSpec& program, const char* requested_by,
                             std::uint32_t threads, Progress* progress)
    : inputs_(inputs), threads_(threads), progress_(progress) {
  const PreparedProgram made(inputs, program, {});
  const traces::BvhTracer tracer(inputs.image, inputs.config.gpu->tni.predictor);
  FrontEnd front_end(*made.frame, tracer, host_threads(threads));
  RunTiles tiles(front_end, made.frame->tiles(), progress);
  const kernels::FrameRequirements requirements = made.frame->requirements();
  work_ = std::make_unique<Work>(
      Work{requirements, make_in_memory_trace(inputs, requirements, *made.frame, requested_by), {}});
  tiles.set_recorders(nullptr, &work_->trace);
  tiles.begin_part("rendering", inputs.frame);
  while (const traces::TileWork* work = tiles.next()) tiles.release_work(work);
  work_->plain.program = program;
  work_->plain.rendered = front_end.result();
  work_->plain.tiles = work_->plain.finished_tiles = made.frame->tiles();
}

RecordedFrame::~RecordedFrame() = default;

std::vector<FrameResult> RecordedFrame::simulate(std::span<const RunConfig> configs) const {
  std::vector<MachineVariant> plays;
  for (const RunConfig& config : configs) plays.push_back({config, {}, {}, {}});
  return simulate_variants(inputs_, work_->requirements, work_->trace, work_->plain, plays, "simulating", threads_,
                           progress_);
}

RenderResult render_frame(const Inputs& inputs, const kernels::ProgramSpec& program, const traces::Tracer& tracer,
                          std::uint32_t threads, const SimulateOptions& extras) {
  const PreparedProgram made(inputs, program, extras);
  // A predictor's table consists of what recorded rays have found.
  const bool records = extras.trace != nullptr || tracer.ray_predictor() != nullptr;
  FrontEnd front_end(*made.frame, tracer, host_threads(threads), records);
  RunTiles tiles(front_end, made.frame->tiles(), extras.progress);
  begin_part(inputs, made.frame->requirements(), extras);
  tiles.set_recorders(extras.trace, nullptr);
  tiles.begin_part("rendering", inputs.frame);
  while (const traces::TileWork* work = tiles.next()) tiles.release_work(work);
  if (extras.trace != nullptr) extras.trace->end_part(recorded_result(front_end.result()));
  made.keep_state(front_end.result(), extras);
  return front_end.result();
}

}  // namespace tools
