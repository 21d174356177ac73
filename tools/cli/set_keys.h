#pragma once
#include <string>
#include <utility>
#include <vector>

namespace tools {

/// The keys of --set, for completion scripts.
struct SetKeys {
  std::vector<std::string> every, of_energy;  ///< in order of declaration; `of_energy`: keys that affect energy only
  std::vector<std::pair<std::string, std::vector<std::string>>> values;  ///< values of a key: words, or names of files
};
SetKeys set_keys();

}  // namespace tools
