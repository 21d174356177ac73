#pragma once
#include <map>
#include <string>
#include <vector>

namespace tools {

/// Places at which the values of a configuration were given last, by path: the text of the line's comment behind
/// "source:", and "FILE:LINE"; or "--set KEY=VALUE". `config` is a name or a file, as for a run.
std::map<std::string, std::string> config_origins(const std::string& config, const std::vector<std::string>& sets);

}  // namespace tools
