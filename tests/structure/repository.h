#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace test {

/// Returns the root of the source tree.
std::filesystem::path repository();

/// Returns the sorted paths of all files of the source tree, relative to its root. Leaves out hidden folders, builds
/// and results.
std::vector<std::filesystem::path> repository_files();

/// Returns all C++ source files and headers of the source tree.
std::vector<std::filesystem::path> source_files();

/// Returns the lines of a file. `file`: path relative to the root of the source tree.
std::vector<std::string> lines_of(const std::filesystem::path& file);

}  // namespace test
