#include "tests/structure/repository.h"

#include <algorithm>
#include <fstream>

namespace test {

namespace fs = std::filesystem;

namespace {

bool is_skipped(const fs::path& folder) {
  const std::string name = folder.filename().string();
  const bool hidden = name.starts_with('.') && name != ".ci";
  const bool made = folder.parent_path() == repository() && (name.starts_with("build") || name == "raywatt-out");
  return hidden || made || fs::exists(folder / "CMakeCache.txt");
}

}  // namespace

fs::path repository() { return RAYWATT_SOURCE_DIR; }

std::vector<fs::path> repository_files() {
  std::vector<fs::path> files;
  for (auto entry = fs::recursive_directory_iterator(repository()); entry != fs::end(entry); ++entry) {
    if (entry->is_directory() && is_skipped(entry->path())) entry.disable_recursion_pending();
    if (entry->path().filename() == ".git") continue;  // a file, not a folder, in a second working tree
    if (entry->is_regular_file()) files.push_back(entry->path().lexically_relative(repository()));
  }
  std::ranges::sort(files);
  return files;
}

std::vector<fs::path> source_files() {
  std::vector<fs::path> files = repository_files();
  std::erase_if(files, [](const fs::path& file) { return file.extension() != ".h" && file.extension() != ".cc"; });
  return files;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream stream(repository() / file);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace test
