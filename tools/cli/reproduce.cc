#include "tools/studies/reproduce/reproduce.h"

#include <memory>

#include <CLI/CLI.hpp>

#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/progress.h"

namespace tools {

void add_reproduce(CLI::App& app, const std::vector<std::string>& argv) {
  CLI::App* verb = app.add_subcommand("reproduce", "Run a paper's experiments; print measured beside published");
  const auto options = std::make_shared<reproduce::Options>();
  options->argv = argv;
  verb->add_option("paper", options->paper, "lee2016, kim2016, jin2009, chiu, sgrt-units or hybrid")->required();
  verb->add_option("--scenes", options->scenes, "folder of .glb files for scenes that no built-in one stands in for");
  verb->add_flag("--quick", options->quick,
                 "some of the experiments at a sixteenth of the resolution, to see that they run");
  verb->add_option("--shrink", options->shrink,
                   "divide the width and height of all pictures by this: all experiments, in a fraction of the time")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  verb->add_option("--config", options->config, "configuration: a name such as sgrt-2016, or a .yaml file")
      ->capture_default_str();
  verb->add_option("--threads", options->threads, "host threads (default: all cores)")->check(CLI::Range(1, 1024));
  verb->add_option("-o,--output", options->out, "folder for the results (default: a dated one below raywatt-out/)");
  verb->add_flag("--force", options->force, "put the results among the files of a folder that is not a former run");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "Example: raywatt reproduce kim2016 --scenes ~/scenes -o out/kim2016\n"
      "Whole papers take hours. Rows are kept as they finish, and the same command goes on from them, however the\n"
      "run was stopped; if all of them are there, it makes them anew. docs/reproduce.md tells more.");
  verb->callback([options] { reproduce::reproduce(*options); });
}

}  // namespace tools
