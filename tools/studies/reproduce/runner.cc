#include "tools/studies/reproduce/runner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hw_models/dram/dram_channel.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/ist.h"
#include "hw_models/tni/predictor_stage.h"
#include "hw_models/tni/trv.h"
#include "shader_kernels/programs/program_spec.h"
#include "shader_kernels/programs/wavefront/wavefront.h"
#include "sim/error.h"
#include "sim/report/energy.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report.h"
#include "tools/analysis/units.h"
#include "tools/host/parallel.h"
#include "tools/run/frame/ground_truth.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/node_format.h"
#include "traces/scene/images.h"

namespace tools::reproduce {
namespace {

using traces::MaterialRecord;

constexpr float kMirrored = 0.3F;  ///< share of the light that a material reflects after it was changed to a mirror
constexpr double kTolerance = 0.01;
constexpr std::uint32_t kProbePixels = 96;  ///< width of the small picture in which reflecting pixels are counted

void make_mirror(MaterialRecord& m) {
  m.mirrored = glm::vec3(kMirrored);
  m.diffuse_share = 1 - kMirrored;
  m.flags |= traces::kMirror;
}

void make_diffuse(MaterialRecord& m) {
  m.mirrored = glm::vec3(0);
  m.diffuse_share = 1;
  m.flags = (m.flags & ~std::uint32_t{traces::kMirror}) | traces::kDiffuse;
}

bool is_kept_material(const MaterialRecord& m) {
  constexpr std::uint32_t kOthers = traces::kGlass | traces::kPhysical | traces::kBlended;
  return m.entering > 0 || (m.flags & kOthers) != 0;
}

}  // namespace

double reflective_share(Inputs& inputs, std::uint32_t threads) {
  kernels::RenderConfig& config = inputs.config.render;
  const kernels::RenderConfig before = config;
  config.height = std::max(1U, kProbePixels * config.height / config.width);
  config.width = kProbePixels;
  config.depth = 2;
  const double pixels = static_cast<double>(config.width) * config.height;
  const RenderResult result = render_frame(inputs, {}, traces::BvhTracer(inputs.image), threads);
  config = before;
  return static_cast<double>(result.rays[static_cast<std::size_t>(traces::RayKind::kReflection)]) / pixels;
}

void set_reflective_share(Inputs& inputs, double share, std::uint32_t threads) {
  std::vector<MaterialRecord>& materials = inputs.image.materials;
  const std::vector<MaterialRecord> originals = materials;
  for (MaterialRecord& m : materials) {
    if (!is_kept_material(m)) make_diffuse(m);
  }
  double reached = reflective_share(inputs, threads);
  const double of_glass = reached;

  std::vector<std::pair<double, std::size_t>> covers;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (is_kept_material(materials[i])) continue;
    make_mirror(materials[i]);
    covers.emplace_back(reflective_share(inputs, threads) - of_glass, i);
    make_diffuse(materials[i]);
  }
  std::ranges::sort(covers, [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  for (const auto& [cover, i] : covers) {
    if (reached + cover > share + kTolerance) continue;
    reached += cover;
    materials[i] = originals[i];
    if ((materials[i].flags & traces::kMirror) == 0) make_mirror(materials[i]);
  }
}

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kTruthSamples = 256;  ///< source: Jin 2009, table 2

Measured measure_metric(const Metric& metric, const Comparison& c) {
  if (metric.machine && !c.run.machine) return {{}, "not simulated: functional only"};
  if (const std::optional<double> value = metric.measure(c)) return {value, {}};
  return {{}, c.squared_error == 0.0 ? "identical" : "nothing to measure"};
}

/// Returns a picture of four times the difference of two pictures, sRGB-encoded, 8 bits per channel.
std::vector<std::uint8_t> difference_picture(std::span<const float> a, std::span<const float> b) {
  constexpr float kGain = 4;
  std::vector<std::uint8_t> out(a.size());
  std::ranges::transform(a, b, out.begin(), [](float x, float y) {
    const float encoded = std::min(1.0F, kGain * std::abs(srgb_encoded(x) - srgb_encoded(y)));
    return static_cast<std::uint8_t>(std::lround(255 * encoded));
  });
  return out;
}

/// Returns a square detail of a picture, enlarged eight times. Sets `side` to its side in pixels.
std::vector<std::uint8_t> crop_picture(const std::vector<std::uint8_t>& picture, const Case& c, const Crop& crop,
                                       std::uint32_t& side) {
  constexpr std::uint32_t kEnlarged = 8;
  const std::uint32_t pixels =
      std::clamp(static_cast<std::uint32_t>(std::lround(crop.side * c.height)), 1U, std::min(c.width, c.height));
  const auto first = [&](double centre, std::uint32_t extent) {
    const auto from = std::lround(centre * extent - 0.5 * pixels);
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(from, 0, extent - pixels));
  };
  const std::uint32_t x0 = first(crop.x, c.width), y0 = first(crop.y, c.height);
  side = kEnlarged * pixels;
  std::vector<std::uint8_t> out;
  out.reserve(std::size_t{3} * side * side);
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::size_t at = 3 * (std::size_t{y0 + y / kEnlarged} * c.width + x0 + x / kEnlarged);
      out.insert(out.end(), {picture[at], picture[at + 1], picture[at + 2]});
    }
  }
  return out;
}

std::string key_of(const Case& c, const ProgramSetup& program) {
  const std::string bounce =
      c.bounce ? fmt::format(" (bounce {}{})", c.bounce->number, c.bounce->shadows ? " shadows" : "") : "";
  return program.program_text() + (c.machine ? "" : " (picture)") + bounce;
}

/// Returns a text with characters replaced that are not allowed in file names.
std::string file_name_text(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return std::string_view(" ,:").find(c) != std::string_view::npos; }, '-');
  return text;
}

}  // namespace

std::string Runner::find_stand_in_scene(const View& view) const {
  std::error_code unreadable;
  for (const std::string& file : view.files) {
    if (options_.scenes.empty()) break;
    if (fs::exists(options_.scenes / file, unreadable)) return (options_.scenes / file).string();
  }
  if (!view.stand_in.empty()) return view.stand_in;
  if (options_.scenes.empty()) {
    throw sim::InputError(
        fmt::format("no built-in scene replaces it; allowed: --scenes DIR with {}", fmt::join(view.files, " or ")));
  }
  throw sim::InputError(fmt::format("{}: there is no {}", options_.scenes.string(), fmt::join(view.files, " or ")));
}

JobOptions Runner::job_options(const Case& c, const ProgramSetup& program) const {
  JobOptions job;
  job.config = options_.config;
  job.scene = find_stand_in_scene(c.view);
  job.camera = c.view.camera;
  job.frames = c.view.frame;
  job.resolution = fmt::format("{}x{}", c.width, c.height);
  job.sets = c.view.sets;
  job.sets.insert(job.sets.end(), program.sets.begin(), program.sets.end());
  job.threads = options_.threads;
  return job;
}

void Runner::set_view(const Case& c) {
  if (inputs_ && c.view == view_ && c.width == width_ && c.height == height_) return;
  results_by_program_.clear();
  bounces_.clear();
  truth_.clear();
  masks_.clear();
  width_ = c.width;
  height_ = c.height;
  if (!inputs_ || c.view != view_) load_scene(c, {});
}

void Runner::load_scene(const Case& c, const ProgramSetup& program) {
  inputs_.reset();
  reflective_share_.reset();
  view_ = c.view;
  inputs_ = load_inputs(job_options(c, program), progress_);
  inputs_key_ = inputs_text(inputs_->config);
  if (c.view.mirrors != 0) {
    set_reflective_share(*inputs_, c.view.mirrors / 100.0, options_.threads);
    reflective_share_ = reflective_share(*inputs_, options_.threads);
  }
}

const ProgramResult& Runner::result_of(const Case& c, const ProgramSetup& program) {
  const std::string key = key_of(c, program);
  const auto found = results_by_program_.find(key);
  if (found != results_by_program_.end()) return found->second;
  const kernels::ProgramSpec spec = kernels::parse_program(program.name);
  const RunConfig config = load_run_config(job_options(c, program));
  if (inputs_text(config) != inputs_key_) load_scene(c, program);
  inputs_->config = config;
  ProgramResult out;
  const std::uint64_t records = traces::node_records(inputs_->image.nodes.size(), config.bvh.boxes);
  out.box_bytes = records * traces::box_bytes(config.bvh.box_numbers(), config.bvh.boxes);
  out.node_bytes = inputs_->image.node_array_bytes();
  out.bytes_per_triangle = traces::bytes_per_triangle(inputs_->image);
  out.pixels = std::uint64_t{c.width} * c.height;
  out.machine = c.machine;
  const SimulateOptions extras{.marks = !c.picture.empty(), .progress = progress_};
  if (c.bounce) {
    play_bounce(c, program, out);
  } else if (c.machine) {
    out.simulation = simulate_frame(*inputs_, spec, options_.threads, extras);
    if (!config.area.arrays.empty()) {
      out.area_mm2 = sim::compute_area(out.simulation.units, config.energy, config.area).total.nominal;
    }
  } else {
    out.simulation.program = spec;
    out.simulation.rendered = render_frame(*inputs_, spec, traces::BvhTracer(inputs_->image), options_.threads, extras);
  }
  return results_by_program_.emplace(key, std::move(out)).first->second;
}

void Runner::play_bounce(const Case& c, const ProgramSetup& program, ProgramResult& out) {
  if (bounces_.empty() || bounces_program_ != program.program_text()) {
    bounces_ = record_bounces(*inputs_, kernels::parse_program(program.name));
    bounces_program_ = program.program_text();
  }
  if (c.bounce->number >= bounces_.size()) return;
  const BounceRays& bounce = bounces_[c.bounce->number];
  const std::vector<traces::Ray>& rays = c.bounce->shadows ? bounce.shadows : bounce.paths;
  const traces::RayKind kind = c.bounce->shadows ? traces::RayKind::kShadow : traces::RayKind::kReflection;
  out.bounce_rays = rays.size();
  out.lines_per_1000_rays = lines_per_thousand_rays(*inputs_, rays, kind);
  PlayedRays played = play_rays(*inputs_, rays, kind);
  out.simulation.units = std::move(played.units);
  out.simulation.cycles = played.cycles;
}

const std::vector<float>& Runner::truth_picture(const Case& c) {
  if (truth_.empty()) {
    inputs_->config = load_run_config(job_options(c, {}));
    truth_ = ground_truth(*inputs_, kTruthSamples, options_.threads, cache_folder(), progress_);
  }
  return truth_;
}

const std::vector<Mask>& Runner::pixel_masks(const Case& c) {
  if (masks_.empty()) {
    inputs_->config = load_run_config(job_options(c, {}));
    masks_ = classify_pixels(*inputs_, host_threads(options_.threads));
  }
  return masks_;
}

std::vector<Measured> Runner::measure_case(const Case& c) {
  set_view(c);
  const ProgramResult& run = result_of(c, c.run);
  const ProgramResult& reference = result_of(c, c.reference);
  const std::vector<float>& other = c.truth ? truth_picture(c) : reference.simulation.rendered.rgb;
  Comparison comparison{.run = run,
                        .reference = reference,
                        .squared_error = c.bounce ? 0 : mean_squared_error(run.simulation.rendered.rgb, other),
                        .reflective_share = reflective_share_};
  if (std::ranges::any_of(c.metrics, [](const PaperMetric& f) { return needs_masks(f.metric); })) {
    comparison.masked = masked_errors(pixel_masks(c), run.simulation.rendered.rgb, other);
  }
  std::vector<Measured> out;
  for (const PaperMetric& metric : c.metrics) out.push_back(measure_metric(find_metric(metric.metric), comparison));
  return out;
}

void Runner::write_pictures(const Case& c, const fs::path& folder) const {
  if (c.picture.empty()) return;
  const auto write = [&](const std::string& name, const std::vector<std::uint8_t>& picture) {
    traces::write_png(folder / fmt::format("figure-{}.png", file_name_text(name)), c.width, c.height, picture);
    for (const Crop& crop : c.crops) {
      std::uint32_t side = 0;
      const std::vector<std::uint8_t> part = crop_picture(picture, c, crop, side);
      const std::string file = file_name_text(fmt::format("figure-{}-{}.png", name, crop.name));
      traces::write_png(folder / file, side, side, part);
    }
  };
  const FrameResult& simulation = results_by_program_.at(key_of(c, c.run)).simulation;
  const std::vector<float>& run = simulation.rendered.rgb;
  write(c.picture, to_rgb8(run));
  for (const DebugPicture& p : debug_pictures(simulation.program, simulation.rendered, c.width, c.height)) {
    const std::string name = file_name_text(fmt::format("{}-{}", c.picture, p.name));
    traces::write_png(folder / fmt::format("figure-{}.png", name), p.width, p.height, p.rgb);
  }
  const std::vector<float>& other =
      c.truth ? truth_ : results_by_program_.at(key_of(c, c.reference)).simulation.rendered.rgb;
  const std::string frame = c.view.frame.empty() ? "" : "-" + c.view.frame;
  write(fmt::format("reference-{}{}-{}", c.view.scene, frame, c.truth ? "truth" : c.reference.name), to_rgb8(other));
  write(c.picture + "-difference", difference_picture(run, other));
}

namespace {

using Value = std::optional<double>;
using Shown = Metric::Shown;

Value ratio_of(double a, double b) {
  if (b == 0) return {};
  return a / b;
}
Value ratio_of(std::uint64_t a, std::uint64_t b) { return ratio_of(static_cast<double>(a), static_cast<double>(b)); }

double tni_energy_pj(const ProgramResult& o) { return o.simulation.energy.blocks.at("tni").total().nominal; }
/// Returns the energy of an area block in pJ; 0 if the machine does not have the block.
double block_energy_pj(const ProgramResult& o, const std::string& block) {
  const auto found = o.simulation.energy.blocks.find(block);
  return found == o.simulation.energy.blocks.end() ? 0 : found->second.total().nominal;
}
double total_energy_pj(const ProgramResult& o) { return o.simulation.energy.total_pj.nominal; }

/// Returns a counter of the T&I units' first-level caches, summed over all units.
std::uint64_t l1_counter(const ProgramResult& o, std::uint64_t hw::FetchStats::*counter) {
  return Units<hw::Trv>(o.simulation.units).sum_of(counter) + Units<hw::Ist>(o.simulation.units).sum_of(counter);
}

std::uint64_t dram_bytes_of(const ProgramResult& o) {
  return Units<hw::DramChannel>(o.simulation.units).sum_of(&hw::DramChannel::Stats::bytes);
}
std::uint64_t visits_of(const ProgramResult& o) {
  return Units<hw::Trv>(o.simulation.units).sum_of(&hw::Trv::Stats::visits);
}
std::uint64_t triangle_tests_of(const ProgramResult& o) {
  return Units<hw::Ist>(o.simulation.units).sum_of(&hw::Ist::Stats::tests);
}
std::uint64_t trv_counter(const ProgramResult& o, std::uint64_t hw::Trv::Stats::*counter) {
  return Units<hw::Trv>(o.simulation.units).sum_of(counter);
}
/// Returns a counter of prefetches, summed over the caches of nodes and of triangles.
std::uint64_t prefetch_counter(const ProgramResult& o, std::uint64_t hw::Trv::Stats::*nodes,
                               std::uint64_t hw::Ist::Stats::*triangles) {
  return trv_counter(o, nodes) + Units<hw::Ist>(o.simulation.units).sum_of(triangles);
}
std::uint64_t prefetches_of(const ProgramResult& o) {
  return prefetch_counter(o, &hw::Trv::Stats::prefetches, &hw::Ist::Stats::prefetches);
}
/// Returns the number of prefetched lines that a ray read, or needed before they arrived; 0 without a prefetcher.
std::uint64_t needed_prefetches(const ProgramResult& o) {
  if (prefetches_of(o) == 0) return 0;
  return prefetch_counter(o, &hw::Trv::Stats::prefetches_useful, &hw::Ist::Stats::prefetches_useful) +
         prefetch_counter(o, &hw::Trv::Stats::prefetches_late, &hw::Ist::Stats::prefetches_late);
}
std::uint64_t predictor_counter(const ProgramResult& o, std::uint64_t hw::PredictorStage::Stats::*counter) {
  return Units<hw::PredictorStage>(o.simulation.units).sum_of(counter);
}
/// Returns the share of the lines read by units of one kind that hit the L1 at the first probe.
template <class Unit>
Value first_hits(const ProgramResult& o) {
  const Units<Unit> units(o.simulation.units);
  const Value late = ratio_of(units.sum_of(&hw::FetchStats::l1_late),
                              units.sum_of(&hw::FetchStats::l1_hits) + units.sum_of(&hw::FetchStats::rau_reads));
  return late ? Value(1 - *late) : Value();
}
std::uint64_t lines_filled(const ProgramResult& o) { return l1_counter(o, &hw::FetchStats::l1_fills); }
/// Returns the share of the cache lines read by T&I units that hit the L1 at the first probe.
double l1_first_probe_hit_rate(const ProgramResult& o) {
  const std::uint64_t lines = l1_counter(o, &hw::FetchStats::l1_hits) + l1_counter(o, &hw::FetchStats::rau_reads);
  return 1 - ratio_of(l1_counter(o, &hw::FetchStats::l1_late), lines).value_or(0);
}
double l1_hit_rate(const ProgramResult& o) {
  return ratio_of(l1_counter(o, &hw::FetchStats::l1_hits), l1_counter(o, &hw::FetchStats::l1_accesses)).value_or(0);
}

/// Returns the number of operations of all classes that the shader cores' functional units executed.
double srp_operations(const ProgramResult& o) {
  using Stats = hw::Srp::Stats;
  const Units<hw::Srp> cores(o.simulation.units);
  double all = 0;
  for (const auto counter :
       {&Stats::fp_add, &Stats::fp_mul, &Stats::fp_mul_add, &Stats::fp_div_sqrt, &Stats::fp_compare, &Stats::int_add,
        &Stats::int_mul, &Stats::int_logic, &Stats::int_shift, &Stats::convert}) {
    all += static_cast<double>(cores.sum_of(counter));
  }
  return all;
}
Value ops_of_traced(const Comparison& c) {
  return ratio_of(srp_operations(c.reference), static_cast<double>(c.run.sampling_counts().wanted));
}
/// Returns the mean number of shader-core operations per interpolated sample. Assumes that a traced sample takes as
/// many operations as in the reference run.
Value ops_of_interpolated(const Comparison& c) {
  const auto traced = static_cast<double>(c.run.sampling_counts().traced);
  return ratio_of(srp_operations(c.run) - traced * ops_of_traced(c).value_or(0),
                  static_cast<double>(c.run.sampling_counts().wanted) - traced);
}

Value speedup_of(const Comparison& c) { return ratio_of(c.reference.simulation.cycles, c.run.simulation.cycles); }
Value work_ratio(const Comparison& c) {
  return ratio_of(c.run.simulation.rendered.traversal_steps, c.reference.simulation.rendered.traversal_steps);
}
Value tni_perf_per_watt(const Comparison& c) { return ratio_of(tni_energy_pj(c.reference), tni_energy_pj(c.run)); }

Value product_of(Value a, Value b) {
  if (!a || !b) return {};
  return *a * *b;
}

Value sum_of(Value a, Value b) {
  if (!a || !b) return {};
  return *a + *b;
}

Value kernel_group_share(const Comparison& c, KernelGroup group) { return kernel_busy_share(c.run.simulation, group); }

template <Mask kMask>
Value masked_psnr(const Comparison& c) {
  const std::optional<double> error = c.masked[static_cast<std::size_t>(kMask)];
  return error ? psnr_db(*error) : std::nullopt;
}

constexpr std::string_view kMaskedPrefix = "psnr_at_";

constexpr std::array<Metric, 57> kMetrics = {{
    {"psnr_db", "PSNR against the reference picture", Shown::kDecibel, false,
     [](const Comparison& c) { return psnr_db(c.squared_error); }},
    {"psnr_at_object_edges", "the same of pixels with different objects or normals", Shown::kDecibel, false,
     masked_psnr<Mask::kObjectEdge>},
    {"psnr_at_shadow_edges", "of pixels that are partly in shadow, and nothing else", Shown::kDecibel, false,
     masked_psnr<Mask::kShadowEdge>},
    {"psnr_at_reflection_edges", "of pixels with differences in mirrors or glass, and nothing else", Shown::kDecibel,
     false, masked_psnr<Mask::kReflectionEdge>},
    {"psnr_at_texture_edges", "of pixels with differences in a texture, and nothing else", Shown::kDecibel, false,
     masked_psnr<Mask::kTextureEdge>},
    {"psnr_at_elsewhere", "of all other pixels", Shown::kDecibel, false, masked_psnr<Mask::kElsewhere>},
    {"frame_ms", "time of the frame", Shown::kMilliseconds, true,
     [](const Comparison& c) { return Value(static_cast<double>(c.run.simulation.elapsed) * 1e-12); }},
    {"geometry_share", "the share of it beyond the time of the reference", Shown::kShare, true,
     [](const Comparison& c) {
       const Value rest = ratio_of(c.reference.simulation.cycles, c.run.simulation.cycles);
       return rest ? Value(1 - *rest) : Value();
     }},
    {"traced_ratio", "samples traced of those wanted", Shown::kShare, false,
     [](const Comparison& c) { return ratio_of(c.run.sampling_counts().traced, c.run.sampling_counts().wanted); }},
    {"traced_ratio_lit", "the same without samples of the background", Shown::kShare, false,
     [](const Comparison& c) {
       const kernels::Sampling& s = c.run.sampling_counts();
       return ratio_of(s.traced - s.traced_background, s.wanted - s.background);
     }},
    {"similar_ratio", "of the samples between references, those found similar", Shown::kShare, false,
     [](const Comparison& c) { return ratio_of(c.run.sampling_counts().passed, c.run.sampling_counts().checked); }},
    {"samples_of_fixed_9", "samples against nine per pixel", Shown::kShare, false,
     [](const Comparison& c) { return ratio_of(c.run.sampling_counts().traced, 9 * c.run.pixels); }},
    {"sample_ratio", "samples against sixteen per pixel", Shown::kShare, false,
     [](const Comparison& c) { return ratio_of(c.run.sampling_counts().traced, 16 * c.run.pixels); }},
    {"reflective_share", "pixels whose surface reflects", Shown::kShare, false,
     [](const Comparison& c) { return c.reflective_share; }},
    {"rays_ratio", "rays against the reference's", Shown::kShare, false,
     [](const Comparison& c) { return ratio_of(c.run.simulation.rays(), c.reference.simulation.rays()); }},
    {"work_ratio", "traversal steps against the reference's", Shown::kShare, true, work_ratio},
    {"speedup", "cycles of the reference over cycles", Shown::kFactor, true, speedup_of},
    {"speedup_x_work", "speed-up times work ratio: 1 if traversal is the bottleneck", Shown::kFactor, true,
     [](const Comparison& c) { return product_of(speedup_of(c), work_ratio(c)); }},
    {"time_ratio", "cycles over cycles of the reference", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(c.run.simulation.cycles, c.reference.simulation.cycles); }},
    {"time_of_fixed_1", "cycles over cycles of one sample per pixel", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(c.run.simulation.cycles, c.reference.simulation.cycles); }},
    {"tni_power", "power of the T&I units against the reference's", Shown::kFactor, true,
     [](const Comparison& c) {
       return product_of(ratio_of(tni_energy_pj(c.run), tni_energy_pj(c.reference)), speedup_of(c));
     }},
    {"tni_perf_per_watt", "performance per watt of the T&I units against the reference's", Shown::kFactor, true,
     tni_perf_per_watt},
    {"gpu_perf_per_watt", "the same of the GPU with its memory", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(total_energy_pj(c.reference), total_energy_pj(c.run)); }},
    {"energy_ratio", "energy of GPU and memory against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(total_energy_pj(c.run), total_energy_pj(c.reference)); }},
    {"dram_bytes_ratio", "bytes over the memory's buses against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(dram_bytes_of(c.run), dram_bytes_of(c.reference)); }},
    {"l1_hits", "probes of the T&I units' caches that hit, retries included", Shown::kShare, true,
     [](const Comparison& c) { return Value(l1_hit_rate(c.run)); }},
    {"l1_hits_ratio", "the same against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(l1_hit_rate(c.run), l1_hit_rate(c.reference)); }},
    {"l1_first_hits", "the same of the first probe for each line", Shown::kShare, true,
     [](const Comparison& c) { return Value(l1_first_probe_hit_rate(c.run)); }},
    {"l1_first_hits_ratio", "the same against the reference's", Shown::kFactor, true,
     [](const Comparison& c) {
       return ratio_of(l1_first_probe_hit_rate(c.run), l1_first_probe_hit_rate(c.reference));
     }},
    {"l1_fills_ratio", "lines brought into the T&I units' caches against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(lines_filled(c.run), lines_filled(c.reference)); }},
    {"prefetch_accuracy", "prefetched lines that a ray needed", Shown::kShare, true,
     [](const Comparison& c) { return ratio_of(needed_prefetches(c.run), prefetches_of(c.run)); }},
    {"prefetch_coverage", "lines that rays needed and that were prefetched", Shown::kShare, true,
     [](const Comparison& c) {
       const std::uint64_t map = trv_counter(c.run, &hw::Trv::Stats::map_fills);
       const std::uint64_t demanded = lines_filled(c.run) - prefetches_of(c.run) - map;
       const std::uint64_t needed = needed_prefetches(c.run);
       return ratio_of(needed, needed + demanded);
     }},
    {"rays_predicted", "rays looked up for which the predictor found a node", Shown::kShare, true,
     [](const Comparison& c) {
       return ratio_of(predictor_counter(c.run, &hw::PredictorStage::Stats::predicted),
                       predictor_counter(c.run, &hw::PredictorStage::Stats::look_ups));
     }},
    {"predictions_correct", "of these, rays blocked below the node", Shown::kShare, true,
     [](const Comparison& c) {
       return ratio_of(predictor_counter(c.run, &hw::PredictorStage::Stats::correct),
                       predictor_counter(c.run, &hw::PredictorStage::Stats::predicted));
     }},
    {"bounce_rays", "rays of the bounce", Shown::kCount, true,
     [](const Comparison& c) { return Value(static_cast<double>(c.run.bounce_rays)); }},
    {"visits_per_ray", "nodes visited per ray", Shown::kCount, true,
     [](const Comparison& c) { return ratio_of(visits_of(c.run), c.run.bounce_rays); }},
    {"node_hits", "first probes of the node caches that hit", Shown::kShare, true,
     [](const Comparison& c) { return first_hits<hw::Trv>(c.run); }},
    {"triangle_hits", "first probes of the triangle caches that hit", Shown::kShare, true,
     [](const Comparison& c) { return first_hits<hw::Ist>(c.run); }},
    {"dram_bytes_per_ray", "bytes over the memory's buses per ray", Shown::kCount, true,
     [](const Comparison& c) { return ratio_of(dram_bytes_of(c.run), c.run.bounce_rays); }},
    {"lines_per_1000_rays", "distinct lines of nodes that 1,000 consecutive rays read", Shown::kCount, true,
     [](const Comparison& c) { return c.run.lines_per_1000_rays == 0 ? Value() : Value(c.run.lines_per_1000_rays); }},
    {"box_bytes_ratio", "bytes of all boxes of the tree against the reference's", Shown::kFactor, false,
     [](const Comparison& c) { return ratio_of(c.run.box_bytes, c.reference.box_bytes); }},
    {"node_bytes_ratio", "the same of whole nodes", Shown::kFactor, false,
     [](const Comparison& c) { return ratio_of(c.run.node_bytes, c.reference.node_bytes); }},
    {"bytes_per_triangle", "bytes of nodes and leaves per triangle", Shown::kCount, false,
     [](const Comparison& c) { return Value(c.run.bytes_per_triangle); }},
    {"visits_ratio", "nodes visited, restarts included, against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(visits_of(c.run), visits_of(c.reference)); }},
    {"tests_ratio", "triangles tested against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return ratio_of(triangle_tests_of(c.run), triangle_tests_of(c.reference)); }},
    {"perf_per_area", "frames per second and mm2 against the reference's", Shown::kFactor, true,
     [](const Comparison& c) { return product_of(speedup_of(c), ratio_of(c.reference.area_mm2, c.run.area_mm2)); }},
    {"check_share", "SRP cycles in similarity checks", Shown::kShare, true,
     [](const Comparison& c) { return kernel_group_share(c, KernelGroup::kCheck); }},
    {"interpolation_share", "SRP cycles in interpolation", Shown::kShare, true,
     [](const Comparison& c) { return kernel_group_share(c, KernelGroup::kInterpolation); }},
    {"adaptive_share", "SRP cycles in both, including the packing of results", Shown::kShare, true,
     [](const Comparison& c) {
       return sum_of(kernel_group_share(c, KernelGroup::kCheck), kernel_group_share(c, KernelGroup::kInterpolation));
     }},
    {"starved_share", "time without rays for the T&I units while checks or interpolation run", Shown::kShare, true,
     [](const Comparison& c) { return starved_share(c.run.simulation); }},
    {"correction_share", "SRP cycles in post-correction", Shown::kShare, true,
     [](const Comparison& c) { return kernel_group_share(c, KernelGroup::kCorrection); }},
    {"tracing_share", "SRP cycles in everything else", Shown::kShare, true,
     [](const Comparison& c) { return kernel_group_share(c, KernelGroup::kTracing); }},
    {"cycles", "cycles of the T&I clock for a frame", Shown::kCount, true,
     [](const Comparison& c) { return Value(static_cast<double>(c.run.simulation.cycles)); }},
    {"dram_bytes", "bytes over the memory's buses for a frame", Shown::kCount, true,
     [](const Comparison& c) { return Value(static_cast<double>(dram_bytes_of(c.run))); }},
    {"raster_share", "energy of the rasterisers, of GPU and memory", Shown::kShare, true,
     [](const Comparison& c) { return ratio_of(block_energy_pj(c.run, "raster"), total_energy_pj(c.run)); }},
    {"ops_of_traced", "operations of the SRPs for a sample of the reference", Shown::kCount, true, ops_of_traced},
    {"ops_of_interpolated", "the same for a sample that is not traced", Shown::kCount, true, ops_of_interpolated},
}};

}  // namespace

const Metric& find_metric(std::string_view name) {
  const auto found = std::ranges::find(kMetrics, name, &Metric::name);
  if (found == kMetrics.end()) throw std::logic_error(fmt::format("there is no metric '{}'", name));
  return *found;
}

bool needs_masks(std::string_view name) { return name.starts_with(kMaskedPrefix); }

std::string metric_text(const Metric& metric, double value) {
  switch (metric.shown) {
    case Shown::kDecibel:
      return fmt::format("{:.2f} dB", value);
    case Shown::kShare:
      return fmt::format("{:.1f} %", 100 * value);
    case Shown::kCount:
      return fmt::format("{:.0f}", value);
    case Shown::kMilliseconds:
      return fmt::format("{:.3f} ms", value);
    case Shown::kFactor:
      break;
  }
  return fmt::format("{:.2f} x", value);
}

namespace {

constexpr std::uint32_t kGrid = 4, kSamples = kGrid * kGrid;
constexpr float kSameNormal = 0.9F;  ///< minimum dot product of equal normals, as in adaptive sampling
constexpr float kTextureContrast = 0.1F;

/// Classifies pixels row by row: traces and shades the sixteen samples of each pixel.
class RowClassifier {
 public:
  explicit RowClassifier(const Inputs& inputs)
      : config_(inputs.config.render),
        scene_(inputs.image, config_),
        camera_(kernels::camera_uniforms(inputs.camera, config_.width, config_.height)),
        tracer_(inputs.image) {}

  void classify_row(std::uint32_t y, kernels::TileResult& out, Mask* row) const {
    const std::uint32_t pitch = kGrid * config_.width, samples = pitch * kGrid;
    out.buffer.reserve_samples(samples);
    out.buffer.reserve_wave(samples);
    std::iota(out.buffer.checks.samples.entries.begin(), out.buffer.checks.samples.entries.end(), 0U);
    kernels::Wavefront wave(scene_, tracer_, false, kernels::cone_uniforms(camera_, kGrid), out);
    kernels::GenerateListedRays::Ports<float> ports;
    ports.camera = camera_;
    ports.grid = {.x0 = 0,
                  .y0 = static_cast<float>(kGrid * y),
                  .pitch = static_cast<float>(pitch),
                  .inverse_pitch = 1.0F / static_cast<float>(pitch),
                  .grid = kGrid,
                  .inverse_grid = 1.0F / kGrid};
    kernels::RetainedRecords retained;
    retained.geometry = retained.secondary = true;
    const auto made =
        wave.generate_listed_rays(ports, out.buffer.checks.samples, kernels::Wavefront::kNone, samples, retained);
    wave.run(made, samples, retained);
    for (std::uint32_t x = 0; x < config_.width; ++x) row[x] = classify_pixel(x, pitch, out);
  }

 private:
  static Mask classify_pixel(std::uint32_t x, std::uint32_t pitch, const kernels::TileResult& out) {
    const auto any = [&](auto&& differs) {
      for (std::uint32_t i = 1; i < kSamples; ++i) {
        if (differs(kGrid * x, i / kGrid * pitch + kGrid * x + i % kGrid)) return true;
      }
      return false;
    };
    const kernels::TileBuffer& found = out.buffer;
    const auto& geometry = found.samples.geometry;
    const auto& secondary = found.samples.secondary;
    if (any([&](std::uint32_t a, std::uint32_t b) {
          return geometry[a].object != geometry[b].object || dot(geometry[a].normal, geometry[b].normal) < kSameNormal;
        })) {
      return Mask::kObjectEdge;
    }
    if (any([&](std::uint32_t a, std::uint32_t b) { return geometry[a].shadows != geometry[b].shadows; })) {
      return Mask::kShadowEdge;
    }
    if (any([&](std::uint32_t a, std::uint32_t b) {
          return secondary[a].objects != secondary[b].objects || secondary[a].shadows != secondary[b].shadows;
        })) {
      return Mask::kReflectionEdge;
    }
    const bool is_textured = (geometry[std::size_t{kGrid} * x].object & kernels::kTexturedObject) != 0;
    const bool is_edge = is_textured && any([&](std::uint32_t a, std::uint32_t b) {
                           const glm::vec3 one = out.averaged_colour(a), other = out.averaged_colour(b);
                           float most = 0;
                           for (int c = 0; c < 3; ++c)
                             most = std::max(most, std::abs(srgb_encoded(one[c]) - srgb_encoded(other[c])));
                           return most > kTextureContrast;
                         });
    return is_edge ? Mask::kTextureEdge : Mask::kElsewhere;
  }

  const kernels::RenderConfig config_;
  const kernels::SceneTables scene_;
  const kernels::CameraUniforms<float> camera_;
  const traces::BvhTracer tracer_;
};

}  // namespace

std::vector<Mask> classify_pixels(const Inputs& inputs, std::uint32_t threads) {
  const RowClassifier classifier(inputs);
  const std::uint32_t width = inputs.config.render.width, height = inputs.config.render.height;
  std::vector<Mask> masks(std::size_t{width} * height);
  const std::uint32_t workers = std::max(1U, threads);
  run_on_threads(workers, [&](std::size_t worker) {
    kernels::TileResult out;
    for (auto y = static_cast<std::uint32_t>(worker); y < height; y += workers) {
      classifier.classify_row(y, out, masks.data() + std::size_t{y} * width);
    }
  });
  return masks;
}

MaskedErrors masked_errors(std::span<const Mask> masks, std::span<const float> a, std::span<const float> b) {
  std::array<std::vector<float>, static_cast<std::size_t>(Mask::kCount)> ours, theirs;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    const auto of = static_cast<std::size_t>(masks[i]);
    ours[of].insert(ours[of].end(), a.begin() + static_cast<std::ptrdiff_t>(3 * i),
                    a.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
    theirs[of].insert(theirs[of].end(), b.begin() + static_cast<std::ptrdiff_t>(3 * i),
                      b.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
  }
  MaskedErrors errors;
  for (std::size_t m = 0; m < errors.size(); ++m) {
    if (!ours[m].empty()) errors[m] = mean_squared_error(ours[m], theirs[m]);
  }
  return errors;
}

}  // namespace tools::reproduce
