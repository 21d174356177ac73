#include "tools/studies/report/report.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tools/cli/verbs.h"

namespace tools {

void add_report(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("report", "A page to look at and to send: of a run, of runs side by side, of a sweep");
  const auto options = std::make_shared<pages::Options>();
  verb->add_option(
          "what", options->what,
          "folder of a run; folders of two or more runs, which are held against the first; or folder of a sweep\n"
          "or a search")
      ->required()
      ->expected(1, 16)
      ->type_name("DIR");
  verb->add_option("-o,--output", options->out, "the page, one file that needs no network")
      ->required()
      ->type_name("FILE.html");
  verb->add_flag("--force", options->force, "replace a file that is no such page");
  verb->footer(
      "Example: raywatt report raywatt-out/base -o base.html\n"
      "         raywatt report raywatt-out/base raywatt-out/ports -o difference.html\n"
      "         raywatt report out/trv-cores -o sweep.html");
  verb->callback([options] {
    pages::write_report_page(*options);
    fmt::print("page: {}\n", options->out.string());
  });
}

}  // namespace tools
