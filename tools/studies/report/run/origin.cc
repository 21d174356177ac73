#include "sim/io/printable.h"
#include "tools/analysis/report_file.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/report/run/run_parts.h"

namespace tools::pages {
namespace {

constexpr std::size_t kLongestCommand = 4000;

std::string command_of(const Json& argv) {
  std::vector<std::string> words;
  if (!argv.is_array()) return {};
  for (const Json& word : argv) {
    if (word.is_string()) words.push_back(word.get<std::string>());
  }
  return sim::printable(command_text(words), kLongestCommand);
}

}  // namespace

void add_origin(const Run& run, View& view) {
  Section section("origin", "Where this comes from");
  Dataset origin({{"what", "what"}, {"value", "value"}});
  for (const auto& [words, key] : std::vector<std::pair<const char*, const char*>>{{"version", "version"},
                                                                                   {"commit", "git"},
                                                                                   {"model", "model_id"},
                                                                                   {"configuration", "config_hash"},
                                                                                   {"scene", "scene_sha256"},
                                                                                   {"tree", "bvh_hash"},
                                                                                   {"compiler", "compiler"}}) {
    const std::string value = text_at(run.report.json, {"provenance", key});
    if (!value.empty()) origin.row({words, value});
  }
  if (const std::string date = text_at(run.report.json, {"host", "date"}); !date.empty()) origin.row({"date", date});
  if (const std::string command = command_of(at(run.report.json, {"provenance", "argv"})); !command.empty())
    origin.row({"command", command});
  view.data("origin", origin);
  section.table("origin-table", "Program, inputs, command", "origin");
  Dataset keys({{"key", "key"}, {"value", "value"}});
  if (const Json& config = at(run.report.json, {"config"}); config.is_object()) {
    for (const auto& [key, value] : flat_config(config)) keys.row({key, value});
  }
  view.data("config", keys);
  section.block("table", "config", "Configuration, every key", {{"data", "config"}, {"folded", true}});
  view.add(section);
}

}  // namespace tools::pages
