#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace test {

/// An #include "..." of a source file that names a file of the repository.
struct Include {
  std::filesystem::path from, to;  ///< relative to the root
  std::string where;               ///< "file:line"
};

/// All of them; a generated header is not one.
std::vector<Include> includes();

/// A source file taken apart.
struct SourceText {
  std::string code;                   ///< without comments, string and character literals
  std::vector<std::string> comments;  ///< each in one line, without its slashes; lines that follow each other are one
};
SourceText take_apart(const std::filesystem::path& file);

}  // namespace test
