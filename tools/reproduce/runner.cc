#include "tools/reproduce/runner.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "tools/ground_truth.h"
#include "tools/picture.h"
#include "tools/reproduce/mirrors.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/scene/images.h"

namespace tools::reproduce {

namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t kTruthSamples = 256;  ///< source: Jin 2009, table 2

}  // namespace

std::string Runner::stand_in(const View& view) const {
  if (!view.stand_in.empty()) return view.stand_in;
  if (options_.scenes.empty()) {
    throw sim::InputError(
        fmt::format("no built-in scene stands in for it: --scenes DIR with {}", fmt::join(view.files, " or ")));
  }
  std::error_code unreadable;
  for (const std::string& file : view.files) {
    if (fs::exists(options_.scenes / file, unreadable)) return (options_.scenes / file).string();
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
  width_ = c.width;
  height_ = c.height;
  if (inputs_ && c.view == view_) return;
  inputs_.reset();
  reflective_share_.reset();
  view_ = c.view;
  inputs_ = load_inputs(job(c, {}));
  if (c.view.mirrors != 0) {
    set_reflective_share(*inputs_, c.view.mirrors / 100.0, options_.threads);
    reflective_share_ = reflective_share(*inputs_, options_.threads);
  }
}

const Outcome& Runner::outcome(const Case& c, const Program& program) {
  const std::string key = program.text() + (c.machine ? "" : " (picture)");
  const auto found = outcomes_.find(key);
  if (found != outcomes_.end()) return found->second;
  const kernels::ProgramSpec spec = kernels::parse_program(program.name);
  inputs_->config = load_run_config(job(c, program));
  Outcome out;
  out.pixels = std::uint64_t{c.width} * c.height;
  out.machine = c.machine;
  if (c.machine) {
    out.simulation = simulate(*inputs_, spec, options_.threads);
  } else {
    out.simulation.program = spec;
    out.simulation.function = render(*inputs_, spec, traces::BvhTracer(inputs_->image), options_.threads);
  }
  out.samples = samples_of(out.simulation, out.pixels);
  return outcomes_.emplace(key, std::move(out)).first->second;
}

const std::vector<float>& Runner::truth(const Case& c) {
  if (truth_.empty()) {
    inputs_->config = load_run_config(job(c, {}));
    truth_ = ground_truth(*inputs_, kTruthSamples, options_.threads, cache_folder());
  }
  return truth_;
}

std::vector<std::optional<double>> Runner::measure(const Case& c) {
  look_at(c);
  const Outcome& run = outcome(c, c.run);
  const Outcome* reference = c.reference.name.empty() ? nullptr : &outcome(c, c.reference);
  Comparison comparison{.run = run, .reference = reference};
  comparison.reflective_share = reflective_share_;
  if (c.truth) {
    comparison.squared_error = mean_squared_error(run.simulation.function.rgb, truth(c));
  } else if (reference != nullptr) {
    comparison.squared_error = mean_squared_error(run.simulation.function.rgb, reference->simulation.function.rgb);
  }
  std::vector<std::optional<double>> values;
  for (const Figure& figure : c.figures) {
    const Metric& metric = find_metric(figure.metric);
    values.push_back(metric.machine && !c.machine ? std::nullopt : metric.measure(comparison));
  }
  return values;
}

void Runner::write_pictures(const Case& c, const fs::path& folder) const {
  if (c.picture.empty()) return;
  const auto write = [&](std::string_view which, std::span<const float> linear) {
    traces::write_png(folder / fmt::format("figure-{}{}.png", c.picture, which), c.width, c.height, to_rgb8(linear));
  };
  const std::string key_end = c.machine ? "" : " (picture)";
  write("", outcomes_.at(c.run.text() + key_end).simulation.function.rgb);
  if (c.truth) {
    write("-truth", truth_);
  } else if (!c.reference.name.empty()) {
    write("-reference", outcomes_.at(c.reference.text() + key_end).simulation.function.rgb);
  }
}

}  // namespace tools::reproduce
