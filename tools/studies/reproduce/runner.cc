#include "tools/studies/reproduce/runner.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "tools/analysis/debug_pictures.h"
#include "tools/analysis/picture.h"
#include "tools/run/frame/ground_truth.h"
#include "tools/studies/reproduce/mirrors.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/node_format.h"
#include "traces/scene/images.h"

namespace tools::reproduce {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kTruthSamples = 256;  ///< source: Jin 2009, table 2

Measured measured(const Metric& metric, const Comparison& c) {
  if (metric.machine && !c.run.machine) return {{}, "not simulated: functional only"};
  if (const std::optional<double> value = metric.measure(c)) return {value, {}};
  return {{}, c.squared_error == 0.0 ? "identical" : "nothing to measure"};
}

/// Four times the difference of two pictures, sRGB-encoded, as 8 bits a channel.
std::vector<std::uint8_t> difference(std::span<const float> a, std::span<const float> b) {
  constexpr float kGain = 4;
  std::vector<std::uint8_t> out(a.size());
  std::ranges::transform(a, b, out.begin(), [](float x, float y) {
    const float encoded = std::min(1.0F, kGain * std::abs(srgb_encoded(x) - srgb_encoded(y)));
    return static_cast<std::uint8_t>(std::lround(255 * encoded));
  });
  return out;
}

/// A crop, every pixel of it eight wide and high.
std::vector<std::uint8_t> cropped(const std::vector<std::uint8_t>& picture, const Case& c, const Crop& crop,
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

std::string key_of(const Case& c, const Program& program) { return program.text() + (c.machine ? "" : " (picture)"); }

/// A name as a part of a file's name.
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
        fmt::format("no built-in scene stands in for it: --scenes DIR with {}", fmt::join(view.files, " or ")));
  }
  throw sim::InputError(fmt::format("{}: there is no {}", options_.scenes.string(), fmt::join(view.files, " or ")));
}

JobOptions Runner::job(const Case& c, const Program& program) const {
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

void Runner::look_at(const Case& c) {
  if (inputs_ && c.view == view_ && c.width == width_ && c.height == height_) return;
  outcomes_.clear();
  truth_.clear();
  masks_.clear();
  width_ = c.width;
  height_ = c.height;
  if (!inputs_ || c.view != view_) load(c, {});
}

void Runner::load(const Case& c, const Program& program) {
  inputs_.reset();
  reflective_share_.reset();
  view_ = c.view;
  inputs_ = load_inputs(job(c, program), progress_);
  inputs_key_ = inputs_key(inputs_->config);
  if (c.view.mirrors != 0) {
    set_reflective_share(*inputs_, c.view.mirrors / 100.0, options_.threads);
    reflective_share_ = reflective_share(*inputs_, options_.threads);
  }
}

const Outcome& Runner::outcome(const Case& c, const Program& program) {
  const std::string key = key_of(c, program);
  const auto found = outcomes_.find(key);
  if (found != outcomes_.end()) return found->second;
  const kernels::ProgramSpec spec = kernels::parse_program(program.name);
  const RunConfig config = load_run_config(job(c, program));
  if (inputs_key(config) != inputs_key_) load(c, program);
  inputs_->config = config;
  Outcome out;
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
  return outcomes_.emplace(key, std::move(out)).first->second;
}

const std::vector<float>& Runner::truth(const Case& c) {
  if (truth_.empty()) {
    inputs_->config = load_run_config(job(c, {}));
    truth_ = ground_truth(*inputs_, kTruthSamples, options_.threads, cache_folder(), progress_);
  }
  return truth_;
}

const std::vector<Mask>& Runner::masks(const Case& c) {
  if (masks_.empty()) {
    inputs_->config = load_run_config(job(c, {}));
    masks_ = masks_of(*inputs_, host_threads(options_.threads));
  }
  return masks_;
}

std::vector<Measured> Runner::measure(const Case& c) {
  look_at(c);
  const Outcome& run = outcome(c, c.run);
  const Outcome& reference = outcome(c, c.reference);
  const std::vector<float>& other = c.truth ? truth(c) : reference.simulation.rendered.rgb;
  Comparison comparison{.run = run,
                        .reference = reference,
                        .squared_error = mean_squared_error(run.simulation.rendered.rgb, other),
                        .reflective_share = reflective_share_};
  if (std::ranges::any_of(c.figures, [](const Figure& f) { return asks_for_masks(f.metric); })) {
    comparison.masked = masked_errors(masks(c), run.simulation.rendered.rgb, other);
  }
  std::vector<Measured> figures;
  for (const Figure& figure : c.figures) figures.push_back(measured(find_metric(figure.metric), comparison));
  return figures;
}

void Runner::write_pictures(const Case& c, const fs::path& folder) const {
  if (c.picture.empty()) return;
  const auto write = [&](const std::string& name, const std::vector<std::uint8_t>& picture) {
    traces::write_png(folder / fmt::format("figure-{}.png", file_part(name)), c.width, c.height, picture);
    for (const Crop& crop : c.crops) {
      std::uint32_t side = 0;
      const std::vector<std::uint8_t> part = cropped(picture, c, crop, side);
      const std::string file = file_part(fmt::format("figure-{}-{}.png", name, crop.name));
      traces::write_png(folder / file, side, side, part);
    }
  };
  const FrameResult& simulation = outcomes_.at(key_of(c, c.run)).simulation;
  const std::vector<float>& run = simulation.rendered.rgb;
  write(c.picture, to_rgb8(run));
  for (const DebugPicture& p : debug_pictures(simulation.program, simulation.rendered, c.width, c.height)) {
    const std::string name = file_part(fmt::format("{}-{}", c.picture, p.name));
    traces::write_png(folder / fmt::format("figure-{}.png", name), p.width, p.height, p.rgb);
  }
  const std::vector<float>& other = c.truth ? truth_ : outcomes_.at(key_of(c, c.reference)).simulation.rendered.rgb;
  const std::string frame = c.view.frame.empty() ? "" : "-" + c.view.frame;
  write(fmt::format("reference-{}{}-{}", c.view.scene, frame, c.truth ? "truth" : c.reference.name), to_rgb8(other));
  write(c.picture + "-difference", difference(run, other));
}

}  // namespace tools::reproduce
