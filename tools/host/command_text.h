#pragma once
#include <string>
#include <vector>

namespace tools {

/// A command as a shell takes it, words quoted where need be.
std::string command_text(const std::vector<std::string>& words);

}  // namespace tools
