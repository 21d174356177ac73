#include <chrono>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/config/config.h"
#include "sim/io/file.h"
#include "sim/report/report_json.h"
#include "tools/picture.h"
#include "tools/report.h"
#include "tools/run_folder.h"
#include "tools/run_job.h"
#include "tools/verbs/verbs.h"
#include "traces/scene/images.h"

namespace tools {

namespace {

void write_results(const std::filesystem::path& folder, const Report& report, const nlohmann::ordered_json& json) {
  const Inputs& in = report.inputs;
  const std::uint32_t width = in.config.render.width, height = in.config.render.height;
  const std::vector<float>& rgb = report.run.function.rgb;
  sim::write_file_atomically(folder / "report.json", sim::json_text(json));
  sim::write_file_atomically(folder / "report.txt", report_table(json));
  sim::write_file_atomically(folder / "config.yaml", sim::dump_config(in.config));
  traces::write_png(folder / "image.png", width, height, to_rgb8(rgb));
  traces::write_exr(folder / "image.exr", width, height, rgb);
  if (report.reference != nullptr) {
    traces::write_exr(folder / "reference.exr", width, height, report.reference->function.rgb);
  }
}

void run(const JobOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const kernels::ProgramSpec program = kernels::parse_program(options.program);
  std::optional<kernels::ProgramSpec> reference;
  if (!options.reference.empty()) reference = kernels::parse_program(options.reference);
  RunFolder folder(options.out, options.force);
  const Inputs inputs = load_inputs(options);
  for (const std::string& warning : inputs.warnings) fmt::print(stderr, "raywatt: warning: {}\n", warning);

  const Simulation simulation = simulate(inputs, program, options.threads);
  std::optional<Simulation> compared;
  if (reference) compared = simulate(inputs, *reference, options.threads);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const Report report{inputs, options, simulation, compared ? &*compared : nullptr, wall};
  const nlohmann::ordered_json json = report_json(report);
  folder.fill([&](const std::filesystem::path& staging) { write_results(staging, report, json); });
  if (options.quiet) return;
  fmt::print("{}\npicture: {}\nreport:  {}\n", report_table(json), (folder.target() / "image.png").string(),
             (folder.target() / "report.json").string());
}

}  // namespace

void add_run(CLI::App& app, const std::vector<std::string>& argv, int&) {
  CLI::App* verb = app.add_subcommand("run", "Render a frame on the simulated GPU and report cycles, rays and energy");
  const auto options = std::make_shared<JobOptions>();
  options->argv = argv;
  add_job_options(*verb, *options);
  verb->add_option("--reference", options->reference, "also run this program; add PSNR and relative figures");
  verb->footer("Example: raywatt run sgrt-2016 --scene teapot --set cores=2 -o out/two-cores");
  verb->callback([options] { run(*options); });
}

}  // namespace tools
