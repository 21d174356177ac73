#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace test {

/// Returns the root of the source tree.
std::filesystem::path repository();

/// Returns all files of the source tree, sorted and relative to its root. Without hidden folders, builds and results.
std::vector<std::filesystem::path> repository_files();

/// Returns all C++ source files and headers of the source tree.
std::vector<std::filesystem::path> source_files();

/// Returns the lines of a file. `file`: path relative to the root of the source tree.
std::vector<std::string> lines_of(const std::filesystem::path& file);

}  // namespace test
