#include <CLI/CLI.hpp>

#include "tools/verbs/verbs.h"

namespace tools {

void add_sweep(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("sweep", "Many runs at once, and what comes of them");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt sweep table out/l1");
  add_sweep_results(*verb);
}

}  // namespace tools
