#include "tools/microbench/microbench.h"

#include <CLI/CLI.hpp>

#include "tools/verbs/verbs.h"

namespace tools {

void add_microbench(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("microbench", "Pieces of the machine alone, measured beside their closed forms");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt microbench dram --set dram.extends=dram/lpddr5-6400");
  for (const auto& add : {add_microbench_dram}) add(*verb);
}

}  // namespace tools
