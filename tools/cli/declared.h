#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tools {

/// An option or a positional argument of a verb.
struct DeclaredOption {
  std::vector<std::string> names;  ///< "-o", "--output"; "file" for a positional argument
  std::string help;
  std::string takes;                 ///< type of its value as in --help; empty for a flag
  std::vector<std::string> choices;  ///< the only allowed values, if restricted
  bool is_positional;
};

/// A verb of the program, or the program itself.
struct DeclaredVerb {
  std::vector<std::string> words;  ///< "raywatt", "trace", "replay"
  std::string help, footer;
  std::vector<DeclaredOption> options;
  std::vector<std::string> verbs;  ///< its subcommands
};

/// Returns the program, its verbs and their subcommands, parents first.
std::vector<DeclaredVerb> declared_verbs(const CLI::App& app);

}  // namespace tools
