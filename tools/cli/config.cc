#include "sim/config/config.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/config/config_json.h"
#include "sim/report/report_json.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/paths.h"
#include "tools/simulation/run_job.h"

namespace tools {

void add_config(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("config", "What can be configured");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt config show sgrt-2016 --set cores=2");
  CLI::App* list = verb->add_subcommand("list", "Configurations known by name");
  list->footer("Example: raywatt config list");
  list->callback([] {
    for (const std::string& name : config_names()) fmt::print("{}\n", name);
  });
  CLI::App* show = verb->add_subcommand("show", "The effective configuration: every field, with its meaning");
  const auto options = std::make_shared<JobOptions>();
  add_config_options(*show, options->config, options->sets);
  show->footer("Example: raywatt config show sgrt-2016 --set cores=2");
  show->callback([options] { fmt::print("{}", sim::dump_config(load_run_config(*options))); });
  CLI::App* schema = verb->add_subcommand("schema", "JSON Schema of configuration files");
  schema->footer("Example: raywatt config schema > schema.json");
  schema->callback([] { fmt::print("{}", sim::json_text(sim::config_schema<RunConfig>())); });
  CLI::App* manual = verb->add_subcommand(
      "manual", "Every field: value in sgrt-2016, unit, range, what it affects, meaning (Markdown)");
  manual->footer("Example: raywatt config manual > manual.md");
  manual->callback([] { fmt::print("{}", sim::config_manual(load_run_config(JobOptions{}))); });
}

}  // namespace tools
