#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace test {

/// The root of the source tree.
std::filesystem::path repository();

/// Every file of the source tree, relative to its root, sorted: without hidden folders, builds and results of runs.
std::vector<std::filesystem::path> repository_files();

/// C++ sources and headers among them.
std::vector<std::filesystem::path> source_files();

/// The lines of a file, given relative to the root.
std::vector<std::string> lines_of(const std::filesystem::path& file);

}  // namespace test
