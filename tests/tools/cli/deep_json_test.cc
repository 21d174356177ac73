#include <filesystem>

#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "tests/tools/studies/sweep/small_sweep.h"

// Tests of JSON that is nested deeply enough to exhaust the stack of a recursive reader.

namespace test {
namespace {

std::string deep(const std::string& before, const std::string& behind) {
  constexpr std::size_t kLevels = 200'000;
  return before + std::string(kLevels, '[') + std::string(kLevels, ']') + behind;
}

TEST(DeepJson, OfASweepsFolderIsRefused) {
  const TempFolder folder;
  std::filesystem::create_directories(folder.path() / "out");
  folder.write("out/sweep.json", deep(R"({"of": )", "}"));
  const std::filesystem::path file = write_sweep(folder, "axes: {cores: [1, 2]}\n");
  expect_refusal(raywatt(sweep_run(folder, file)), {"sweep.json", "64 levels"});
  expect_refusal(raywatt({"sweep", "status", (folder.path() / "out").string()}), {"sweep.json", "64 levels"});
}

TEST(DeepJson, OfBenchResultsIsRefused) {
  const TempFolder folder;
  const std::string file = folder.write("bench.json", deep(R"({"scenes": )", "}")).string();
  expect_refusal(raywatt({"bench", "--resolution", "4x4", "--scene", "cornell", "--runs", "1", "--threads", "1",
                          "--set", "scene.triangles=60", "--against", file}),
                 {"bench.json", "64 levels"});
}

}  // namespace
}  // namespace test
