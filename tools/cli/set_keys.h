#pragma once
#include <string>
#include <utility>
#include <vector>

namespace tools {

/// Keys that --set takes, for scripts that complete command lines.
struct SetKeys {
  std::vector<std::string> every, of_energy;  ///< in the order of their declaration; the latter: of energy alone
  std::vector<std::pair<std::string, std::vector<std::string>>> values;  ///< words that a key takes, or names of files
};
SetKeys set_keys();

}  // namespace tools
