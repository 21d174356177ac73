#include "tools/studies/compare/compare.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/progress.h"
#include "tools/host/standard_streams.h"

namespace tools {
namespace {

struct CompareOptions {
  std::vector<std::string> paths;
  std::uint32_t replicates = 1, threads = 0;
  std::string progress = "auto";
  bool json = false;
};

void run_comparison(const CompareOptions& options) {
  std::vector<ReportFile> reports;
  for (const std::string& path : options.paths) reports.push_back(load_report(path));
  if (options.replicates > 1) {
    Progress progress(options.progress, false);
    progress.expect(options.replicates * static_cast<std::uint32_t>(reports.size()));
    for (ReportFile& report : reports) add_replicates(report, options.replicates, options.threads, &progress);
    progress.end("done");
  }
  std::vector<Comparison> against;
  for (std::size_t i = 1; i < reports.size(); ++i) against.push_back(compare(reports.front(), reports[i]));
  for (const std::string& warning : comparison_warnings(reports, against)) {
    tell("warning: {}", sim::printable(warning, 1000));
  }
  fmt::print("{}", options.json ? sim::json_text(comparison_json(reports, against))
                                : for_terminal(comparison_text(reports, against)));
}

}  // namespace

void add_compare(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "compare", "Runs side by side: what changed in cycles, energy and pictures, and which counters explain it");
  const auto options = std::make_shared<CompareOptions>();
  verb->add_option("runs", options->paths,
                   "folders of runs, or report.json files; the others are held against the first")
      ->required()
      ->expected(2, 100)
      ->option_text("RUN RUN... REQUIRED");
  verb->add_option("--replicates", options->replicates,
                   "play runs that have fewer replicates so many times, slightly perturbed, so that noise is measured\n"
                   "(docs/noise.md)")
      ->check(CLI::Range(1U, kMostReplicates))
      ->capture_default_str();
  verb->add_option("--threads", options->threads, "host threads of these plays (default: all cores)")
      ->check(CLI::Range(1, 1024));
  add_progress_option(*verb, options->progress);
  verb->add_flag("--json", options->json, "as JSON, with all that differs");
  verb->footer("Example: raywatt compare raywatt-out/base raywatt-out/two-ports\nExit 0 whatever differs.");
  verb->callback([=] { run_comparison(*options); });
}

}  // namespace tools
