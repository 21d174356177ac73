#include <gtest/gtest.h>

#include "tests/structure/repository.h"
#include "tests/structure/sources.h"

// JSON from outside comes through one reader, which bounds how deep it is nested. The library that parses is included
// by that reader alone: its templates took most of the time that tools/ took to compile.

namespace test {
namespace {

TEST(Json, IsParsedByOneReaderAlone) {
  for (const std::filesystem::path& file : source_files()) {
    const std::string path = file.generic_string();
    if (path.starts_with("tests/") || path == "sim/io/json.cc") continue;
    const std::string code = take_apart(file).code;
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
    if (take_apart(file).code.find("nlohmann") == std::string::npos) continue;
    EXPECT_EQ(path, "sim/io/json.cc") << "JSON is sim::Json (sim/io/json.h)";
    ++users;
  }
  EXPECT_EQ(users, 1U) << "the scan sees the source that uses it";
}

}  // namespace
}  // namespace test
