#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace test {

/// An #include "..." in a source file that names another file of the repository.
struct Include {
  std::filesystem::path from, to;  ///< relative to the root of the repository
  std::string where;               ///< "file:line"
};

/// Returns all includes of the repository, without those of generated headers.
std::vector<Include> includes();

/// A source file, split into code and comments.
struct SourceText {
  std::string code;                   ///< without comments, string and character literals
  std::vector<std::string> comments;  ///< without slashes; consecutive comment lines are joined
};
SourceText split_code_and_comments(const std::filesystem::path& file);

}  // namespace test
