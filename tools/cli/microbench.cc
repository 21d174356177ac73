#include "tools/studies/microbench/microbench.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tools/cli/verbs.h"

namespace tools {

namespace {

void list(CLI::App& verb) {
  for (const CLI::App* benchmark : verb.get_subcommands([](const CLI::App*) { return true; })) {
    if (benchmark->get_name() != "list") fmt::print("{:<13}{}\n", benchmark->get_name(), benchmark->get_description());
  }
}

}  // namespace

void add_microbench(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("microbench", "Pieces of the machine alone, measured beside their closed forms");
  verb->require_subcommand(1);
  verb->footer(
      "A figure that leaves its closed form by more than it may ends the verb with exit code 1.\n\n"
      "Example: raywatt microbench dram --set dram.extends=dram/lpddr5-6400");
  verb->add_subcommand("list", "What each of them measures")->callback([verb] { list(*verb); });
  for (const auto& add :
       {add_microbench_chase, add_microbench_bandwidth, add_microbench_mshr, add_microbench_dram, add_microbench_rays,
        add_microbench_early_exit, add_microbench_tile_buffer, add_microbench_kernels}) {
    add(*verb, exit);
  }
}

}  // namespace tools
