#include <algorithm>
#include <array>
#include <cctype>
#include <csignal>
#include <cstring>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/program_spec.h"
#include "sim/config/config.h"
#include "tools/cli/verbs.h"
#include "tools/host/build_info.h"
#include "tools/host/paths.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/load_config.h"
#include "tools/studies/energy/energy.h"
#include "tools/studies/reproduce/plan.h"
#include "traces/scenes/builtin.h"

namespace tools {
namespace {

/// An option or a positional argument of a verb.
struct DeclaredOption {
  std::vector<std::string> names;  ///< names as typed: "-o", "--output"; "file" for a positional argument
  std::string help;
  std::string takes;                 ///< type of the option's value, as in --help; empty for a flag
  std::vector<std::string> choices;  ///< allowed values of the option; empty if it is not restricted to some words
  bool is_positional;
};

/// A verb of the program, or the program itself.
struct DeclaredVerb {
  std::vector<std::string> words;  ///< words of the command: "raywatt", "trace", "replay"
  std::string help, footer;
  std::vector<DeclaredOption> options;
  std::vector<std::string> verbs;  ///< names of the verb's subcommands
};

/// Returns the allowed values in an option's type text: "local" and "slurm" for "TEXT:{local,slurm}".
std::vector<std::string> choices_in(const std::string& type) {
  const std::size_t begin = type.find('{'), end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  return CLI::detail::split(type.substr(begin + 1, end - begin - 1), ',');
}

DeclaredOption declare_option(const CLI::Option& option) {
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
  for (const CLI::Option* option : app.get_options()) verb.options.push_back(declare_option(*option));
  const auto below =
      // hidden subcommands have no group
      app.get_subcommands([](const CLI::App* sub) { return !sub->get_group().empty(); });
  std::ranges::transform(below, std::back_inserter(verb.verbs), [](const CLI::App* sub) { return sub->get_name(); });
  verbs.push_back(std::move(verb));
  for (const CLI::App* sub : below) add_verb(*sub, words, verbs);
}

/// Returns the program, its verbs and their subcommands, parents first.
std::vector<DeclaredVerb> declared_verbs(const CLI::App& app) {
  std::vector<DeclaredVerb> verbs;
  add_verb(app, {}, verbs);
  return verbs;
}

/// The configuration keys that --set accepts, for completion scripts.
struct SetKeys {
  /// All configuration keys in order of declaration; `of_energy`: keys that affect only energy.
  std::vector<std::string> every, of_energy;
  /// Allowed values of each configuration key: words, or names of files.
  std::vector<std::pair<std::string, std::vector<std::string>>> values;
};

SetKeys set_keys() {
  SetKeys keys;
  for (sim::FieldInfo& field : sim::list_fields(load_run_config(JobOptions()))) {
    keys.every.push_back(field.path);
    if (field.affects == sim::Affects::kEnergy) keys.of_energy.push_back(field.path);
    if (field.kind == sim::FieldKind::kBool) field.choices = {"true", "false"};
    if (!field.choices.empty()) keys.values.emplace_back(field.path, std::move(field.choices));
  }
  for (const std::string group : {"dram", "energy", "power", "latency", "area"}) {
    const std::string key = group + ".extends";
    keys.every.push_back(key);
    if (group == "energy" || group == "power") keys.of_energy.push_back(key);
    keys.values.emplace_back(key, config_names_in(group));
  }
  return keys;
}

std::string join_words(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

std::vector<std::string> option_names(const DeclaredVerb& verb) {
  std::vector<std::string> names;
  for (const DeclaredOption& option : verb.options) {
    if (!option.is_positional) names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return names;
}

/// Returns the names, such as scenes or configurations, that an option accepts in addition to files.
std::vector<std::string> known_names(const DeclaredVerb& verb, const DeclaredOption& option) {
  const std::string& name = option.names.front();
  std::vector<std::string> known;
  if (name == "--scene" || (option.is_positional && name == "scene")) {
    for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) known.push_back(scene.name);
    for (const std::string& workload : workload_names()) known.push_back(workload);
  } else if (name == "--program") {
    known = kernels::program_names();
  } else if (option.is_positional && name == "config") {
    known = config_names();
  } else if (option.is_positional && name == "kernel") {
    for (const kernels::KernelInfo& kernel : kernels::kernel_catalogue()) known.emplace_back(kernel.name);
  } else if (option.is_positional && name == "paper") {
    for (const reproduce::Paper& paper : reproduce::all_papers()) known.emplace_back(paper.name);
  } else if (option.is_positional && name == "event") {
    known = energy_entry_names(JobOptions());
  } else if (option.is_positional && name == "file" &&
             (join_words(verb.words) == "raywatt sweep run" || verb.words.back() == "optimise")) {
    for (const std::string& path : config_names_in("experiments")) known.push_back(path.substr(path.find('/') + 1));
  } else if (option.is_positional && name == "file" && verb.words.back() == "worth") {
    for (const std::string& path : config_names_in("worth")) known.push_back(path.substr(path.find('/') + 1));
  }
  std::erase_if(known, [](const std::string& each) {  // removes names that a shell would split into words
    return !std::ranges::all_of(each, [](unsigned char c) { return std::isalnum(c) || std::strchr("-_.:", c); });
  });
  return known;
}

std::vector<std::string> positional_names(const DeclaredVerb& verb) {
  std::vector<std::string> names;
  for (const DeclaredOption& option : verb.options) {
    if (!option.is_positional) continue;
    const std::vector<std::string> known = option.choices.empty() ? known_names(verb, option) : option.choices;
    names.insert(names.end(), known.begin(), known.end());
  }
  return names;
}

/// Returns which keys a verb's --set accepts, as the name of a member of SetKeys.
const char* set_key_list(const DeclaredVerb& verb) {
  return join_words(verb.words) == "raywatt energy price" ? "of_energy" : "every";
}

bool is_set_option(const DeclaredOption& option) { return option.names.front() == "--set"; }

/// Calls f(patterns, variable, values) for each option of a verb that takes a value. `variable`: shell variable for the
/// completions: "choices" if only `values` are allowed, "names" if files are also allowed, "keys" for configuration
/// keys, "next" for files only.
template <class F>
void for_each_option_value(const DeclaredVerb& verb, const F& f) {
  for (const DeclaredOption& option : verb.options) {
    if (option.is_positional) continue;
    const std::vector<std::string> known = known_names(verb, option);
    if (is_set_option(option)) {
      f(option.names, "keys", std::vector<std::string>{set_key_list(verb)});
    } else if (!option.choices.empty()) {
      f(option.names, "choices", option.choices);
    } else if (!option.takes.empty()) {
      f(option.names, known.empty() ? "next" : "names", known);
    }
  }
}

/// Returns the branches of a shell `case` statement over verbs; `body(verb)` gives the lines of a branch.
template <class F>
std::string verb_cases(const std::vector<DeclaredVerb>& verbs, const F& body) {
  std::string out;
  for (const DeclaredVerb& verb : verbs)
    out += fmt::format("    {})\n{}      ;;\n", single_quoted(join_words(verb.words)), body(verb));
  return out;
}

/// A shell loop that finds the verb in the words before the cursor.
constexpr std::string_view kFindVerb = R"(  verb=raywatt
  for word in "${before[@]}"; do
    case " $verb $word" in
)";

std::string find_verb(const std::vector<DeclaredVerb>& verbs) {
  std::string known;
  for (const DeclaredVerb& verb : verbs) {
    if (verb.words.size() > 1) known += fmt::format("{}' {}'", known.empty() ? "" : " | ", join_words(verb.words));
  }
  return fmt::format("{}      {}) verb=\"$verb $word\" ;;\n    esac\n  done\n", kFindVerb, known);
}

/// Returns shell lines that set variables to the words that can follow on the command line: `choices` if only these are
/// allowed, `names` if files are also allowed, `next` for verbs and options.
std::string next_word_lines(const std::vector<DeclaredVerb>& verbs) {
  const auto offered = [](const DeclaredVerb& verb) {
    std::string lines = fmt::format("      next='{} {} {}'\n", join_words(verb.verbs),
                                    join_words(positional_names(verb)), join_words(option_names(verb)));
    std::string choices;
    for_each_option_value(verb, [&](const auto& names, const char* variable, const auto& values) {
      choices += fmt::format("        {}) {}='{}' ;;\n", fmt::join(names, " | "), variable, join_words(values));
    });
    if (!choices.empty()) lines += "      case $previous in\n" + choices + "      esac\n";
    return lines;
  };
  return "  case $verb in\n" + verb_cases(verbs, offered) + "  esac\n";
}

/// Joins configuration keys into one text for the shell, each followed by an equals sign.
std::string keys_with_equals(const std::vector<std::string>& keys) { return fmt::format("{}=", fmt::join(keys, "= ")); }

/// Returns shell lines that set `keys` to the keys of --set and, after "key=", `choices` to that key's allowed values.
std::string set_option_lines() {
  const SetKeys keys = set_keys();
  std::string values;
  for (const auto& [key, choices] : keys.values) {
    values += fmt::format("    {}) choices={} ;;\n", single_quoted(key), single_quoted(join_words(choices)));
  }
  return fmt::format(
      "  case $keys in\n    every) keys={} ;;\n    of_energy) keys={} ;;\n  esac\n  case $key in\n{}  esac\n",
      single_quoted(keys_with_equals(keys.every)), single_quoted(keys_with_equals(keys.of_energy)), values);
}

std::string bash_completions(const std::vector<DeclaredVerb>& verbs) {
  return R"(_raywatt() {
  local verb word next= choices= names= keys= key= begun=
  local previous=${COMP_WORDS[COMP_CWORD - 1]} current=${COMP_WORDS[COMP_CWORD]}
  local before=("${COMP_WORDS[@]:1:COMP_CWORD - 1}")
  if [[ $current == : ]]; then  # bash takes a colon for a word
    begun=$previous: current=$begun previous=${COMP_WORDS[COMP_CWORD - 2]}
  elif [[ $previous == : ]]; then
    begun=${COMP_WORDS[COMP_CWORD - 2]}: current=$begun$current previous=${COMP_WORDS[COMP_CWORD - 3]}
  elif [[ $current == = || $previous == = ]]; then  # and an equals sign
    local at=$((COMP_CWORD - 1))
    [[ $current == = ]] && current= || at=$((at - 1))
    previous=${COMP_WORDS[at]}
    if [[ $previous != -* ]]; then  # that behind a key, which stands behind its option
      key=$previous previous=${COMP_WORDS[at - 1]}
      [[ $previous != = ]] || previous=${COMP_WORDS[at - 2]}
    fi
  fi
)" + find_verb(verbs) +
         next_word_lines(verbs) + R"(  if [ -n "$keys" ]; then
)" + set_option_lines() +
         R"(    compopt +o filenames -o nospace 2> /dev/null
    [ -n "$key" ] || choices=$keys
    mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$current")
  elif [ -n "$choices" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -W "${names:-$next}" -- "$current"; [[ $current == -* ]] || compgen -f -- "$current")
  fi
  COMPREPLY=("${COMPREPLY[@]#"$begun"}")
}
complete -o filenames -F _raywatt raywatt
)";
}

std::string zsh_completions(const std::vector<DeclaredVerb>& verbs) {
  return R"(#compdef raywatt
_raywatt() {
  local verb word next= choices= names= keys= key= previous=${words[CURRENT-1]} current=${words[CURRENT]}
  local before=("${(@)words[2,CURRENT-1]}")
  [[ $current != --*=* ]] || { previous=${current%%=*} current=${current#*=}; compset -P 1 '*='; }
)" + find_verb(verbs) +
         next_word_lines(verbs) + R"(  if [ -n "$keys" ]; then
    [[ $current != *=* ]] || { key=${current%%=*}; compset -P 1 '*='; }
)" + set_option_lines() +
         R"(    [ -n "$key" ] || choices=$keys
    compadd -S '' -- ${=choices}
  elif [ -n "$choices" ]; then
    compadd -- ${=choices}
  else
    compadd -- ${=${names:-$next}}
    _files
  fi
}
_raywatt "$@"
)";
}

/// Returns a fish function that prints completions of --set: configuration keys, and the allowed values of a key.
std::string fish_settings() {
  const SetKeys keys = set_keys();
  std::string out =
      "function __raywatt_settings\n  set -l begun (string replace -r '^--set=' '' -- (commandline -ct))\n"
      "  switch $begun\n";
  for (const auto& [key, choices] : keys.values) {
    out += fmt::format("    case '{0}=*'\n      printf '{0}=%s\\n' {1}\n", key, join_words(choices));
  }
  out += "    case '*=*'\n    case '*'\n      switch $argv[1]\n";
  for (const auto& [list, names] : {std::pair{"every", &keys.every}, std::pair{"of_energy", &keys.of_energy}}) {
    out += fmt::format("        case {}\n          printf '%s=\\n' {}\n", list, join_words(*names));
  }
  return out + "      end\n  end\nend\n";
}

std::string fish_completions(const std::vector<DeclaredVerb>& verbs) {
  std::string out = fish_settings() + R"(function __raywatt_verb
  set -l verb raywatt
  for word in (commandline -opc)[2..-1]
    switch "$verb $word"
)";
  std::vector<std::string> known;
  for (const DeclaredVerb& verb : verbs) {
    if (verb.words.size() > 1) known.push_back(single_quoted(join_words(verb.words)));
  }
  out += fmt::format(
      "      case {}\n        set verb \"$verb $word\"\n    end\n  end\n  test \"$verb\" = \"$argv\"\nend\n",
      join_words(known));
  for (const DeclaredVerb& verb : verbs) {
    const std::string here =
        fmt::format("complete -c raywatt -n {}", single_quoted("__raywatt_verb " + join_words(verb.words)));
    for (const DeclaredVerb& below : verbs) {
      const bool is_next = below.words.size() == verb.words.size() + 1 &&
                           std::equal(verb.words.begin(), verb.words.end(), below.words.begin());
      if (is_next) out += fmt::format("{} -a {} -d {}\n", here, below.words.back(), single_quoted(below.help));
    }
    if (const std::vector<std::string> names = positional_names(verb); !names.empty()) {
      out += fmt::format("{} -a {}\n", here, single_quoted(join_words(names)));
    }
    for (const DeclaredOption& option : verb.options) {
      if (option.is_positional) continue;
      std::string help = option.help;
      std::ranges::replace(help, '\n', ' ');
      out += here;
      for (const std::string& name : option.names) {
        out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      }
      if (!option.choices.empty()) out += " -x -a " + single_quoted(join_words(option.choices));
      if (!option.takes.empty() && option.choices.empty()) out += is_set_option(option) ? " -x" : " -r";
      if (is_set_option(option)) out += fmt::format(" -a '(__raywatt_settings {})'", set_key_list(verb));
      if (const std::vector<std::string> names = known_names(verb, option); !names.empty()) {
        out += " -a " + single_quoted(join_words(names));
      }
      out += fmt::format(" -d {}\n", single_quoted(help));
    }
  }
  return out;
}

/// Exit codes, as in the table of docs/verbs.md.
constexpr std::array<std::pair<int, std::string_view>, 8> kEndings = {{
    {kGood, "good"},
    {kCheckFailed,
     "a check failed: a ray or a value differs, points of a sweep failed, no point of a search meets the constraints"},
    {kBadInput,
     "bad input, an output that cannot be written, or a processor without AVX2; one line names the place, the fault "
     "and what is allowed. Nothing is written"},
    {kStuckMachine,
     "the simulated machine is stuck, or active without retiring anything; every unit's state is printed"},
    {kOurBug, "a bug of Raywatt"},
    {kIoFailed, "reading or writing failed, for instance a full disk, or the memory of the host ran out"},
    {128 + SIGINT, "interrupted (128 + the signal); finished results are kept, marked partial, and named"},
    {128 + SIGTERM, "the same by SIGTERM"},
}};

/// Escapes special characters of roff, the format of man pages.
std::string escape_roff(std::string_view text) {
  std::string out;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    begins = c == '\n';
  }
  return out;
}

std::string verb_section(const DeclaredVerb& verb) {
  std::string out;
  if (verb.words.size() > 1) out += fmt::format(".SS {}\n", escape_roff(fmt::format("{}", fmt::join(verb.words, " "))));
  out += escape_roff(verb.help) + "\n";
  for (const DeclaredOption& option : verb.options) {
    out += fmt::format(".TP\n\\fB{}\\fR {}\n{}\n", escape_roff(fmt::format("{}", fmt::join(option.names, ", "))),
                       escape_roff(option.takes), escape_roff(option.help));
  }
  if (!verb.footer.empty()) out += fmt::format(".PP\n.nf\n{}\n.fi\n", escape_roff(verb.footer));
  return out;
}

std::string manual_page(const std::vector<DeclaredVerb>& verbs) {
  std::string out = fmt::format(".TH RAYWATT 1 \"\" \"raywatt {}\" \"User Commands\"\n", build_info().version);
  out += ".SH NAME\nraywatt \\- simulator of a mobile ray\\-tracing GPU\n.SH SYNOPSIS\n";
  out += ".B raywatt\nVERB [OPTIONS]\n.SH DESCRIPTION\n" + verb_section(verbs.front()) + ".SH VERBS\n";
  for (std::size_t v = 1; v < verbs.size(); ++v) out += verb_section(verbs[v]);
  out +=
      ".SH ENVIRONMENT\n.TP\n\\fBRAYWATT_PATH\\fR\nfolders of configurations, workloads and scenes, separated by "
      "colons, that are searched first\n.TP\n\\fBRAYWATT_STORE\\fR\nfolder of the results of sweeps\n"
      ".SH EXIT STATUS\n";
  for (const auto& [exit, meaning] : kEndings) out += fmt::format(".TP\n{}\n{}\n", exit, escape_roff(meaning));
  return out;
}

}  // namespace

void add_completion_command(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("completion", "Print a completion script for a shell");
  const auto shell = std::make_shared<std::string>();
  verb->add_option("shell", *shell, "bash, zsh or fish")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  verb->footer("Example: source <(raywatt completion bash)\nAn installation already contains all three scripts.");
  verb->callback([&app, shell] {
    const std::vector<DeclaredVerb> verbs = declared_verbs(app);
    fmt::print("{}", *shell == "bash"  ? bash_completions(verbs)
                     : *shell == "zsh" ? zsh_completions(verbs)
                                       : fish_completions(verbs));
  });
}

void add_man_command(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("man", "Print the manual page: every verb with its options");
  verb->footer("Example: raywatt man | man -l -");
  verb->callback([&app] { fmt::print("{}", manual_page(declared_verbs(app))); });
}

}  // namespace tools
