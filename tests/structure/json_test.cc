#include <gtest/gtest.h>

#include "tests/structure/repository.h"
#include "tests/structure/sources.h"

// JSON from outside comes through one reader, which bounds how deep it is nested.

namespace test {
namespace {

TEST(Json, IsParsedByOneReaderAlone) {
  for (const std::filesystem::path& file : source_files()) {
    const std::string path = file.generic_string();
    if (path.starts_with("tests/") || path == "sim/io/json.h") continue;
    const std::string code = take_apart(file).code;
    for (const char* call : {"json::parse(", "Json::parse(", "json::accept(", "Json::accept(", "sax_parse("}) {
      EXPECT_EQ(code.find(call), std::string::npos) << path << ": " << call << " is sim::parse_json (sim/io/json.h)";
    }
  }
}

}  // namespace
}  // namespace test
