#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/temp_folder.h"
#include "tests/tools/program.h"

// Tests of rays of a list that end at their first hit.

namespace test {
namespace {

TEST(AnyHit, FindsAsManyHitsInFewerSteps) {
  const TempFolder folder;
  const std::string rays = folder.write("a.rays", ray_list(2000)).string();
  const auto totals = [&](const Words& more) {
    Words words = {
        "run",    "--rays", rays, "--scene", "chess", "--json", "--quiet", "-o", (folder.path() / "out").string(),
        "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult ending = raywatt(words);
    EXPECT_EQ(ending.exit, 0) << ending.err;
    return nlohmann::json::parse(ending.out);
  };
  const nlohmann::json nearest = totals({}), any = totals({"--any-hit"});
  EXPECT_GT(nearest["rays"]["hits"], 0);
  EXPECT_EQ(any["rays"]["hits"], nearest["rays"]["hits"]);
  EXPECT_LT(any["traversal_steps"], nearest["traversal_steps"]);
}

TEST(AnyHit, NeedsAListOfRays) { EXPECT_EQ(raywatt({"run", "--any-hit"}).exit, 2); }

}  // namespace
}  // namespace test
