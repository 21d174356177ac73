#include <algorithm>
#include <array>
#include <optional>
#include <regex>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/structure/repository.h"
#include "tests/structure/sources.h"

// Tests that files include only files of the same or a lower layer. Layers are called floors here.

namespace test {
namespace {

namespace fs = std::filesystem;

struct Floor {
  std::string_view folder;
  int height;
};

/// Heights of the folders. A file belongs to the first folder in this list that contains it.
constexpr std::array kFloors = {
    Floor{"tests", 20},
    Floor{"tools/cli", 19},
    Floor{"tools/studies/worth", 18},
    Floor{"tools/studies/optimise", 18},
    Floor{"tools/studies/report", 18},
    Floor{"tools/studies", 17},
    Floor{"tools/run/frame", 12},
    Floor{"tools/run", 16},
    Floor{"tools/timeline", 15},
    Floor{"tools/tiles", 14},
    Floor{"tools/sampling", 14},
    Floor{"tools/intervals", 14},
    Floor{"tools/pricing", 14},
    Floor{"tools/analysis", 13},
    Floor{"tools/host", 11},
    Floor{"tools/noise", 11},
    Floor{"hw_models/machines", 10},
    Floor{"hw_models/raster", 9},
    Floor{"hw_models/build", 9},
    Floor{"traces/raster", 4},
    Floor{"hw_models/frame", 9},
    Floor{"hw_models/srp", 8},
    Floor{"hw_models/tni", 8},
    Floor{"hw_models/dram", 8},
    Floor{"hw_models/memory", 7},
    Floor{"shader_kernels/programs", 6},
    Floor{"shader_kernels", 5},
    Floor{"traces/accel", 4},
    Floor{"traces/trace_file", 4},
    Floor{"traces/scenes", 3},
    Floor{"traces", 2},
    Floor{"sim/report", 1},
    Floor{"sim/config", 1},
    Floor{"sim/io", 1},
    Floor{"sim", 0},
};

std::optional<int> floor_of(const fs::path& file) {
  for (const Floor& floor : kFloors) {
    if (file.generic_string().starts_with(std::string(floor.folder) + "/")) return floor.height;
  }
  return std::nullopt;
}

TEST(Includes, PointDownOnly) {
  const std::vector<Include> all = includes();
  EXPECT_GT(all.size(), 300U) << "the scan sees the sources";
  for (const Include& include : all) {
    const std::optional<int> from = floor_of(include.from), to = floor_of(include.to);
    EXPECT_TRUE(from && to) << include.where << " is on no floor";
    EXPECT_LE(to, from) << include.where << " includes " << include.to.string() << ", which is on a floor above";
  }
}

TEST(Includes, NeverNameATestOutsideTheTests) {
  for (const Include& include : includes()) {
    const bool outside = !include.from.string().starts_with("tests/");
    EXPECT_FALSE(outside && include.to.string().starts_with("tests/")) << include.where;
  }
}

TEST(Includes, OfTheCommandLineLibraryAreInItsFolderAlone) {
  for (const fs::path& file : source_files()) {
    if (file.generic_string().starts_with("tools/cli/")) continue;
    for (const std::string& line : lines_of(file)) EXPECT_FALSE(line.starts_with("#include <CLI/")) << file.string();
  }
}

TEST(Headers, AllBeginWithPragmaOnce) {
  for (const fs::path& file : source_files()) {
    if (file.extension() != ".h") continue;
    const std::vector<std::string> lines = lines_of(file);
    EXPECT_NE(std::ranges::find(lines, "#pragma once"), lines.end()) << file.string();
  }
}

TEST(Files, MentionNoFolderOfAMachine) {
  // Split into pieces, so that this file does not match its own expression.
  static const std::regex kMachine(std::string("(^|[^A-Za-z0-9_.~/-])/") +
                                   "(home|root|work|Users|mnt|media|scratch)/[A-Za-z0-9_.-]");
  for (const fs::path& file : repository_files()) {
    const std::string extension = file.extension().string();
    if (extension == ".png" || extension == ".glb" || extension == ".exr" || extension == ".jpg") continue;
    int number = 0;
    for (const std::string& line : lines_of(file)) {
      ++number;
      EXPECT_FALSE(line.size() < 2000 && std::regex_search(line, kMachine))
          << file.string() << ':' << number << ": " << line;
    }
  }
}

// Tests that all JSON input is parsed by one reader, which limits its nesting. Only that reader includes the JSON
// library, because its templates took most of the compile time of tools/.

TEST(Json, IsParsedByOneReaderAlone) {
  for (const std::filesystem::path& file : source_files()) {
    const std::string path = file.generic_string();
    if (path.starts_with("tests/") || path == "sim/io/json.cc") continue;
    const std::string code = split_code_and_comments(file).code;
    for (const char* call : {"json::parse(", "Json::parse(", "json::accept(", "Json::accept(", "sax_parse("}) {
      EXPECT_EQ(code.find(call), std::string::npos) << path << ": " << call << " is sim::parse_json (sim/io/json.h)";
    }
  }
}

TEST(Json, LibraryIsUsedByOneSourceAlone) {
  std::size_t users = 0;
  for (const std::filesystem::path& file : source_files()) {
    const std::string path = file.generic_string();
    if (path.starts_with("tests/")) continue;
    if (split_code_and_comments(file).code.find("nlohmann") == std::string::npos) continue;
    EXPECT_EQ(path, "sim/io/json.cc") << "JSON is sim::Json (sim/io/json.h)";
    ++users;
  }
  EXPECT_EQ(users, 1U) << "the scan sees the source that uses it";
}

// Tests that suite and name of each test are a sentence in PascalCase, as CONTRIBUTING.md demands.

TEST(TestNames, ArePascalCase) {
  static const std::regex kTest(R"(^(?:TYPED_)?TEST(?:_[FP])?\((\w+), *(\w+)\))");
  static const std::regex kPascal("[A-Z][A-Za-z0-9]*");
  std::size_t tests = 0;
  for (const std::filesystem::path& file : source_files()) {
    for (const std::string& line : lines_of(file)) {
      std::smatch found;
      if (!std::regex_search(line, found, kTest)) continue;
      ++tests;
      for (const auto& name : {found[1], found[2]}) {
        EXPECT_TRUE(std::regex_match(name.str(), kPascal)) << file.string() << ": " << name.str();
      }
    }
  }
  EXPECT_GT(tests, 1000U) << "the scan sees the tests";
}

constexpr std::size_t kMaxLines = 800;

TEST(SourceFiles, HaveAtMostEightHundredLines) {
  const std::vector<std::filesystem::path> files = source_files();
  EXPECT_GT(files.size(), 500U) << "the scan finds the sources";
  for (const std::filesystem::path& file : files) EXPECT_LE(lines_of(file).size(), kMaxLines) << file.string();
}

}  // namespace
}  // namespace test
