#include <algorithm>
#include <csignal>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tools/run/frame/load_config.h"

// Tests of warnings about a run's inputs, which every verb prints that reads them.

namespace test {
namespace {

const Words kIdle = {"--set", "dram.grade=lpddr5-6400"};
constexpr const char* kSaid = "raywatt: warning: dram.grade is only a name in reports";

/// Returns the text on stderr of a verb that has a setting without effect.
std::string said_by(Words words, const Words& more = kIdle) {
  words.insert(words.end(), more.begin(), more.end());
  const ProcessResult ending = raywatt(words);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return ending.err;
}

TEST(Warnings, OfIneffectiveSettingsArePrintedByEveryVerb) {
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

TEST(Warnings, OfKeysOfASystemCacheOrBackgroundThatAreOffNameTheKeyThatIsMissing) {
  const std::string said =
      said_by({"bottleneck", "--resolution", "16x16"},
              {"--set", "slc.ways=8", "--set", "background.writes=0.5", "--set", "dram.refreshed_part=0.5"});
  EXPECT_SAYS(said, "slc.ways has no effect without slc.size");
  EXPECT_SAYS(said, "background.writes has no effect without background.rate");
  EXPECT_SAYS(said, "dram.refreshed_part has no effect without dram.idle=self_refresh");
}

/// The settings extrapolate a table and mix tables of two processes.
TEST(Warnings, OfTheTablesArePrintedByEveryVerbThatReadsAConfiguration) {
  const TempFolder folder;
  const std::string out = (folder.path() / "out").string(), trace = (folder.path() / "a.trace").string(),
                    rays = folder.write("a.rays", ray_list(8)).string();
  ASSERT_EQ(raywatt({"trace", "record", trace, "--resolution", "16x16", "--quiet"}).exit, 0);
  const Words wrong = {"--set", "tni.trv.l1.size=512B", "--set", "area.extends=7nm"};
  for (const Words& verb : std::vector<Words>{{"run", "--resolution", "16x16", "-o", out},
                                              {"run", "--rays", rays, "-o", out + "-rays"},
                                              {"bottleneck", "--resolution", "16x16"},
                                              {"dvfs", "--resolution", "16x16", "--factors", "1"},
                                              {"sustain", "--resolution", "16x16", "--minutes", "0.1"},
                                              {"bench", "--scene", "cornell", "--resolution", "16x16", "--runs", "1"},
                                              {"verify", "--resolution", "16x16", "-o", out + "-verify"},
                                              {"trace", "replay", trace, "-o", out + "-replay"},
                                              {"config", "show"},
                                              {"energy", "show", "tni.box_test"},
                                              {"microbench", "chase"}}) {
    const std::string said = said_by(verb, wrong);
    EXPECT_SAYS(said, "the array of tni.trv has 512 B, outside 1 KiB to 16 MiB");
    EXPECT_SAYS(said, "results mix processes");
  }
}

TEST(Warnings, OfTheRunArePrintedByBottleneckAndAreInItsJson) {
  const Words words = {"bottleneck", "--resolution", "16x16", "--json", "--set", "tni.trv.l1.size=512B"};
  const ProcessResult ending = raywatt(words);
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.err, "the array of tni.trv has 512 B");
  EXPECT_FALSE(nlohmann::json::parse(ending.out)["warnings"].empty());
}

TEST(Warnings, OfLongWorkArePrintedToAnyStandardError) {
  const TempFolder folder;
  const std::string out = (folder.path() / "out").string();
  for (const Words& verb : {Words{"run", "-o", out}, Words{"verify", "-o", out}, Words{"trace", "record", out}}) {
    Words words = verb;
    words.insert(words.end(), {"--program", "full:256", "--resolution", "2048x1024", "--threads", "1"});
    Program program(words);
    EXPECT_TRUE(program.wait_for_complaint());
    program.send(SIGKILL);
    EXPECT_SAYS(program.wait().err, "raywatt: this may take about ");
  }
}

TEST(IdleSettings, AreEachSaidOnceInAnyOrder) {
  tools::JobOptions options;
  tools::RunConfig config;
  config.render.mip_maps = traces::MipMaps::kOff;
  for (const Words& sets : {Words{"dram.grade=LPDDR5-6400", "render.mip_filter=nearest", "render.mip_filter=linear"},
                            Words{"render.mip_filter=nearest", "render.mip_filter=linear", "dram.grade=LPDDR5-6400"}}) {
    options.sets = sets;
    EXPECT_EQ(tools::ineffective_setting_warnings(options, config).size(), 2U) << sets.front();
  }
}

TEST(IdleSettings, AreKeysOfOnesOwnCameraLightsAndSkyWhileTheScenesAreTaken) {
  tools::JobOptions options;
  tools::RunConfig config;
  options.sets = {"scene.view.position=1 2 3",    "scene.view.source=scene",      "scene.sky.background=1 1 1",
                  "scene.lights.position=0 1 0",  "scene.lights.intensity=1 1 1", "scene.orbit=10",
                  "scene.lights.direction=0 1 0", "scene.view.position=1 2 4"};
  const std::vector<std::string> said = tools::ineffective_setting_warnings(options, config);
  ASSERT_EQ(said.size(), 6U);
  EXPECT_EQ(said[0], "scene.view.position has no effect without scene.view.source=own");
  config.scene.view.source = traces::ViewSource::kOwn;
  config.scene.sky.source = traces::Sky::kOwn;
  config.scene.lights.rig = traces::LightRig::kPoint;
  config.scene.camera_path = traces::CameraPath::kOrbit;
  EXPECT_EQ(tools::ineffective_setting_warnings(options, config),
            Words{"scene.lights.direction has no effect without scene.lights.rig=sun"});
}

TEST(IdleSettings, APatternOfSamplesHoldsForTheReferenceAlone) {
  tools::JobOptions options;
  tools::RunConfig config;
  config.render.samples = kernels::SamplePattern::kJittered;
  options.reference = "full:4";
  for (const char* program : {"multirate:super", "undersample"}) {
    options.program = program;
    EXPECT_EQ(tools::ineffective_setting_warnings(options, config).size(), 1U) << program;
  }
  options.program = "supersample";
  EXPECT_EQ(tools::ineffective_setting_warnings(options, config).size(), 0U);
  config.render.samples = kernels::SamplePattern::kRegular;
  options.program = "undersample";
  EXPECT_EQ(tools::ineffective_setting_warnings(options, config).size(), 0U);
}

}  // namespace
}  // namespace test
