#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/build_info.h"
#include "tools/host/process.h"
#include "tools/host/standard_streams.h"
#include "traces/scene/did_you_mean.h"

namespace {

constexpr std::size_t kLongestComplaint = 4096;

/// Prints one line to stderr, with unsafe characters replaced. Returns `exit`.
int print_error(std::string_view what, int exit) {
  tools::print_message(sim::printable(what, kLongestComplaint));
  return exit;
}

/// Returns the verb that the command line selects, or the program itself.
const CLI::App& selected_verb(const CLI::App& app) {
  const CLI::App* verb = &app;
  while (!verb->get_subcommands().empty()) verb = verb->get_subcommands().front();
  return *verb;
}

/// Returns the full command of a verb, for example "raywatt trace replay".
std::string command_of(const CLI::App& verb) {
  return (verb.get_parent() != nullptr ? command_of(*verb.get_parent()) + " " : "") + verb.get_name();
}

/// Returns "unknown verb 'shwo', did you mean 'show'?" if a verb is wrong; else empty.
std::string unknown_verb(const CLI::App& verb) {
  const std::vector<std::string> rest = verb.remaining();
  std::vector<std::string> known;
  for (const CLI::App* sub : verb.get_subcommands([](const CLI::App*) { return true; })) {
    known.push_back(sub->get_name());
  }
  if (rest.empty() || known.empty() || rest.front().starts_with('-')) return {};
  return fmt::format("unknown {} '{}'{}; there are: {}", verb.get_parent() == nullptr ? "verb" : "subcommand",
                     sim::printable(rest.front()), traces::did_you_mean(rest.front(), known), fmt::join(known, ", "));
}

/// Returns a message that suggests --set for "raywatt run sgrt-2016 --set cores=2 rays=8"; empty if no word is a
/// setting.
std::string setting_without_option(const CLI::App& verb, const std::vector<std::string>& rest) {
  const auto setting =
      std::ranges::find_if(rest, [](const std::string& word) { return word.find('=') != std::string::npos; });
  if (setting == rest.end() || verb.get_option_no_throw("--set") == nullptr) return {};
  return fmt::format("'{0}' follows no option; allowed: --set {0}, one --set for each key", sim::printable(*setting));
}

/// Returns "unknown option '--scen', did you mean '--scene'?" if an option is wrong; else empty.
std::string unknown_option(const CLI::App& verb) {
  const std::vector<std::string> rest = verb.remaining();
  const auto option = std::ranges::find_if(rest, [](const std::string& word) { return word.starts_with("--"); });
  if (option == rest.end()) return setting_without_option(verb, rest);
  std::vector<std::string> known;
  for (const CLI::Option* each : verb.get_options()) {
    for (const std::string& name : each->get_lnames()) known.push_back("--" + name);
  }
  const std::string asked = option->substr(0, option->find('='));
  if (verb.get_parent() == nullptr) {
    // "raywatt --resolution 64x32": the verb is missing.
    for (const CLI::App* sub : verb.get_subcommands([](const CLI::App*) { return true; })) {
      if (sub->get_option_no_throw(asked) == nullptr) continue;
      return fmt::format("'{0}' is an option of a verb; allowed: raywatt {1} {0} ...", sim::printable(asked),
                         sub->get_name());
    }
  }
  return fmt::format("unknown option '{}'{}; see {} --help", sim::printable(asked), traces::did_you_mean(asked, known),
                     command_of(verb));
}

/// Returns "report needs DIR (folder of a run ...)" if a required argument is missing; else empty.
std::string missing_argument(const CLI::App& verb) {
  for (const CLI::Option* option : verb.get_options()) {
    if (!option->get_required() || option->count() != 0) continue;
    std::string about = option->get_description();
    std::ranges::replace(about, '\n', ' ');
    const std::string type = option->get_type_name();
    const bool is_telling = option->get_positional() && !type.empty() && !type.starts_with("TEXT");
    return fmt::format("{} needs {}: {}; see {} --help", command_of(verb), is_telling ? type : option->get_name(),
                       sim::printable(about), command_of(verb));
  }
  return {};
}

/// Formats a bound such as "0.010000" without trailing zeros.
std::string bound_without_trailing_zeros(const std::string& bound) {
  return fmt::format("{}", std::strtod(bound.c_str(), nullptr));
}

bool is_number(const std::string& text) {
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

/// Rewords an error of CLI11 as "where: what; allowed: what", e.g. "--ideal: 'l3' is unknown; allowed: tni, l1".
/// Returns other errors unchanged.
std::string reword_cli_error(const std::string& error) {
  constexpr std::string_view kNoConversion = "Could not convert: ", kValue = "Value ", kNotIn = " not in {",
                             kNotInRange = " not in range ", kTo = " to ", kLeast = "At least ", kMost = "At Most ",
                             kReceived = " required but received ", kRequired = " required ", kMissing = " missing";
  if (const std::size_t equals = error.find(" = "); error.starts_with(kNoConversion) && equals != std::string::npos) {
    return fmt::format("{}: '{}' cannot be read; allowed: a whole number",
                       error.substr(kNoConversion.size(), equals - kNoConversion.size()), error.substr(equals + 3));
  }
  const std::size_t colon = error.find(": ");
  if (colon == std::string::npos) return error;
  const std::string where = error.substr(0, colon), what = error.substr(colon + 2);
  if (const std::size_t at = what.rfind(kNotIn); at != std::string::npos && what.ends_with('}')) {
    std::string allowed = what.substr(at + kNotIn.size());
    allowed.pop_back();
    const std::vector<std::string> words = CLI::detail::split(allowed, ',');
    return fmt::format("{}: '{}' is unknown; allowed: {}", where, what.substr(0, at), fmt::join(words, ", "));
  }
  if (const std::size_t at = what.rfind(kNotInRange); at != std::string::npos && what.starts_with(kValue)) {
    const std::string value = what.substr(kValue.size(), at - kValue.size());
    const std::string range = what.substr(at + kNotInRange.size());
    const std::size_t to = range.find(kTo);
    return fmt::format(
        "{}: '{}' is {}; allowed: {} to {}", where, value, is_number(value) ? "out of range" : "no number",
        bound_without_trailing_zeros(range.substr(0, to)), bound_without_trailing_zeros(range.substr(to + kTo.size())));
  }
  if (const std::size_t at = what.find(kReceived); at != std::string::npos) {
    const bool is_least = what.starts_with(kLeast);
    const std::size_t begin = is_least ? kLeast.size() : kMost.size();
    return fmt::format("{}: {} given; allowed: at {} {}", where, what.substr(at + kReceived.size()),
                       is_least ? "least" : "most", what.substr(begin, at - begin));
  }
  if (what.find(kRequired) != std::string::npos && what.ends_with(kMissing)) {
    return fmt::format("{0}: has no value; allowed: {0} VALUE", where);
  }
  return error;
}

/// Formats usage lines. An argument that takes several words appears as its type, such as "DIR...", "RUN RUN..." or
/// "[CONFIG] FILE".
class UsageFormatter : public CLI::Formatter {
 public:
  std::string make_option_usage(const CLI::Option* option) const override {
    const bool is_list = option->get_expected_max() > 1 && option->get_type_name().find("TEXT") == std::string::npos;
    return is_list ? option->get_type_name() : CLI::Formatter::make_option_usage(option);
  }
};

/// Returns a message that suggests --help for "raywatt help run"; empty for other command lines.
std::string help_verb_message(const CLI::App& verb, int argc, char** argv) {
  if (argc < 2 || std::string_view(argv[1]) != "help") return {};
  return fmt::format("help is an option; allowed: {} --help", command_of(verb));
}

int run_command(int argc, char** argv) {
  int exit = tools::kGood;
  CLI::App app{"Raywatt simulates a mobile ray-tracing GPU: cycles, rays, energy and performance per watt.", "raywatt"};
  app.require_subcommand(1);
  app.formatter(std::make_shared<UsageFormatter>());
  app.set_version_flag(
      "--version", fmt::format("raywatt {} ({}{})", tools::build_info().version, tools::build_info().git.substr(0, 12),
                               tools::build_info().dirty ? ", with changes" : ""));
  std::vector<std::string> words;  // command line, for reports
  std::transform(argv, argv + argc, std::back_inserter(words), sim::with_escaped_bytes);
  tools::add_run_command(app, words, exit);
  tools::add_verify_command(app, words, exit);
  tools::add_reproduce_command(app, words);
  tools::add_scenes_command(app);
  tools::add_config_command(app);
  tools::add_kernels_command(app);
  tools::add_bottleneck_command(app);
  tools::add_bench_command(app);
  tools::add_compare_command(app);
  tools::add_report_command(app);
  tools::add_energy_command(app);
  tools::add_dvfs_command(app);
  tools::add_sustain_command(app);
  tools::add_baseline_command(app, exit);
  tools::add_trace_command(app, words);
  tools::add_microbench_command(app, exit);
  tools::add_sweep_command(app, exit);
  tools::add_optimise_command(app, exit);
  tools::add_worth_command(app, exit);
  tools::add_completion_command(app);
  tools::add_man_command(app);
  tools::refuse_empty_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked = error.get_exit_code() == 0;  // --help or --version
    if (asked) {
      app.exit(error);
      tools::flush_output();
      return exit;
    }
    const CLI::App& verb = selected_verb(app);
    std::string problem = help_verb_message(verb, argc, argv);
    if (problem.empty()) problem = unknown_verb(verb);
    if (problem.empty()) problem = unknown_option(verb);
    if (problem.empty() && error.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError)) {
      problem = missing_argument(verb);
    }
    if (problem.empty()) problem = fmt::format("{}; see {} --help", reword_cli_error(error.what()), command_of(verb));
    return print_error(problem, tools::kBadInput);
  }
  tools::flush_output();
  return exit;
}

}  // namespace

int main(int argc, char** argv) {
  tools::open_closed_streams();
  tools::ignore_write_signals();
  tools::install_interrupt_handlers();
  try {
    return run_command(argc, argv);
  } catch (const tools::Interrupted&) {
    return 128 + SIGINT;  // reached only if no HoldInterrupts ended the process
  } catch (const sim::InputError& error) {
    return print_error(error.what(), tools::kBadInput);
  } catch (const sim::IoError& error) {
    return print_error(error.what(), tools::kIoFailed);
  } catch (const sim::Deadlock& error) {
    tools::print_message(error.what());
    std::fputs(error.state.c_str(), stderr);
    return tools::kStuckMachine;
  } catch (const std::system_error& error) {
    return print_error(error.what(), tools::kIoFailed);
  } catch (const std::bad_alloc&) {
    return print_error(
        "out of memory: the work needs more than this host has; allowed: a smaller --resolution or limits.memory, or "
        "fewer "
        "--threads",
        tools::kIoFailed);
  } catch (const std::exception& error) {
    return print_error(fmt::format("internal error: {}", error.what()), tools::kOurBug);
  }
}
