#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace tools {

/// Returns a word in single quotes for a shell.
std::string single_quoted(std::string_view word);

/// Returns a command for a shell; words are quoted where necessary.
std::string command_text(const std::vector<std::string>& words);

}  // namespace tools
