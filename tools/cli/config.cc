#include "sim/config/config.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/paths.h"
#include "tools/run/frame/run_job.h"

namespace tools {
namespace {

/// Returns the question of an experiment, or the first sentence of the comment at the start of a file.
std::string line_about(const std::filesystem::path& file) {
  constexpr std::size_t kLongest = 110;
  constexpr std::string_view kQuestion = "question: ";
  std::ifstream in(file);
  std::string text;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(kQuestion)) return line.substr(kQuestion.size());
    if (line.starts_with("schema: ")) continue;
    if (!line.starts_with("# ")) break;
    text += (text.empty() ? "" : " ") + line.substr(2);
  }
  std::size_t end = text.find(". ");
  while (end != std::string::npos && std::isupper(static_cast<unsigned char>(text[end + 2])) == 0) {
    end = text.find(". ", end + 2);
  }
  text = text.substr(0, end);
  if (text.ends_with('.')) text.pop_back();
  return text.size() <= kLongest ? text : text.substr(0, text.rfind(' ', kLongest)) + " ...";
}

/// True for an experiment of `raywatt optimise`.
bool is_search(const std::string& name) {
  std::ifstream in(find_config_file(name));
  std::string line;
  return std::getline(in, line) && line.starts_with("schema: raywatt-optimise/");
}

/// Lists the configuration files by kind, with one line about each.
std::string config_list() {
  std::string text;
  const auto list = [&](const std::string& head, const std::vector<std::string>& names) {
    if (names.empty()) return;
    std::size_t width = 0;
    for (const std::string& name : names) width = std::max(width, name.size());
    text += fmt::format("{}{}\n", text.empty() ? "" : "\n", head);
    for (const std::string& name : names) {
      const std::string about = sim::printable(line_about(find_config_file(name)));
      text += about.empty() ? fmt::format("  {}\n", name) : fmt::format("  {:<{}}  {}\n", name, width, about);
    }
  };
  list("configurations (raywatt run NAME)", config_names());
  list("memory grades (--set dram.extends=NAME)", config_names_in("dram"));
  list("energy tables (--set energy.extends=NAME)", config_names_in("energy"));
  list("voltages over clocks (--set power.extends=NAME)", config_names_in("power"));
  list("hits of caches over their size (--set latency.extends=NAME)", config_names_in("latency"));
  list("area tables (--set area.extends=NAME)", config_names_in("area"));
  std::vector<std::string> searches = config_names_in("experiments");
  // std::ranges subranges do not compile with clang 14.
  const auto sweeps = std::stable_partition(searches.begin(), searches.end(), is_search);
  list("sweeps (raywatt sweep run NAME; without experiments/)", {sweeps, searches.end()});
  list("searches (raywatt optimise NAME; without experiments/)", {searches.begin(), sweeps});
  return text;
}

}  // namespace

void add_config(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("config", "What can be configured");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt config show sgrt-2016 --set cores=2");
  CLI::App* list = verb->add_subcommand(
      "list", "Configurations, memory grades, energy, power, area and latency tables, and experiments known by name");
  list->footer("Example: raywatt config list");
  list->callback([] { fmt::print("{}", config_list()); });
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
