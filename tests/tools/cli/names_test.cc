#include <algorithm>
#include <csignal>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tests/traces/scene/tiny_gltf_file.h"
#include "tools/run/frame/load_config.h"

// Tests of messages about names: an unknown name is answered with the nearest one. A setting causes a warning if it has
// no effect, or a greater effect than intended.

namespace test {
namespace {

TEST(Names, ASceneInTheConfigurationsStead) {
  expect_refusal(raywatt({"run", "teapot"}), {"'teapot' is a scene", "--scene teapot"});
  expect_refusal(raywatt({"run", "card.gltf"}), {"'card.gltf' is a scene", "--scene card.gltf"});
  expect_refusal(raywatt({"run", "lee2016-teapot"}), {"is a workload", "--scene lee2016-teapot"});
  expect_refusal(raywatt({"run", "teapt"}), {"no configuration is called 'teapt', did you mean --scene teapot?"});
  expect_refusal(raywatt({"run", "lee2016-taepot"}), {"did you mean --scene lee2016-teapot?"});
  expect_refusal(raywatt({"run", "sgrt-2061"}), {"did you mean 'sgrt-2016'?"});
}

TEST(Names, GetTheNearestOneOfTheirKind) {
  const auto expect_nearest = [](const Words& arguments, const std::string& nearest) {
    expect_refusal(raywatt(arguments), {"did you mean '" + nearest + "'?"});
  };
  expect_nearest({"rnu"}, "run");
  expect_nearest({"run", "--scen", "teapot"}, "--scene");
  expect_nearest({"run", "--scene", "taepot"}, "teapot");
  expect_nearest({"run", "--scene", "lee2016-taepot"}, "lee2016-teapot");
  expect_nearest({"config", "show", "sgrt-2061"}, "sgrt-2016");
  expect_nearest({"config", "show", "--set", "cors=2"}, "cores");
  expect_nearest({"config", "show", "--set", "dram.extends=dram/lpddr4x-4277"}, "dram/lpddr4x-4266");
  expect_nearest({"config", "show", "--set", "energy.extends=14mm"}, "energy/14nm");
  expect_nearest({"config", "show", "--set", "area.extends=area/7mn"}, "area/7nm");
  expect_nearest({"run", "--program", "undersampel"}, "undersample");
  expect_nearest({"config", "show", "--set", "dram.extends=lpddr4x-4277"}, "dram/lpddr4x-4266");
  expect_nearest({"energy", "show", "tni.box_tset"}, "tni.box_test");
  expect_nearest({"energy", "show", "box_tst"}, "box_test");
  expect_nearest({"energy", "show", "cahce"}, "cache");
  expect_nearest({"energy", "show", "energy.events.tni.box_tst"}, "energy.events.tni.box_test");
  expect_nearest({"energy", "show", "logic.tni.trvv"}, "logic.tni.trv");
  expect_nearest({"run", "--resolution", "16x16", "--set", "energy.events.tni.box_tset=48"}, "tni.box_test");
  expect_nearest({"dvfs", "sgrt-2061"}, "sgrt-2016");
  expect_nearest({"reproduce", "lee2061"}, "lee2016");
  expect_nearest({"microbench", "chas"}, "chase");
  expect_nearest({"kernels", "show", "shade_difuse"}, "shade_diffuse");
  expect_nearest({"sweep", "run", "trv-croes"}, "trv-cores");
  expect_nearest({"optimise", "optimise-croes"}, "optimise-cores");
}

TEST(Refusals, SuggestWhatToTypeInstead) {
  const TempFolder folder;
  folder.write("mine.glb", TinyGltf().glb());
  const ProcessEnvironment here{folder.path(), {}, 0, {}};
  const auto refused = [&](const Words& arguments, const Words& parts) {
    expect_refusal(raywatt(arguments, here), parts);
  };
  refused({"run", "sgrt-2016", "--set", "cores=2", "tni.trv.rays=8"},
          {"'tni.trv.rays=8' follows no option; allowed: --set tni.trv.rays=8, one --set for each key"});
  refused({"run", "--set", "cores", "2"}, {"--set: 'cores' has no value; allowed: KEY=VALUE, e.g. --set cores=2"});
  refused({"run", "--set", "cores=2", "tni.trvs=2"}, {"'tni.trvs=2' is a setting", "--set tni.trvs=2"});
  refused({"config", "show", "--set", "cores=-1"}, {"cores: '-1' is out of range; allowed: 1 to 64 cores"});
  refused({"config", "show", "--set", "dram.extends=lpddr9"},
          {"no configuration file 'lpddr9'", "known: lpddr3-1600, lpddr4-3200, "});
  refused({"config", "show", "--set", "bvh.compression=on"},
          {"bvh.compression: is not modelled", "docs/design/not-modelled.md"});
  refused({"run", "--scene", "chess.obj"}, {"'chess.obj' is no glTF file; allowed: .glb, .gltf; convert it first"});
  refused({"run", "--scene", "mine"}, {"no scene is called 'mine'; allowed: --scene mine.glb"});
  refused({"run", "--ideal", "l3"}, {"--ideal: 'l3' is unknown; allowed: tni, l1, l2, dram, "});
  refused({"run", "--threads", "0"}, {"--threads: '0' is out of range; allowed: 1 to 1024; see raywatt run --help"});
  refused({"run", "--threads", "many"}, {"--threads: 'many' is no number; allowed: 1 to 1024"});
  refused({"dvfs", "--factors", "50"}, {"--factors: '50' is out of range; allowed: 0.01 to 20"});
  refused({"sweep", "table", "out", "--limit", "few"}, {"--limit: 'few' cannot be read; allowed: a whole number"});
  refused({"run", "--scene"}, {"--scene: has no value; allowed: --scene VALUE"});
  refused({"compare", "mine.glb"}, {"runs: 1 given; allowed: at least 2"});
  refused({"compare", ".", "."},
          {".: has no report.json, so it is no run; allowed: a folder that 'raywatt run' wrote"});
  refused({"config", "show", "tni.trvs"}, {"'tni.trvs' is a key, not a configuration; allowed: raywatt config show, "});
  refused({"config", "show", "tni.trv"}, {"'tni.trv' is a group of keys, not a configuration"});
  refused({"dvfs", "--fps", "0"}, {"--fps: '0' is out of range; allowed: a number above 0"});
  refused({"dvfs", "--fps", "abc"}, {"--fps: 'abc' is no number; allowed: a number above 0"});
  refused({"report"},
          {"raywatt report needs DIR...: folder of a run", "a sweep or a search; see raywatt report --help"});
  refused({"trace", "record"},
          {"raywatt trace record needs [CONFIG] FILE: an optional configuration, and the trace file"});
  refused({"help", "run"}, {"help is an option; allowed: raywatt run --help"});
  refused({"help"}, {"help is an option; allowed: raywatt --help"});
  refused({"--resolution", "64x32"}, {"'--resolution' is an option of a verb; allowed: raywatt run --resolution ..."});
  EXPECT_EQ(names_in(folder.path()), Words{"mine.glb"});
}

TEST(Help, HasUsageLinesThatCanBeTyped) {
  EXPECT_SAYS(ending_well({"trace", "replay", "--help"}).out, "raywatt trace replay [OPTIONS] [CONFIG] FILE\n");
  EXPECT_SAYS(ending_well({"report", "--help"}).out, "raywatt report [OPTIONS] DIR...\n");
  EXPECT_SAYS(ending_well({"compare", "--help"}).out, "raywatt compare [OPTIONS] RUN RUN...\n");
}

TEST(Names, OfSceneFilesMayBeInCapitals) {
  const TempFolder folder;
  folder.write("BOX.GLB", TinyGltf().glb());
  ending_well({"scenes", "info", "BOX.GLB"}, {folder.path(), {}, 0, {}});
}

TEST(Frames, OfASceneWithoutAnimationAreSaidToBeEqual) {
  const TempFolder folder;
  const std::string scene = folder.write("still.glb", TinyGltf().glb()).string();
  const ProcessResult ending = ending_well(small_run(folder.path() / "out", {"--frames", "0:1", "--scene", scene}));
  EXPECT_SAYS(ending.err, "warning: all frames are equal: the scene has no animation");
}

TEST(Names, OfExperimentsAreBareOnes) {
  const TempFolder folder;
  const std::string points = ending_well({"sweep", "run", "trv-cores", "--dry-run"}, {folder.path(), {}, 0, {}}).out;
  EXPECT_SAYS(points, "tni.trvs");
  EXPECT_EQ(names_in(folder.path()), Words{});
}

TEST(Names, OfFilesThatAGroupExtendsAreBareOnesOfItsFolder) {
  for (const auto& [bare, full] : {std::pair("dram.extends=lpddr4-4266", "dram.extends=dram/lpddr4-4266"),
                                   std::pair("area.extends=7nm", "area.extends=area/7nm")}) {
    EXPECT_EQ(ending_well({"config", "show", "--set", bare}).out, ending_well({"config", "show", "--set", full}).out);
  }
  EXPECT_SAYS(ending_well({"energy", "show", "dram.energy.phy", "--set", "dram.extends=lpddr5-6400"}).out,
              "lpddr5-6400.yaml:");
}

TEST(Names, AreListedWithALineEach) {
  const std::string list = ending_well({"config", "list"}).out;
  for (const char* line : {"sgrt-balanced      A machine whose bottleneck is its T&I units",
                           "dram/lpddr3-1600   LPDDR3-1600: two x32", "energy/14nm  Energy, leakage and clock",
                           "area/7nm   Area at 7 nm", "experiments/trv-cores        Where does the next"}) {
    EXPECT_SAYS(list, line);
  }
  EXPECT_SAYS(list, "(Lee et al. ") << "a full stop within a sentence does not end it";
  const std::size_t sweeps = list.find("sweeps (raywatt sweep run NAME"),
                    searches = list.find("searches (raywatt optimise");
  ASSERT_NE(sweeps, std::string::npos);
  ASSERT_LT(sweeps, searches);
  EXPECT_LT(list.find("experiments/trv-cores"), searches);
  EXPECT_GT(list.find("experiments/optimise-cores"), searches);
  expect_refusal(raywatt({"sweep", "run", "optimise-cores", "-o", "out", "--store", "store"}),
                 {"allowed: raywatt-sweep/1; a search is run by raywatt optimise"});
  expect_refusal(raywatt({"optimise", "trv-cores", "-o", "out", "--store", "store"}),
                 {"allowed: raywatt-optimise/1; a sweep is run by raywatt sweep run"});
}

TEST(Kernels, HaveAsManyOperationsInTheListAsShown) {
  const std::string list = ending_well({"kernels", "list"}).out;
  const std::size_t row = list.find("\ngenerate_rays ");
  ASSERT_NE(row, std::string::npos);
  const std::size_t begin = list.find_first_of("0123456789", row);
  const std::string count = list.substr(begin, list.find(' ', begin) - begin);
  EXPECT_SAYS(ending_well({"kernels", "show", "generate_rays"}).out, "generate_rays: " + count + " operations\n");
}

TEST(Warnings, OfOptionsThatDoNothing) {
  const TempFolder folder;
  const auto warned = [&](const Words& more) {
    Words words = small_run(folder.path() / "out", more);
    words.emplace_back("--quiet");
    return ending_well(words).err;
  };
  EXPECT_EQ(warned({}), "");
  EXPECT_SAYS(warned({"--set", "render.mip_maps=off", "--set", "render.mip_filter=linear"}),
              "render.mip_filter has no effect with render.mip_maps=off");
  EXPECT_EQ(warned({"--set", "render.mip_filter=linear"}), "");
  EXPECT_SAYS(warned({"--set", "dram.grade=LPDDR3-160"}), "--set dram.extends=lpddr3-1600 sets the timing");
  EXPECT_EQ(warned({"--set", "dram.grade=mine"}), "") << "any text is a name";
}

TEST(Warnings, OfSizesOutsideTheCurvesAreInTheReportToo) {
  const TempFolder folder;
  const auto report = [&](const Words& more) {
    Words words = small_run(folder.path() / "out", more);
    words.emplace_back("--quiet");
    const std::string err = ending_well(words).err;
    nlohmann::json json = read_json(folder.path() / "out" / "report.json");
    for (const auto& line : json["warnings"]) EXPECT_SAYS(err, "raywatt: warning: " + line.get<std::string>() + "\n");
    return json;
  };
  EXPECT_EQ(report({})["warnings"], nlohmann::json::array());
  for (const char* covered : {"1 KiB", "8 KiB", "16 MiB"}) {
    EXPECT_EQ(report({"--set", std::string("tni.trv.l1.size=") + covered})["warnings"], nlohmann::json::array());
  }
  const nlohmann::json small = report({"--set", "tni.trv.l1.size=512 B"});
  EXPECT_SAYS(small["warnings"][0].get<std::string>(),
              "energy.events: the array of tni.trv has 512 B, outside 1 KiB to 16 MiB of cache.l1_fill, "
              "cache.l1_read, and is extrapolated");
  EXPECT_EQ(small["totals"]["extrapolated"], small["warnings"].size());
}

TEST(Warnings, OfTileSamplingThatSimulatesMuchMoreThanRequested) {
  const TempFolder folder;
  const ProcessResult run = ending_well(small_run(folder.path() / "out", {"--tile-sampling", "5%"}));
  EXPECT_SAYS(run.err, "--tile-sampling 5% simulated 100 % of the tiles");
  EXPECT_EQ(read_json(folder.path() / "out" / "report.json")["totals"]["sampled"]["asked"], 0.05);
}

TEST(Streams, JsonOfARunIsItsTotalsAlone) {
  const TempFolder folder;
  const ProcessResult run = ending_well(small_run(folder.path() / "out", {"--json"}));
  EXPECT_EQ(nlohmann::json::parse(run.out), read_json(folder.path() / "out" / "report.json")["totals"]);
}

TEST(Streams, OfVerdictsHaveTheLocalesSignsToo) {
  const TempFolder folder;
  const auto path = [&](const char* name) { return (folder.path() / name).string(); };
  ending_well(small_run(path("a"), {"--quiet"}));
  ending_well(small_run(path("b"), {"--quiet", "--set", "cores=2"}));
  const auto shown = [&](const Words& words, const char* locale) {
    return ending_well(words, {{}, {{"LC_ALL", locale}}, 0, {}}).out;
  };
  for (const Words& words :
       {Words{"compare", path("a"), path("b")}, Words{"bottleneck", "--resolution", "16x16", "--replicates", "2"}}) {
    EXPECT_SAYS(shown(words, "C"), " +- ");
    EXPECT_EQ(shown(words, "C").find("\u00b1"), std::string::npos);
    EXPECT_SAYS(shown(words, "C.UTF-8"), " \u00b1 ");
  }
}

TEST(Streams, HaveASignThatIsNotAsciiOnlyWhereTheLocaleHasIt) {
  const TempFolder folder;
  const auto table = [&](const std::string& locale) {
    return ending_well(small_run(folder.path() / "out", {"--tile-sampling", "5%"}),
                       {{}, {{"LC_ALL", locale}, {"LANG", "en_GB.UTF-8"}}, 0, {}})
        .out;
  };
  EXPECT_SAYS(table("C"), "  +- 0.0 %");
  EXPECT_SAYS(table("de_DE.utf8"), "  \u00b1 0.0 %");
  EXPECT_SAYS(table(""), "  \u00b1 0.0 %") << "LANG, if LC_ALL is empty";
}

TEST(Bottleneck, ShowsProgressAndEachFirstLevelCache) {
  const ProcessResult run = ending_well({"bottleneck", "--resolution", "16x16", "--progress", "json", "--json"});
  EXPECT_SAYS(run.err, "\"label\":");
  const nlohmann::json json = nlohmann::json::parse(run.out);
  const nlohmann::json& time = json["top_down"];
  const auto sum = [](const nlohmann::json& levels) {
    double all = 0;
    for (const auto& level : levels) all += level.get<double>();
    return all;
  };
  const auto share = [&](const char* cache) { return json["caches"][cache]["share"].get<double>(); };
  EXPECT_NEAR(share("node") + share("triangle"), sum(time["tree_misses"]), 1e-12);
  EXPECT_GT(share("triangle"), 0);
  EXPECT_NEAR(share("data"), sum(time["data_misses"]), 1e-12);
}

TEST(EnergyPrice, RefusesAFileThatIsNotAnEnergyTable) {
  const TempFolder folder;
  const std::string out = (folder.path() / "out").string();
  ending_well(small_run(out));
  const auto refused = [&](const std::string& file, const std::string& what) {
    expect_refusal(raywatt({"energy", "price", out, "--energy", file}),
                   {what + ", not an energy table; allowed: energy/14nm"});
  };
  refused("dram/lpddr4-3200", "is a memory grade");
  refused("sgrt-2016", "is a whole configuration");
  refused("area/14nm", "is an area table");
  refused(out + "/report.json", "is a file of schema 'raywatt-report/1'");
  ending_well({"energy", "price", out, "--energy", "14nm"});
}

// Tests of warnings about a run's inputs, which every verb prints that reads them.

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
