#include <gtest/gtest.h>

#include "tests/structure/repository.h"

namespace test {
namespace {

constexpr std::size_t kMaxLines = 800;

TEST(SourceFiles, HaveAtMostEightHundredLines) {
  const std::vector<std::filesystem::path> files = source_files();
  EXPECT_GT(files.size(), 500U) << "the scan finds the sources";
  for (const std::filesystem::path& file : files) EXPECT_LE(lines_of(file).size(), kMaxLines) << file.string();
}

}  // namespace
}  // namespace test
