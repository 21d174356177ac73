#include "tools/studies/compare/compare.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "tools/cli/verbs.h"
#include "tools/host/standard_streams.h"

namespace tools {
namespace {

void run(const std::vector<std::string>& paths, bool json) {
  std::vector<ReportFile> reports;
  for (const std::string& path : paths) reports.push_back(load_report(path));
  std::vector<Comparison> against;
  for (std::size_t i = 1; i < reports.size(); ++i) against.push_back(compare(reports.front(), reports[i]));
  for (const std::string& warning : comparison_warnings(reports, against)) {
    tell("warning: {}", sim::printable(warning, 1000));
  }
  fmt::print("{}", json ? sim::json_text(comparison_json(reports, against)) : comparison_text(reports, against));
}

}  // namespace

void add_compare(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "compare", "Runs side by side: what changed in cycles, energy and pictures, and which counters explain it");
  const auto paths = std::make_shared<std::vector<std::string>>();
  const auto json = std::make_shared<bool>(false);
  verb->add_option("runs", *paths, "folders of runs, or report.json files; the others are held against the first")
      ->required()
      ->expected(2, 100);
  verb->add_flag("--json", *json, "as JSON, with all that differs");
  verb->footer("Example: raywatt compare raywatt-out/base raywatt-out/two-ports\nExit 0 whatever differs.");
  verb->callback([=] { run(*paths, *json); });
}

}  // namespace tools
