#include "traces/accel/verify.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/io/file.h"
#include "sim/report/report_json.h"
#include "tools/picture.h"
#include "tools/report.h"
#include "tools/run_folder.h"
#include "tools/run_job.h"
#include "tools/verbs/verbs.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"
#include "traces/scene/images.h"

namespace tools {

namespace {

nlohmann::ordered_json verdict_json(const traces::VerifyCounts& counts, const std::optional<double>& psnr) {
  return {{"schema", "raywatt-verify/1"},
          {"rays", counts.rays},
          {"missing_hits", counts.missing_hits},
          {"extra_hits", counts.extra_hits},
          {"distance_errors", counts.distance_errors},
          {"edge_ties", counts.edge_ties},
          {"reference_errors", counts.reference_errors},
          {"psnr_db", psnr ? nlohmann::ordered_json(*psnr) : nlohmann::ordered_json(nullptr)},
          {"identical", !psnr.has_value()}};
}

int verify(const JobOptions& options) {
  const kernels::ProgramSpec program = kernels::parse_program(options.program);
  RunFolder folder(options.out, options.force, "verify.json");
  const Inputs inputs = load_inputs(options);
  const traces::BvhTracer tested(inputs.image);
  const traces::EmbreeTracer embree(inputs.image, host_threads(options.threads));
  const traces::VerifyingTracer verifying(inputs.image, tested, embree);
  const std::vector<float> ours = render(inputs, program, verifying, options.threads).rgb;
  const std::vector<float> truth = render(inputs, program, embree, options.threads).rgb;

  const traces::VerifyCounts counts = verifying.counts();
  const std::optional<double> psnr = psnr_db(ours, truth);
  nlohmann::ordered_json json = verdict_json(counts, psnr);
  json["provenance"] = provenance_json(inputs, options);
  const std::uint32_t width = inputs.config.render.width, height = inputs.config.render.height;
  folder.fill([&](const std::filesystem::path& staging) {
    sim::write_file_atomically(staging / "verify.json", sim::json_text(json));
    traces::write_png(staging / "image.png", width, height, to_rgb8(ours));
    traces::write_png(staging / "embree.png", width, height, to_rgb8(truth));
  });
  if (!options.quiet) {
    fmt::print(
        "{} rays against Embree {}: {} missing hits, {} extra hits, {} distance errors, {} edge ties, picture {}\n",
        counts.rays, traces::embree_version(), counts.missing_hits, counts.extra_hits, counts.distance_errors,
        counts.edge_ties, psnr ? fmt::format("{:.2f} dB", *psnr) : "identical");
    fmt::print("details: {}\n", (folder.target() / "verify.json").string());
  }
  return counts.faults() == 0 ? kGood : kCheckFailed;
}

}  // namespace

void add_verify(CLI::App& app, const std::vector<std::string>& argv, int& exit) {
  CLI::App* verb = app.add_subcommand("verify", "Compare every ray of a frame, primary and secondary, with Embree");
  const auto options = std::make_shared<JobOptions>();
  options->argv = argv;
  add_job_options(*verb, *options);
  verb->footer(
      "Example: raywatt verify --scene teapot --resolution 512x256\nEnds with 1 if a ray differs that is no edge tie.");
  verb->callback([options, &exit] { exit = verify(*options); });
}

}  // namespace tools
