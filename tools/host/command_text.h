#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace tools {

/// A word between single quotes, as a shell takes it whatever is in it.
std::string single_quoted(std::string_view word);

/// A command as a shell takes it, words quoted where need be.
std::string command_text(const std::vector<std::string>& words);

}  // namespace tools
