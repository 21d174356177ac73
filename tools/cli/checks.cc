#include "tools/cli/checks.h"

#include <string>

#include <CLI/CLI.hpp>

namespace tools {

void refuse_empty_values(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_items_expected_max() == 0 || option->check_lname("set")) continue;
    const std::string allowed = option->get_required() ? "a value" : "a value, or to leave it out";
    option->check({[allowed](const std::string& value) {
                     return value.empty() ? "is empty; allowed: " + allowed : std::string();
                   },
                   ""});
  }
  for (CLI::App* verb : app.get_subcommands([](CLI::App*) { return true; })) refuse_empty_values(*verb);
}

void refuse_negative(CLI::Option& option) {
  option.check({[](const std::string& value) {
                  return value.starts_with('-') ? value + " is negative; allowed: a whole number from 0 on"
                                                : std::string();
                },
                ""});
}

}  // namespace tools
