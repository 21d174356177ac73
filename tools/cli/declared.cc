#include "tools/cli/declared.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <CLI/CLI.hpp>

namespace tools {
namespace {

/// Returns the words between the braces of "TEXT:{local,slurm}".
std::vector<std::string> choices_in(const std::string& type) {
  const std::size_t begin = type.find('{'), end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  return CLI::detail::split(type.substr(begin + 1, end - begin - 1), ',');
}

DeclaredOption declared(const CLI::Option& option) {
  DeclaredOption found;
  for (const std::string& name : option.get_snames()) found.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) found.names.push_back("--" + name);
  found.is_positional = found.names.empty();
  if (found.is_positional) found.names.push_back(option.get_name());
  found.help = option.get_description();
  if (option.get_items_expected_max() > 0) {
    found.takes = option.get_type_name();
    found.choices = choices_in(found.takes);
  }
  return found;
}

void add_verb(const CLI::App& app, std::vector<std::string> words, std::vector<DeclaredVerb>& verbs) {
  words.push_back(app.get_name());
  DeclaredVerb verb{words, app.get_description(), app.get_footer(), {}, {}};
  for (const CLI::Option* option : app.get_options()) verb.options.push_back(declared(*option));
  const auto below =
      app.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); });  // only visible ones
  std::ranges::transform(below, std::back_inserter(verb.verbs), [](const CLI::App* sub) { return sub->get_name(); });
  verbs.push_back(std::move(verb));
  for (const CLI::App* sub : below) add_verb(*sub, words, verbs);
}

}  // namespace

std::vector<DeclaredVerb> declared_verbs(const CLI::App& app) {
  std::vector<DeclaredVerb> verbs;
  add_verb(app, {}, verbs);
  return verbs;
}

}  // namespace tools
