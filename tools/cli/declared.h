#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tools {

/// An option or a positional argument as a verb declares it.
struct DeclaredOption {
  std::vector<std::string> names;  ///< "-o", "--output"; "file" of a positional argument
  std::string help;
  std::string takes;                 ///< what its value is, as --help shows it; empty for a flag
  std::vector<std::string> choices;  ///< where only these are allowed
  bool is_positional;
};

/// A verb of the program, or the program itself.
struct DeclaredVerb {
  std::vector<std::string> words;  ///< "raywatt", "trace", "replay"
  std::string help, footer;
  std::vector<DeclaredOption> options;
  std::vector<std::string> verbs;  ///< the next words
};

/// The program, its verbs and theirs, each before what is below it.
std::vector<DeclaredVerb> declared_verbs(const CLI::App& app);

}  // namespace tools
