#include <memory>

#include <CLI/CLI.hpp>

#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/run/jobs.h"

namespace tools {

void add_verify(CLI::App& app, const std::vector<std::string>& argv, int& exit) {
  CLI::App* verb = app.add_subcommand("verify", "Compare every ray, primary and secondary, with Embree");
  const auto options = std::make_shared<JobOptions>();
  options->argv = argv;
  add_work_options(*verb, *options);
  add_frames_option(*verb, *options);
  add_output_options(*verb, *options);
  add_rays_option(*verb, *options);
  verb->footer(
      "Example: raywatt verify --scene teapot --resolution 512x256\nEnds with 1 if a ray differs that is no edge tie.");
  verb->callback([options, &exit] { exit = options->rays.empty() ? verify_frames(*options) : verify_rays(*options); });
}

}  // namespace tools
