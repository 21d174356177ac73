#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tests/traces/scene/tiny_gltf_file.h"

// Tests of output streams, and of verbs that write no results.

namespace test {
namespace {

std::string silent_output_of(const Words& arguments, const ProcessEnvironment& around = {}) {
  const ProcessResult ending = raywatt(arguments, around);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(ending.err, "");
  return ending.out;
}

TEST(Help, OfEveryVerbEndsWellWithAnExample) {
  const std::string all = silent_output_of({"--help"});
  for (const char* verb : {"run", "verify", "scenes", "config", "kernels", "bench", "trace", "microbench"}) {
    EXPECT_SAYS(all, std::string("  ") + verb + " ");
    EXPECT_SAYS(silent_output_of({verb, "--help"}), std::string("Example: raywatt ") + verb + " ");
  }
}

TEST(Help, OfRunShowsTheDefaults) {
  const std::string help = silent_output_of({"run", "--help"});
  for (const char* part : {"sgrt-2016", "cornell", "full:1", "1024x512", "all cores", "raywatt-out/"}) {
    EXPECT_SAYS(help, part);
  }
}

TEST(Version, IsOneLine) {
  const std::string version = silent_output_of({"--version"});
  EXPECT_TRUE(version.starts_with("raywatt ")) << version;
  EXPECT_EQ(std::ranges::count(version, '\n'), 1) << version;
}

// Most of the startup time is symbol lookup of the dynamic linker, which grows with the number of libraries.
TEST(Version, LoadsNoLibrariesOfImages) {
  const std::string libraries = silent_output_of({"--version"}, {.variables = {{"LD_TRACE_LOADED_OBJECTS", "1"}}});
  EXPECT_SAYS(libraries, "libembree");
  EXPECT_EQ(libraries.find("libOpenImageIO"), std::string::npos) << libraries;
  EXPECT_LE(std::ranges::count(libraries, '\n'), 30) << libraries;
}

TEST(Streams, TheTableGoesToStdoutAndIntoAFile) {
  const TempFolder folder;
  const std::string table = silent_output_of(small_run(folder.path() / "out"));
  EXPECT_TRUE(table.starts_with(read_bytes(folder.path() / "out" / "report.txt")));
  for (const char* part : {"cycles", "rays", "limited by", "energy", "dram", "combine_shadow", "image.png"}) {
    EXPECT_SAYS(table, part);
  }
}

TEST(Streams, WarningsGoToStderr) {
  const TempFolder folder;
  TinyGltf file;
  file.json["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
  const std::string scene = folder.write("warned.gltf", file.text()).string();
  const ProcessResult ending = raywatt(small_run(folder.path() / "out", {"--scene", scene}));
  EXPECT_EQ(ending.exit, 0);
  EXPECT_TRUE(ending.err.starts_with("raywatt: warning: ")) << ending.err;
  EXPECT_EQ(ending.out.find("warning"), std::string::npos) << ending.out;
}

TEST(Streams, QuietPrintsNothing) {
  const TempFolder folder;
  EXPECT_EQ(silent_output_of(small_run(folder.path() / "out", {"--quiet"})), "");
  EXPECT_EQ(names_in(folder.path()), Words{"out"});
}

TEST(Streams, AnOutputThatCannotBeWrittenEndsWith74) {
  for (const Words& words : {Words{"config", "manual"}, Words{"scenes", "list"}}) {
    const ProcessResult ending = raywatt(words, {{}, {}, 0, "/dev/full"});
    EXPECT_EQ(ending.exit, 74);
    EXPECT_SAYS(ending.err, "No space left on device");
  }
}

TEST(Outputs, ThatCannotBeBegunEndEveryVerbWith2AndNothingIsWritten) {
  const TempFolder folder;
  folder.write("file", "");
  folder.write("s.yaml", "schema: raywatt-sweep/1\nresolution: 16x16\naxes: {cores: [1, 2]}\n");
  folder.write("o.yaml",
               "schema: raywatt-optimise/1\nresolution: 16x16\nbudget: 4\nobjectives: [{max: perf.fps}]\n"
               "axes: {cores: [1, 2, 4, 8]}\n");
  for (const Words& words :
       {Words{"run", "-o", "file/out"}, Words{"sweep", "run", "s.yaml", "-o", "file/out"},
        Words{"sweep", "run", "s.yaml", "-o", "out", "--store", "file/store"},
        Words{"optimise", "o.yaml", "-o", "file/out"}, Words{"reproduce", "lee2016", "-o", "file/out"},
        Words{"scenes", "export", "cornell", "-o", "file/out.glb"}}) {
    const ProcessResult ending = raywatt(words, {.folder = folder.path()});
    EXPECT_EQ(ending.exit, 2) << words.front() << ": " << ending.err;
    EXPECT_SAYS(ending.err, "cannot be written");
  }
}

TEST(Set, ChangesOneFieldAndTheLastOneCounts) {
  const TempFolder folder;
  silent_output_of(small_run(folder.path() / "out", {"--set", "cores=3", "--set", "l2.size=128 KiB", "--set", "cores=2",
                                                     "--set", "clocks.tni=250 MHz", "--set", "power.voltage=dvfs"}));
  const nlohmann::json report = read_json(folder.path() / "out" / "report.json");
  EXPECT_EQ(report["config"]["cores"], 2);
  EXPECT_EQ(report["config"]["l2"]["size"], "128 KiB");
  EXPECT_DOUBLE_EQ(report["totals"]["time_ms"], report["totals"]["cycles"].get<double>() / 250e3);
  EXPECT_TRUE(report["units"].contains("core1"));
  EXPECT_FALSE(report["units"].contains("core2"));
}

TEST(Set, ExtendsTakesAnotherGradeOfMemoryByName) {
  const std::string config = silent_output_of({"config", "show", "--set", "dram.extends=dram/lpddr3-1600"});
  EXPECT_SAYS(config, "grade: \"LPDDR3-1600\"");
}

TEST(Extends, ListsOnlyWhatDiffers) {
  const TempFolder folder;
  const std::string file = folder.write("small.yaml", "extends: sgrt-2016\ncores: 1\ndram: {channels: 2}\n").string();
  const std::string config = silent_output_of({"config", "show", file});
  EXPECT_SAYS(config, "cores: 1  #");
  EXPECT_SAYS(config, "channels: 2  #");
  EXPECT_SAYS(config, "grade: \"LPDDR4-3200\"");
}

TEST(Camera, IsChosenByNameOrIndex) {
  const TempFolder folder;
  TinyGltf file;
  file.material()["doubleSided"] = true;
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}}};
  for (const auto& [name, distance] : {std::pair{"near", 2}, std::pair{"far", 9}}) {
    file.json["nodes"].push_back({{"name", name}, {"camera", 0}, {"translation", {0.3, 0.3, distance}}});
  }
  file.json["scenes"][0]["nodes"] = {0, 1, 2};
  const std::string scene = folder.write("two.gltf", file.text()).string();
  const auto picture = [&](const Words& camera) {
    Words words = {"--scene", scene};
    words.insert(words.end(), camera.begin(), camera.end());
    silent_output_of(small_run(folder.path() / "out", words));
    return read_bytes(folder.path() / "out" / "image.exr");
  };
  EXPECT_EQ(picture({"--camera", "near"}), picture({"--camera", "0"}));
  EXPECT_EQ(picture({"--camera", "far"}), picture({"--camera", "1"}));
  EXPECT_EQ(picture({}), picture({"--camera", "0"})) << "the first one, if none is named";
  EXPECT_NE(picture({"--camera", "near"}), picture({"--camera", "far"}));
}

TEST(ConfigManual, IsThePageInTheDocumentation) {
  const std::string page = read_bytes("docs/manual.md"), mark = "<!-- generated -->\n\n";
  ASSERT_NE(page.find(mark), std::string::npos);
  EXPECT_EQ(page.substr(page.find(mark) + mark.size()), silent_output_of({"config", "manual"}))
      << "docs/refresh writes it";
}

TEST(LookUp, FindsConfigurationsAndScenesInTheFoldersOfRaywattPath) {
  const TempFolder first, second;
  second.write("mine.yaml", "extends: sgrt-2016\ncores: 3\n");
  second.write("triangle.glb", TinyGltf().glb());
  const ProcessEnvironment around{
      first.path(), {{"RAYWATT_PATH", first.path().string() + ":" + second.path().string()}}, 0, {}};
  EXPECT_SAYS(silent_output_of({"config", "list"}, around), "mine\n");
  EXPECT_SAYS(silent_output_of({"config", "show", "mine"}, around), "cores: 3  #");
  EXPECT_SAYS(silent_output_of({"scenes", "info", "triangle"}, around), "triangles         1\n");
  expect_refusal(raywatt({"config", "show", "mine"}), {"no configuration is called 'mine'"});
  first.write("mine.yaml", "extends: sgrt-2016\ncores: 2\n");
  EXPECT_SAYS(silent_output_of({"config", "show", "mine"}, around), "cores: 2  #") << "the first folder comes first";
}

TEST(LookUp, ABareNameIsNeverAFileOfTheWorkingFolder) {
  const TempFolder folder;
  folder.write("sgrt-2016", "cores: 3\n");
  EXPECT_SAYS(silent_output_of({"config", "show", "sgrt-2016"}, {folder.path(), {}, 0, {}}), "cores: 4  #");
  const TempFolder other;
  other.write("mine.yaml", "extends: sgrt-2016\ncores: 3\n");
  EXPECT_SAYS(silent_output_of({"config", "show", "mine.yaml"}, {other.path(), {}, 0, {}}), "cores: 3  #");
}

/// Expects that the JSON schema declares every key of the value.
void expect_known(const nlohmann::json& schema, const nlohmann::json& value, const std::string& path) {
  if (!value.is_object() || !schema.contains("properties")) return;
  for (const auto& [key, inner] : value.items()) {
    ASSERT_TRUE(schema["properties"].contains(key)) << path << key;
    expect_known(schema["properties"][key], inner, path + key + ".");
  }
}

TEST(Config, SchemaIsJsonWithEveryKeyOfTheDefaultMachine) {
  const TempFolder folder;
  const nlohmann::json schema = nlohmann::json::parse(silent_output_of({"config", "schema"}));
  EXPECT_SAYS(schema["$schema"].get<std::string>(), "2020-12");
  EXPECT_EQ(schema["additionalProperties"], false);
  silent_output_of({"run", "--resolution", "16x16", "--quiet", "-o", (folder.path() / "out").string()});
  expect_known(schema, read_json(folder.path() / "out" / "report.json")["config"], "");
}

TEST(Config, ManualHasARowForEveryKindOfThing) {
  const std::string manual = silent_output_of({"config", "manual"});
  for (const char* part : {"`rays`", "input buffer", "MHz", "KiB", "timing", "energy", "function"}) {
    EXPECT_SAYS(manual, part);
  }
}

TEST(Config, ShowIsAFileThatShowsTheSameAgain) {
  const TempFolder folder;
  const std::string shown = silent_output_of({"config", "show"});
  EXPECT_EQ(silent_output_of({"config", "show", folder.write("again.yaml", shown).string()}), shown);
}

TEST(Kernels, ListHasEveryKernelWithItsSchedule) {
  const std::string list = silent_output_of({"kernels", "list"});
  for (const char* part : {"kernel", "II", "depth", "generate_rays", "shade_glass", "average_colour"}) {
    EXPECT_SAYS(list, part);
  }
  EXPECT_NE(silent_output_of({"kernels", "list", "--set", "srp.array.mul_units=1"}), list)
      << "schedules are this array's";
}

TEST(Kernels, ShowHasTheGraph) {
  const std::string shown = silent_output_of({"kernels", "show", "shade_diffuse"});
  EXPECT_TRUE(shown.starts_with("shade_diffuse: ")) << shown;
  for (const char* part : {"II ", "depth ", "mul", "shadow_rays"}) EXPECT_SAYS(shown, part);
}

TEST(Scenes, ListAndInfo) {
  const std::string list = silent_output_of({"scenes", "list"});
  EXPECT_SAYS(list, "cornell");
  EXPECT_SAYS(list, "teapot");
  const std::string info = silent_output_of({"scenes", "info", "cornell"});
  for (const char* part : {"triangles", "lights", "'front'", "BVH", "SAH cost"}) EXPECT_SAYS(info, part);
}

}  // namespace
}  // namespace test
