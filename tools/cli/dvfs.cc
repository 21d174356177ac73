#include "tools/studies/dvfs/dvfs.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/progress.h"

namespace tools {

void add_dvfs(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("dvfs", "Frames a second against watts over the clock, each clock at the voltage it needs");
  const auto options = std::make_shared<DvfsOptions>();
  const auto json = std::make_shared<bool>(false);
  add_work_options(*verb, options->job);
  verb->add_option("--factors", options->factors, "clocks over the configured ones")
      ->delimiter(',')
      ->check(CLI::Range(0.01, 20.0))
      ->capture_default_str()
      ->type_name("LIST");
  verb->add_option("--clocks", options->domains, "clock domains that move; the others stay as configured")
      ->delimiter(',')
      ->capture_default_str()
      ->type_name("LIST");
  require_positive(*verb->add_option("--fps", options->fps, "target frame rate (default: that of the slowest point)")
                        ->type_name("NUMBER"));
  verb->add_flag("--json", *json, "as JSON");
  add_progress_option(*verb, options->job.progress);
  verb->footer("Example: raywatt dvfs sgrt-balanced --scene chess --resolution 512x256 --fps 60");
  verb->callback([=] {
    Progress progress(options->job.progress, options->job.quiet);
    const DvfsCurve curve = dvfs_curve(*options, &progress);
    progress.end("done");
    fmt::print("{}", *json ? sim::json_text(dvfs_json(curve)) : dvfs_text(curve));
  });
}

}  // namespace tools
