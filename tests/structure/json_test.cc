#include <gtest/gtest.h>

#include "tests/structure/repository.h"
#include "tests/structure/sources.h"

// Tests that all JSON input is parsed by one reader, which limits its nesting. Only that reader includes the JSON
// library, because its templates took most of the compile time of tools/.

namespace test {
namespace {

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

}  // namespace
}  // namespace test
