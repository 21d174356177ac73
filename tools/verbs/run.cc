#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/file.h"
#include "sim/report/report_json.h"
#include "tools/debug_pictures.h"
#include "tools/interrupt.h"
#include "tools/picture.h"
#include "tools/report.h"
#include "tools/run_folder.h"
#include "tools/run_job.h"
#include "tools/sampling_report.h"
#include "tools/tile_sampling.h"
#include "tools/verbs/verbs.h"
#include "traces/scene/images.h"

namespace tools {

namespace {

/// What has become of the frames so far.
struct Outcome {
  std::optional<Simulation> total, reference;
  double squared_error = 0;  ///< sum over frames
  nlohmann::ordered_json frames = nlohmann::ordered_json::array();
  bool partial = false;

  Result result() const {
    return {*total, reference ? &*reference : nullptr, squared_error / static_cast<double>(frames.size())};
  }
};

void keep(Simulation frame, std::optional<Simulation>& total) {
  if (total) {
    total->add(frame);
  } else {
    total = std::move(frame);
  }
}

/// A frame program and what it carries from frame to frame.
struct Program {
  kernels::ProgramSpec spec;
  kernels::RateMap rates;
};

struct Job {
  const JobOptions& options;
  Program program;
  std::optional<Program> reference;
  std::optional<TileSampling> sampling;
  bool has_picture() const { return !sampling || sampling->full_image; }

  /// Simulates the frame that `inputs` stand at and writes its picture.
  void run_frame(const Inputs& inputs, const RunFolder::Open& open, Outcome& out) {
    const std::uint32_t width = inputs.config.render.width, height = inputs.config.render.height;
    Simulation frame = sampling
                           ? simulate_sampled(inputs, program.spec, options.threads, *sampling)
                           : simulate(inputs, program.spec, options.threads, {&program.rates, options.debug_images});
    std::optional<Simulation> compared;
    if (reference) compared = simulate(inputs, reference->spec, options.threads, {&reference->rates});
    const double error = compared ? mean_squared_error(frame.function.rgb, compared->function.rgb) : 0;
    const std::filesystem::path& folder = open();
    nlohmann::ordered_json entry = {{"frame", inputs.frame}};
    entry.update(totals_json({frame, compared ? &*compared : nullptr, error}));
    if (!frame.function.sampling.similar.empty()) entry["sampling"]["tiles"] = tiles_json(frame.function.sampling);
    if (inputs.frames() > 1 && has_picture()) {
      const std::vector<std::uint8_t> picture = to_rgb8(frame.function.rgb);
      traces::write_png(folder / fmt::format("frame-{:04}.png", inputs.frame), width, height, picture);
    }
    if (out.frames.empty() && has_picture()) {
      traces::write_png(folder / "image.png", width, height, to_rgb8(frame.function.rgb));
      traces::write_exr(folder / "image.exr", width, height, frame.function.rgb);
      if (compared) traces::write_exr(folder / "reference.exr", width, height, compared->function.rgb);
    }
    for (const DebugPicture& p : debug_pictures(program.spec, frame.function, width, height)) {
      const std::string frame_name = inputs.frames() > 1 ? fmt::format("frame-{:04}-", inputs.frame) : "";
      traces::write_png(folder / fmt::format("{}debug-{}.png", frame_name, p.name), p.width, p.height, p.rgb);
    }
    out.frames.push_back(std::move(entry));
    out.squared_error += error;
    keep(std::move(frame), out.total);
    if (compared) keep(*std::move(compared), out.reference);
  }

  /// All frames, or those that an interrupt has left time for; Interrupted if that is none.
  Outcome run_frames(Inputs& inputs, const RunFolder::Open& folder) {
    Outcome out;
    try {
      run_frame(inputs, folder, out);
      while (inputs.frame < inputs.config.scene.last_frame) {
        advance(inputs, inputs.frame + 1, options.threads);
        run_frame(inputs, folder, out);
      }
    } catch (const Interrupted&) {
      if (out.frames.empty()) throw;
      out.partial = true;
    }
    return out;
  }
};

/// How frames are sampled, if they are; InputError for what does not go with it.
std::optional<TileSampling> sampling_of(const JobOptions& options, const kernels::ProgramSpec& program) {
  if (options.tile_sampling.empty()) {
    if (options.image != "full") throw sim::InputError("--image none goes with --tile-sampling only");
    return std::nullopt;
  }
  check_tile_sampling(program);
  if (!options.reference.empty())
    throw sim::InputError("--tile-sampling does not go with --reference: compare two runs of all tiles");
  return parse_tile_sampling(options.tile_sampling, options.image);
}

void run(const JobOptions& options) {
  const auto begin = sim::HostClock::now();
  const kernels::ProgramSpec program = kernels::parse_program(options.program);
  std::optional<kernels::ProgramSpec> reference;
  if (!options.reference.empty()) reference = kernels::parse_program(options.reference);
  const std::optional<TileSampling> sampling = sampling_of(options, program);
  RunFolder folder(options.out, options.force);
  Inputs inputs = load_inputs(options);
  const kernels::RateMap rates(inputs.config.programs.multirate);
  Job job{options, {program, rates}, {}, sampling};
  if (reference) job.reference = Program{*reference, rates};
  for (const std::string& warning : inputs.warnings) fmt::print(stderr, "raywatt: warning: {}\n", warning);

  nlohmann::ordered_json json;
  folder.fill([&](const RunFolder::Open& open) {
    const Outcome out = job.run_frames(inputs, open);
    const std::filesystem::path& staging = open();
    const double wall = sim::seconds_since(begin);
    const Result result = out.result();
    json = report_json({inputs, options, result, out.frames, out.partial, wall});
    sim::write_file_atomically(staging / "report.json", sim::json_text(json));
    sim::write_file_atomically(staging / "report.txt", report_table(json));
    sim::write_file_atomically(staging / "config.yaml", sim::dump_config(inputs.config));
  });
  if (options.quiet) return;
  fmt::print("{}\n", report_table(json));
  if (job.has_picture()) fmt::print("picture: {}\n", (folder.target() / "image.png").string());
  fmt::print("report:  {}\n", (folder.target() / "report.json").string());
}

}  // namespace

void add_run(CLI::App& app, const std::vector<std::string>& argv, int&) {
  CLI::App* verb = app.add_subcommand("run", "Render on the simulated GPU and report cycles, rays and energy");
  const auto options = std::make_shared<JobOptions>();
  options->argv = argv;
  add_job_options(*verb, *options);
  verb->add_option("--reference", options->reference, "also run this program; add PSNR and relative figures");
  verb->add_flag("--debug-images", options->debug_images,
                 "also pictures of how an adaptive frame came about: debug-similar.png, debug-check-NAME.png, ...");
  verb->add_option("--tile-sampling", options->tile_sampling,
                   "time a part of the frame's tiles and estimate the rest, with 95 % intervals: a share of the\n"
                   "frame's work, e.g. 5%, or auto, which stops at +-2 % (docs/sampling.md)");
  verb->add_option("--image", options->image, "with --tile-sampling: render all tiles, or none but those needed")
      ->check(CLI::IsMember({"full", "none"}))
      ->capture_default_str();
  verb->footer("Example: raywatt run sgrt-2016 --scene teapot --set cores=2 -o out/two-cores");
  verb->callback([options] { run(*options); });
}

}  // namespace tools
