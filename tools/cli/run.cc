#include <memory>

#include <CLI/CLI.hpp>

#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/run/jobs.h"

namespace tools {

void add_run(CLI::App& app, const std::vector<std::string>& argv, int&) {
  CLI::App* verb = app.add_subcommand("run", "Render on the simulated GPU and report cycles, rays and energy");
  const auto options = std::make_shared<JobOptions>();
  options->argv = argv;
  add_job_options(*verb, *options);
  add_reference_option(*verb, *options);
  verb->add_option("--record", options->record, "also write the work into this file, for raywatt trace replay");
  verb->add_flag("--debug-images", options->debug_images,
                 "also pictures of where work went, debug-cycles.png, debug-steps.png, debug-energy.png, ..., and of\n"
                 "how an adaptive frame came about, debug-similar.png, debug-check-NAME.png, ...");
  verb->add_option("--tile-sampling", options->tile_sampling,
                   "time a part of the frame's tiles and estimate the rest, with 95 % intervals: a share of the\n"
                   "frame's work, e.g. 5%, or auto, which stops at +-2 % (docs/sampling.md)")
      ->check([](const std::string& text) { return text.empty() ? std::string("is empty; allowed: 5%, auto") : ""; });
  verb->add_option("--image", options->image, "with --tile-sampling: render all tiles, or none but those needed")
      ->check(CLI::IsMember({"full", "none"}))
      ->capture_default_str();
  verb->add_option(
          "--slices", options->slices,
          "cut the frame's tiles into so many runs, played side by side on machines of their own, and add them\n"
          "up, with 95 % intervals: a number, or auto, as many as suit the frame (docs/slices.md)")
      ->check([](const std::string& text) { return text.empty() ? std::string("is empty; allowed: 2, auto") : ""; });
  verb->add_option("--replicates", options->replicates,
                   "play the frame's work so many times, all but the first with displacements that no architect would\n"
                   "notice, and report mean and 95 % interval of each figure (docs/noise.md)")
      ->check(CLI::Range(1U, kMostReplicates))
      ->capture_default_str();
  add_intervals_option(*verb, *options);
  verb->add_flag("--watch", options->watch,
                 "show the picture so far, utilisation and power of the last interval and when it ends; a line every\n"
                 "two seconds where standard output is no terminal")
      ->excludes(verb->get_option("--progress"), verb->get_option("--quiet"));
  add_timeline_option(*verb, *options);
  verb->add_flag("--json", options->json, "totals of report.json on standard output, in the table's stead");
  add_rays_option(*verb, *options);
  verb->footer("Example: raywatt run sgrt-2016 --scene teapot --set cores=2 -o out/two-cores");
  verb->callback([options] { options->rays.empty() ? run_frames(*options) : run_rays(*options); });
}

}  // namespace tools
