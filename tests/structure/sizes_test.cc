#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/structure/repository.h"

// What a reader can hold: files of a subject, folders of a screen. Exceptions are a list that gets shorter: they go
// when they are no longer needed, and never grow.

namespace test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostLines = 299, kMostSources = 30, kMostOfAFunction = 60;

/// Path, and the most that is tolerated.
using Exceptions = std::map<std::string, std::size_t>;

/// The kernels are a vocabulary: one word a file.
const Exceptions kFullFolders = {
    {"shader_kernels/kernels", 1000},
};

std::size_t indent_of(const std::string& line) { return std::min(line.find_first_not_of(' '), line.size()); }

/// Whether the line ends the head of a function, as clang-format sets it.
bool opens_function(const std::string& line) {
  static constexpr std::array<std::string_view, 9> kOthers = {"if ",  "for ", "while ", "switch ",   "}",
                                                              "do {", "else", "return", "const auto"};
  const std::string_view text = std::string_view(line).substr(indent_of(line));
  return line.ends_with(" {") && line.find(')') != std::string::npos && text.find(" = ") == std::string_view::npos &&
         std::ranges::none_of(kOthers, [&](std::string_view other) { return text.starts_with(other); });
}

/// Whether a head may go on below the line: no statement, block or comment ends there.
bool goes_on(const std::string& line) {
  static constexpr std::string_view kEnds = ";{}:";
  return !line.empty() && kEnds.find(line.back()) == std::string_view::npos && line.find("//") == std::string::npos;
}

/// Lines of the longest function of a file. Functions within functions are not looked at.
std::size_t longest_function(const fs::path& file) {
  const std::vector<std::string> lines = lines_of(file);
  std::size_t longest = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!opens_function(lines[i])) continue;
    std::size_t head = i;
    while (head > 0 && indent_of(lines[head]) >= 4 && goes_on(lines[head - 1])) --head;
    const std::size_t indent = indent_of(lines[head]);
    if (indent > 2) continue;
    std::size_t end = i + 1;
    while (end < lines.size() && !(indent_of(lines[end]) == indent && lines[end][indent] == '}')) ++end;
    longest = std::max(longest, end - head + 1);
  }
  return longest;
}

/// Holds sizes against a limit that all but the exceptions keep.
void hold(const std::map<std::string, std::size_t>& sizes, std::size_t limit, const Exceptions& exceptions) {
  for (const auto& [path, size] : sizes) {
    const auto exception = exceptions.find(path);
    EXPECT_LE(size, exception == exceptions.end() ? limit : exception->second) << path;
  }
  for (const auto& [path, most] : exceptions) {
    EXPECT_TRUE(sizes.contains(path) && sizes.at(path) > limit) << path << " needs no exception any more";
  }
}

TEST(SourceFiles, AreShorterThanThreeHundredLines) {
  std::map<std::string, std::size_t> lines;
  for (const fs::path& file : source_files()) lines[file.generic_string()] = lines_of(file).size();
  EXPECT_GT(lines.size(), 500U);
  hold(lines, kMostLines, {});
}

TEST(Functions, FitAScreen) {
  std::map<std::string, std::size_t> lines;
  for (const fs::path& file : source_files()) lines[file.generic_string()] = longest_function(file);
  EXPECT_GT(std::ranges::count_if(lines, [](const auto& of_file) { return of_file.second > 20; }), 100);
  hold(lines, kMostOfAFunction, {});
}

TEST(Folders, HoldSourcesOfAScreen) {
  std::map<std::string, std::size_t> sources;
  for (const fs::path& file : source_files()) ++sources[file.parent_path().generic_string()];
  hold(sources, kMostSources, kFullFolders);
}

}  // namespace
}  // namespace test
