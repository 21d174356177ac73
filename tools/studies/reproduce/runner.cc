#include "tools/studies/reproduce/runner.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/error.h"
#include "tools/analysis/debug_pictures.h"
#include "tools/analysis/picture.h"
#include "tools/run/frame/ground_truth.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/node_format.h"
#include "traces/scene/images.h"

namespace tools::reproduce {
namespace {

using traces::MaterialRecord;

constexpr float kMirrored = 0.3F;  ///< share of the light that new mirrors reflect
constexpr double kTolerance = 0.01;
constexpr std::uint32_t kProbePixels = 96;  ///< width of the picture in which pixels are counted

void make_mirror(MaterialRecord& m) {
  m.mirrored = glm::vec3(kMirrored);
  m.diffuse_share = 1 - kMirrored;
  m.flags |= traces::kMirror;
}

void make_dull(MaterialRecord& m) {
  m.mirrored = glm::vec3(0);
  m.diffuse_share = 1;
  m.flags = (m.flags & ~std::uint32_t{traces::kMirror}) | traces::kDiffuse;
}

bool is_fixed(const MaterialRecord& m) {
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
    if (!is_fixed(m)) make_dull(m);
  }
  double reached = reflective_share(inputs, threads);
  const double of_glass = reached;

  std::vector<std::pair<double, std::size_t>> covers;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    if (is_fixed(materials[i])) continue;
    make_mirror(materials[i]);
    covers.emplace_back(reflective_share(inputs, threads) - of_glass, i);
    make_dull(materials[i]);
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

/// Returns four times the difference of two pictures, sRGB-encoded, 8 bits per channel.
std::vector<std::uint8_t> difference_picture(std::span<const float> a, std::span<const float> b) {
  constexpr float kGain = 4;
  std::vector<std::uint8_t> out(a.size());
  std::ranges::transform(a, b, out.begin(), [](float x, float y) {
    const float encoded = std::min(1.0F, kGain * std::abs(srgb_encoded(x) - srgb_encoded(y)));
    return static_cast<std::uint8_t>(std::lround(255 * encoded));
  });
  return out;
}

/// Returns a crop, enlarged eight times.
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
  return program.program_text() + (c.machine ? "" : " (picture)");
}

/// Makes a name usable in file names.
std::string file_part(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return std::string_view(" ,:").find(c) != std::string_view::npos; }, '-');
  return text;
}

}  // namespace

std::string Runner::stand_in(const View& view) const {
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
  job.scene = stand_in(c.view);
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
  inputs_key_ = inputs_key(inputs_->config);
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
  if (inputs_key(config) != inputs_key_) load_scene(c, program);
  inputs_->config = config;
  ProgramResult out;
  const std::uint64_t records = traces::node_records(inputs_->image.nodes.size(), config.bvh.boxes);
  out.box_bytes = records * traces::box_bytes(config.bvh.numbers, config.bvh.boxes);
  out.node_bytes = records * traces::node_bytes(config.bvh.numbers, config.bvh.boxes);
  out.pixels = std::uint64_t{c.width} * c.height;
  out.machine = c.machine;
  const SimulateOptions extras{.marks = !c.picture.empty(), .progress = progress_};
  if (c.machine) {
    out.simulation = simulate_frame(*inputs_, spec, options_.threads, extras);
  } else {
    out.simulation.program = spec;
    out.simulation.rendered = render_frame(*inputs_, spec, traces::BvhTracer(inputs_->image), options_.threads, extras);
  }
  return results_by_program_.emplace(key, std::move(out)).first->second;
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
    masks_ = masks_of(*inputs_, host_threads(options_.threads));
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
                        .squared_error = mean_squared_error(run.simulation.rendered.rgb, other),
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
    traces::write_png(folder / fmt::format("figure-{}.png", file_part(name)), c.width, c.height, picture);
    for (const Crop& crop : c.crops) {
      std::uint32_t side = 0;
      const std::vector<std::uint8_t> part = crop_picture(picture, c, crop, side);
      const std::string file = file_part(fmt::format("figure-{}-{}.png", name, crop.name));
      traces::write_png(folder / file, side, side, part);
    }
  };
  const FrameResult& simulation = results_by_program_.at(key_of(c, c.run)).simulation;
  const std::vector<float>& run = simulation.rendered.rgb;
  write(c.picture, to_rgb8(run));
  for (const DebugPicture& p : debug_pictures(simulation.program, simulation.rendered, c.width, c.height)) {
    const std::string name = file_part(fmt::format("{}-{}", c.picture, p.name));
    traces::write_png(folder / fmt::format("figure-{}.png", name), p.width, p.height, p.rgb);
  }
  const std::vector<float>& other =
      c.truth ? truth_ : results_by_program_.at(key_of(c, c.reference)).simulation.rendered.rgb;
  const std::string frame = c.view.frame.empty() ? "" : "-" + c.view.frame;
  write(fmt::format("reference-{}{}-{}", c.view.scene, frame, c.truth ? "truth" : c.reference.name), to_rgb8(other));
  write(c.picture + "-difference", difference_picture(run, other));
}

}  // namespace tools::reproduce
