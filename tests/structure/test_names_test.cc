#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "tests/structure/repository.h"

// Tests that suite and name of each test are a sentence in PascalCase, as CONTRIBUTING.md demands.

namespace test {
namespace {

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

}  // namespace
}  // namespace test
