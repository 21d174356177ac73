#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tools/simulation/load_config.h"

// Warnings of a run's inputs, which every verb that reads them tells.

namespace test {
namespace {

const Words kIdle = {"--set", "dram.grade=lpddr5-6400"};
constexpr const char* kSaid = "raywatt: warning: dram.grade is a name for reports and takes no figures";

/// Standard error of a verb with a setting that does nothing.
std::string said_by(Words words, const Words& more = kIdle) {
  words.insert(words.end(), more.begin(), more.end());
  const Ending ending = raywatt(words);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return ending.err;
}

TEST(Warnings, OfSettingsThatDoNothingAreToldByEveryVerb) {
  const TempFolder folder;
  const std::string out = (folder.path() / "out").string(), trace = (folder.path() / "a.trace").string(),
                    rays = folder.write("a.rays", ray_list(8)).string();
  ASSERT_EQ(raywatt({"trace", "record", trace, "--resolution", "16x16", "--quiet"}).exit, 0);
  for (const Words& verb : std::vector<Words>{{"bottleneck", "--resolution", "16x16"},
                                              {"dvfs", "--resolution", "16x16", "--factors", "1"},
                                              {"bench", "--scene", "cornell", "--resolution", "16x16", "--runs", "1"},
                                              {"verify", "--resolution", "16x16", "-o", out},
                                              {"verify", "--rays", rays, "-o", out},
                                              {"trace", "replay", trace, "-o", out + "-replay"}}) {
    const std::string said = said_by(verb);
    EXPECT_SAYS(said, kSaid);
    EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
  }
}

TEST(Warnings, OfTheRunAreToldByBottleneckAndStandInItsJson) {
  const Words words = {"bottleneck", "--resolution", "16x16", "--json", "--set", "tni.trv.l1.size=512KiB"};
  const Ending ending = raywatt(words);
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.err, "the array of tni.trv has 512 KiB");
  EXPECT_FALSE(nlohmann::json::parse(ending.out)["warnings"].empty());
}

TEST(IdleSettings, AreEachSaidOnceInAnyOrder) {
  tools::JobOptions options;
  tools::RunConfig config;
  config.render.mip_maps = traces::MipMaps::kOff;
  for (const Words& sets : {Words{"dram.grade=LPDDR5-6400", "render.mip_filter=nearest", "render.mip_filter=linear"},
                            Words{"render.mip_filter=nearest", "render.mip_filter=linear", "dram.grade=LPDDR5-6400"}}) {
    options.sets = sets;
    EXPECT_EQ(tools::idle_settings(options, config).size(), 2U) << sets.front();
  }
}

}  // namespace
}  // namespace test
