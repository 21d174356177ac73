#include <string>

#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "traces/scenes/builtin.h"

namespace test {
namespace {

class BuiltIn : public testing::TestWithParam<std::string> {};

/// Small pictures; of the hairball, an eighth of its strands.
TEST_P(BuiltIn, AgreesWithEmbreeRayForRayAndInItsPicture) {
  const TempFolder folder;
  Words words = {"verify", "--scene", GetParam(), "--resolution", "200x100", "--quiet", "-o", folder.path().string()};
  if (GetParam() == "hairball") words.insert(words.end(), {"--set", "scene.triangles=360000"});
  const Ending ending = raywatt(words);
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json verdict = read_json(folder.path() / "verify.json");
  EXPECT_EQ(verdict["missing_hits"], 0);
  EXPECT_EQ(verdict["extra_hits"], 0);
  EXPECT_EQ(verdict["distance_errors"], 0);
  EXPECT_TRUE(verdict["identical"] || verdict["psnr_db"] >= 55) << verdict["psnr_db"];
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const traces::BuiltinInfo& scene : traces::builtin_scenes()) all.push_back(scene.name);
  return all;
}

INSTANTIATE_TEST_SUITE_P(Scenes, BuiltIn, testing::ValuesIn(names()), [](const auto& test) { return test.param; });

}  // namespace
}  // namespace test
