#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/structure/repository.h"

// Tests that files and headings which documentation pages name exist.

namespace test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> documents() {
  std::vector<fs::path> files = repository_files();
  std::erase_if(files, [](const fs::path& file) { return file.extension() != ".md"; });
  return files;
}

struct Line {
  std::string text;
  std::string where;  ///< "file:line"
};

/// Returns the lines of a page that are not in code blocks.
std::vector<Line> prose_of(const fs::path& document) {
  std::vector<Line> prose;
  bool code = false;
  int number = 0;
  for (const std::string& line : lines_of(document)) {
    ++number;
    if (line.starts_with("```")) code = !code;
    if (!code) prose.push_back({line, document.string() + ":" + std::to_string(number)});
  }
  return prose;
}

/// Returns the matches of an expression's only group in a line.
std::vector<std::string> matches(const std::string& line, const std::regex& expression) {
  std::vector<std::string> found;
  for (std::sregex_iterator i(line.begin(), line.end(), expression), end; i != end; ++i) found.push_back((*i)[1]);
  return found;
}

/// Returns the anchor of a heading for links, as GitHub generates it.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading.substr(heading.find_first_not_of("# "))) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 || c == '-' || c == '_') anchor += static_cast<char>(std::tolower(byte));
    if (c == ' ') anchor += '-';
  }
  return anchor;
}

std::set<std::string> anchors_of(const fs::path& document) {
  std::set<std::string> anchors;
  for (const Line& line : prose_of(document)) {
    if (line.text.starts_with("#")) anchors.insert(anchor_of(line.text));
  }
  return anchors;
}

TEST(Documents, LinkToWhatIsThere) {
  static const std::regex kLink("\\]\\(([^)\\s]+)\\)");
  std::size_t links = 0;
  for (const fs::path& document : documents()) {
    for (const Line& line : prose_of(document)) {
      for (const std::string& link : matches(line.text, kLink)) {
        if (link.find("://") != std::string::npos) continue;
        ++links;
        const std::string name = link.substr(0, link.find('#'));
        const fs::path to = name.empty() ? document : (document.parent_path() / name).lexically_normal();
        ASSERT_TRUE(fs::exists(repository() / to)) << line.where << ": " << link;
        if (link.find('#') == std::string::npos) continue;
        EXPECT_TRUE(anchors_of(to).contains(link.substr(link.find('#') + 1))) << line.where << ": " << link;
      }
    }
  }
  EXPECT_GT(links, 100U) << "the scan sees the links";
}

TEST(Documents, NameSourceFilesThatAreThere) {
  // A word in capitals is a placeholder for any name.
  static const std::regex kSource("`([A-Za-z0-9_][A-Za-z0-9_./-]*[a-z0-9_]\\.(?:h|cc))`");
  const std::vector<fs::path> sources = source_files();
  for (const fs::path& document : documents()) {
    for (const Line& line : prose_of(document)) {
      for (const std::string& name : matches(line.text, kSource)) {
        const auto is_named = [&](const fs::path& source) {
          const std::string path = source.generic_string();
          return path == name || (path.ends_with(name) && path[path.size() - name.size() - 1] == '/');
        };
        const bool found = name.starts_with("../") || std::ranges::any_of(sources, is_named);
        EXPECT_TRUE(found) << line.where << ": " << name;
      }
    }
  }
}

constexpr std::size_t kScreen = 60;

/// Returns the main folders, whose README.md must also describe how to add something.
std::set<fs::path> folders_with_a_page() {
  static constexpr std::array<std::string_view, 5> kTops = {"sim", "hw_models", "shader_kernels", "traces", "tools"};
  std::set<fs::path> folders = {"configs", "tests"};
  for (const fs::path& file : repository_files()) {
    const fs::path folder = file.parent_path();
    if (folder.empty() || std::ranges::count(kTops, folder.begin()->string()) == 0) continue;
    const auto depth = std::distance(folder.begin(), folder.end());
    if (depth <= 2 || (depth == 3 && folder.parent_path() == "tools/studies")) folders.insert(folder);
  }
  folders.insert("tools/studies/sweep/results");
  return folders;
}

TEST(Folders, HaveAPageOfAScreen) {
  EXPECT_GT(folders_with_a_page().size(), 35U);
  for (const fs::path& folder : folders_with_a_page()) {
    const std::vector<std::string> lines = lines_of(folder / "README.md");
    ASSERT_FALSE(lines.empty()) << folder.string() << " has no README.md";
    EXPECT_LE(lines.size(), kScreen) << folder.string();
    const auto says = [&](std::string_view what) {
      return std::ranges::any_of(lines, [&](const std::string& line) { return line.find(what) != std::string::npos; });
    };
    EXPECT_TRUE(lines[0].starts_with("# " + folder.generic_string())) << folder.string() << ": " << lines[0];
    EXPECT_TRUE(says("```")) << folder.string() << ": no drawing";
    EXPECT_TRUE(says("**To ") || says("**to ")) << folder.string() << ": does not say how to add something";
  }
}

/// Returns patterns of the source files that a page names: "plan" for `spec/plan.h`, "supersample_[a-z0-9_]*" for
/// `supersample_*.cc`.
std::vector<std::regex> sources_named_by(const fs::path& page) {
  static const std::regex kSource("`([A-Za-z0-9_./*-]+)\\.(?:h|cc)`"), kStar("\\*");
  std::vector<std::regex> named;
  for (const std::string& line : lines_of(page)) {
    for (const std::string& path : matches(line, kSource)) {
      named.emplace_back(std::regex_replace(fs::path(path).filename().string(), kStar, "[a-z0-9_]*"));
    }
  }
  return named;
}

TEST(Folders, HaveAPageThatNamesEverySource) {
  // Folders of tests mirror the others, so that one page for all of them is enough.
  std::map<fs::path, std::set<std::string>> sources;
  for (const fs::path& file : source_files()) {
    if (*file.begin() != "tests") sources[file.parent_path()].insert(file.stem().string());
  }
  EXPECT_GT(sources.size(), 50U);
  for (const auto& [folder, stems] : sources) {
    const std::vector<std::string> lines = lines_of(folder / "README.md");
    ASSERT_FALSE(lines.empty()) << folder.string() << " has no README.md";
    EXPECT_LE(lines.size(), kScreen) << folder.string();
    EXPECT_TRUE(lines[0].starts_with("# " + folder.generic_string() + ": ")) << folder.string() << ": " << lines[0];
    const std::vector<std::regex> named = sources_named_by(folder / "README.md");
    for (const std::string& stem : stems) {
      const auto names = [&](const std::regex& pattern) { return std::regex_match(stem, pattern); };
      EXPECT_TRUE(std::ranges::any_of(named, names)) << folder.string() << "/README.md does not name " << stem;
    }
  }
}

}  // namespace
}  // namespace test
