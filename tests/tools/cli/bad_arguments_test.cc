#include <cmath>
#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "tests/tools/studies/sweep/small_sweep.h"
#include "tests/traces/scene/tiny_gltf_file.h"

// Tests that invalid command lines cause one line on stderr, exit code 2 and no output.

namespace test {
namespace {

/// Expects `run` with these arguments to fail without creating its output folder.
void expect_run_refused(Words arguments, const Words& parts) {
  const TempFolder folder;
  arguments.insert(arguments.begin(), "run");
  arguments.insert(arguments.end(), {"-o", (folder.path() / "new" / "out").string()});
  expect_refusal(raywatt(arguments, {folder.path(), {}, 0, {}}), parts);
  EXPECT_EQ(names_in(folder.path()), Words{});
}

TEST(BadArguments, AResolutionThatIsNone) {
  for (const char* text : {"64", "64x", "x32", "64x32x1", "64*32", "0x32", "64x0", "-64x32", "64x-32", "64x32 ",
                           "16385x1", "99999999999x1", "6.4x3", "0x40x32"}) {
    expect_run_refused({"--resolution", text}, {"WIDTHxHEIGHT", "1 to 16384", "e.g. 1024x512"});
  }
}

TEST(BadArguments, AProgramThatIsNotThere) {
  for (const char* option : {"--program", "--reference"}) {
    expect_run_refused({option, "fool:1"}, {"'fool:1'", "full:N"});
    expect_run_refused({option, "full:3"}, {"'full:3'", "square"});
    expect_run_refused({option, "full:0"}, {"'full:0'", "square"});
    expect_run_refused({option, "full:-1"}, {"'full:-1'", "square"});
  }
}

TEST(BadArguments, ThreadsThatAreNoneOrTooMany) {
  for (const char* threads : {"0", "-1", "1025", "many", "1.5"}) {
    expect_run_refused({"--threads", threads}, {"--threads"});
  }
}

TEST(BadArguments, ASceneWithoutAName) {
  expect_refusal(raywatt({"run", "--scene", ""}), {"--scene: allowed: a name"});
  expect_refusal(raywatt({"run", "-o", ""}), {"--output: allowed: a folder"});
}

TEST(BadArguments, ValuesThatAreEmpty) {
  for (const char* option :
       {"--camera", "--resolution", "--frames", "--reference", "--record", "--rays", "--program"}) {
    expect_run_refused({option, ""}, {std::string(option) + ": is empty; allowed: a value, or to leave it out"});
  }
  for (const Words& verb :
       std::vector<Words>{{"sweep", "run", "a.yaml"}, {"optimise", "a.yaml"}, {"reproduce", "chiu"}}) {
    Words words = verb;
    words.insert(words.end(), {"-o", ""});
    expect_refusal(raywatt(words), {"--output: is empty"});
  }
  expect_refusal(raywatt({"baseline", "check", "a.yaml", "--junit", ""}), {"--junit: is empty"});
  expect_refusal(raywatt({"sweep", "status", ""}), {"folder: is empty; allowed: a value; see"});
}

TEST(BadArguments, NegativeNumbersWhereNumbersAreWhole) {
  for (const Words& words : std::vector<Words>{{"sweep", "table", "out", "--limit", "-1"},
                                               {"optimise", "a.yaml", "--seed", "-1"},
                                               {"sweep", "point", "out", "--index", "-1"}}) {
    expect_refusal(raywatt(words), {words[words.size() - 2] + ": -1 is negative; allowed: a whole number from 0 on"});
  }
}

TEST(BadArguments, OptionsThatAreUnknownRepeatedOrWithoutAValue) {
  expect_run_refused({"--colour", "red"}, {"--colour"});
  expect_run_refused({"--scene", "cornell", "--scene", "teapot"}, {"--scene"});
  expect_run_refused({"sgrt-2016", "teapot"}, {"teapot"});
  expect_refusal(raywatt({"run", "--scene"}), {"--scene"});
}

TEST(BadArguments, AVerbThatIsNotThereGetsTheNearestOneAndTheList) {
  expect_refusal(raywatt({"verfy"}),
                 {"unknown verb 'verfy'", "did you mean 'verify'?", "run, verify, reproduce, scenes"});
  expect_refusal(raywatt({"config", "shwo"}), {"unknown subcommand 'shwo'", "did you mean 'show'?", "list, show"});
  expect_refusal(raywatt({}), {"raywatt --help"});
  expect_refusal(raywatt({"config"}), {"see raywatt config --help"});
  expect_refusal(raywatt({"trace", "replay", "a.trace", "--no-such"}),
                 {"unknown option '--no-such'", "; see raywatt trace replay --help"});
}

TEST(BadArguments, AnOptionCutShortGetsTheOneThatBeginsSo) {
  expect_run_refused({"--res", "64x32"}, {"unknown option '--res', did you mean '--resolution'?"});
  expect_run_refused({"--deb"}, {"unknown option '--deb', did you mean '--debug-images'?"});
}

TEST(BadArguments, AKernelThatIsNotThereGetsTheNearestOne) {
  expect_refusal(raywatt({"kernels", "show", "shade_difuse"}), {"'shade_difuse'", "did you mean 'shade_diffuse'?"});
}

TEST(BadArguments, AKeyOrAProgramThatIsNotThereGetsThoseThatWereMeant) {
  expect_run_refused({"--set", "l1.size=8KiB"}, {"did you mean 'tni.trv.l1' or 'tni.ist.l1'"});
  expect_run_refused({"--program", "ful:1"}, {"did you mean 'full:1'?", "there is: full:N"});
}

TEST(BadArguments, AComplaintIsOneLineWhateverItQuotes) {
  expect_run_refused({"two\nlines"}, {"two?lines"});
  expect_run_refused({"--two\nlines"}, {"two?lines"});
  expect_run_refused({"--scene", "two\nlines"}, {"two?lines"});
  expect_run_refused({"--set", "two\nlines=1"}, {"two?lines"});
  expect_run_refused({"--program", "two\nlines"}, {"two?lines"});
}

TEST(BadArguments, AnOutputFolderThatCannotBeWritten) {
  const TempFolder folder;
  folder.write("file", "text");
  const std::string file = (folder.path() / "file").string();
  const auto refused = [&](const std::string& out, const std::string& why) {
    expect_refusal(raywatt({"run", "-o", out}), {why, out.substr(0, 200)});
    expect_refusal(raywatt({"verify", "-o", out}), {why});
  };
  refused(file, "is a file, not a folder");
  refused(file + "/out", "Not a directory");
  refused(file + "/deep/out", "Not a directory");
  refused("/proc/raywatt", "cannot be written");
  refused(folder.path().string() + "/" + std::string(300, 'a'), "File name too long");
  std::filesystem::create_symlink(folder.path() / "nowhere", folder.path() / "link");
  refused((folder.path() / "link").string(), "is a file, not a folder");
  EXPECT_EQ(names_in(folder.path()), (Words{"file", "link"}));
  EXPECT_EQ(read_bytes(file), "text");
}

TEST(BadArguments, NamesThatNoFileCanHave) {
  const TempFolder folder;
  const std::string name(300, 'x'), page = (folder.path() / "page.html").string();
  const std::vector<Words> all = {{"report", name, "-o", page},
                                  {"report", page, "-o", name},
                                  {"energy", "price", name},
                                  {"run", "--resolution", "16x16", "--record", name},
                                  {"reproduce", "lee2016", "--scenes", name}};
  for (const Words& words : all) {
    SCOPED_TRACE(words[0]);
    expect_refusal(raywatt(words, {.folder = folder.path()}), {name.substr(0, 100)});
  }
  std::filesystem::create_symlink("raywatt-out", folder.path() / "raywatt-out");
  expect_refusal(raywatt({"run", "--resolution", "16x16"}, {.folder = folder.path()}),
                 {"raywatt-out", "cannot be written"});
}

// Tests that invalid scenes cause one line on stderr with the file's name, exit code 2 and no output.

/// Expects the verb to fail without creating the output folder or its parent.
void expect_scene_refused(const TempFolder& folder, const std::string& scene, const Words& parts) {
  const Words before = names_in(folder.path());
  for (const char* verb : {"run", "verify"}) {
    expect_refusal(raywatt({verb, "--scene", scene, "-o", (folder.path() / "new" / "out").string()}), parts);
  }
  expect_refusal(raywatt({"scenes", "info", scene}), parts);
  EXPECT_EQ(names_in(folder.path()), before);
}

void expect_file_refused(const std::string& name, const std::string& bytes, Words parts) {
  const TempFolder folder;
  const std::string scene = folder.write(name, bytes).string();
  parts.push_back(scene);
  expect_scene_refused(folder, scene, parts);
}

TEST(BadScene, ATruncatedGlb) {
  const std::string whole = TinyGltf().glb();
  expect_file_refused("cut.glb", whole.substr(0, whole.size() / 2), {"bytes"});
  expect_file_refused("nearly.glb", whole.substr(0, whole.size() - 4), {"bytes"});
}

TEST(BadScene, AnEmptyFile) { expect_file_refused("empty.glb", "", {"empty"}); }

TEST(BadScene, AFileThatIsNoGltf) { expect_file_refused("hello.gltf", "hello", {"line 1, column 1"}); }

TEST(BadScene, APictureWithTheNameOfAScene) {
  expect_file_refused("a.glb", "\x89PNG\r\n\x1a\n more",
                      {"is a PNG picture, not a glTF scene; allowed: .glb and .gltf"});
  expect_file_refused("a.gltf", "\xff\xd8\xff\xe0 more", {"is a JPEG picture, not a glTF scene"});
}

TEST(BadScene, AFileLargerThanTheLimitGetsTheLimitsKey) {
  const TempFolder folder;
  const std::string scene = folder.write("large.gltf", TinyGltf().text() + std::string(1 << 20, ' ')).string();
  expect_refusal(
      raywatt({"run", "--scene", scene, "--set", "limits.memory=1 MiB", "-o", (folder.path() / "o").string()}),
      {scene, "bytes, more than limits.memory, 1 MiB; allowed: a larger one, e.g. --set limits.memory='8 GiB'"});
  expect_refusal(
      raywatt({"run", "--scene", scene, "--set", "limits.memory=2 MiB", "-o", (folder.path() / "o").string()}),
      {scene, "more than is left of the limit of 2 MiB; allowed: a larger limits.memory"});
}

TEST(BadScene, AMissingTexture) {
  TinyGltf file;
  file.json["images"] = {{{"uri", "nowhere.png"}}};
  file.json["textures"] = {{{"source", 0}}};
  file.material()["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
  file.primitive()["attributes"]["TEXCOORD_0"] = file.add<float>({0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 3);
  expect_file_refused("bare.gltf", file.text(), {"nowhere.png"});
}

TEST(BadScene, AMissingBuffer) {
  TinyGltf file;
  file.json["buffers"][0]["uri"] = "nowhere.bin";
  expect_file_refused("bare.gltf", file.text(), {"nowhere.bin"});
}

TEST(BadScene, NoTriangles) {
  TinyGltf file;
  file.json["nodes"][0].erase("mesh");
  expect_file_refused("none.gltf", file.text(), {"no triangles"});
}

TEST(BadScene, VerticesThatAreNoNumbers) {
  TinyGltf file;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(file.binary.data() + 4, &nan, sizeof nan);
  expect_file_refused("nan.glb", file.glb(), {"not a finite number"});
}

TEST(BadScene, AFileThatIsNotThere) {
  const TempFolder folder;
  expect_scene_refused(folder, (folder.path() / "nowhere.glb").string(), {"nowhere.glb", "no such file"});
}

TEST(BadScene, AFolder) {
  const TempFolder folder;
  expect_scene_refused(folder, folder.path().string() + "/", {"is a folder"});
}

TEST(BadScene, AnUnknownNameGetsTheNearestOne) {
  const TempFolder folder;
  expect_scene_refused(folder, "teapott", {"'teapott'", "did you mean 'teapot'"});
  expect_scene_refused(folder, "zzzzzz", {"'zzzzzz'", "cornell", "teapot"});
}

TEST(BadScene, AnUnknownCameraIsAnsweredWithTheKnownOnes) {
  const TempFolder folder;
  for (const char* camera : {"rear", "7", "-1"}) {
    expect_refusal(raywatt({"run", "--camera", camera, "-o", (folder.path() / "out").string()}),
                   {"cornell", camera, "0 'front'"});
  }
  EXPECT_EQ(names_in(folder.path()), Words{});
}

// Tests of invalid configurations. Each causes one line on stderr with the position (file, line and column, or
// argument) and what is allowed, exit code 2, and no output.

void expect_config_refused(const TempFolder& folder, const std::string& config, const Words& parts) {
  const Words before = names_in(folder.path());
  for (const char* verb : {"run", "verify"}) {
    expect_refusal(raywatt({verb, config, "-o", (folder.path() / "new" / "out").string()}), parts);
  }
  expect_refusal(raywatt({"config", "show", config}), parts);
  expect_refusal(raywatt({"kernels", "list", config}), parts);
  EXPECT_EQ(names_in(folder.path()), before);
}

/// Expects an error at this position in a file with this text, which extends the default machine.
void expect_yaml_refused(const std::string& text, const std::string& position, Words parts) {
  const TempFolder folder;
  const std::string file = folder.write("mine.yaml", "extends: sgrt-2016\n" + text).string();
  parts.push_back(file + position);
  expect_config_refused(folder, file, parts);
}

void expect_set_refused(const std::string& set, Words parts) {
  const TempFolder folder;
  parts.push_back("--set " + set);
  expect_refusal(raywatt({"run", "--set", set, "-o", (folder.path() / "new" / "out").string()}), parts);
  expect_refusal(raywatt({"config", "show", "--set", set}), parts);
  EXPECT_EQ(names_in(folder.path()), Words{});
}

TEST(BadConfig, AMisspeltKeyGetsTheNearestOne) {
  expect_yaml_refused("tni:\n  trv:\n    rais: 32\n", ":4:5:", {"tni.trv.rais", "did you mean 'tni.trv.rays'?"});
}

TEST(BadConfig, ADottedKeyGetsItsNestedForm) {
  expect_yaml_refused("tni.trv.l1.size: 4 KiB\n",
                      ":2:1:", {"unknown key 'tni.trv.l1.size'; allowed: tni: {trv: {l1: {size: ...}}}"});
  expect_yaml_refused("tni:\n  trv.rays: 4\n", ":3:3:", {"unknown key 'trv.rays'; allowed: trv: {rays: ...}"});
}

TEST(BadConfig, AFileWithoutEnergyFiguresGetsTheLineToAdd) {
  const TempFolder folder;
  const std::string file = folder.write("mine.yaml", "cores: 2\n").string();
  expect_config_refused(folder, file, {file + ": has no energy figures; allowed: 'extends: sgrt-2016' as its first"});
}

TEST(BadConfig, AKeyLikeNoOtherGetsTheList) {
  expect_yaml_refused("quux: 1\n", ":2:1:", {"unknown key 'quux'", "allowed: process, cores, clocks, tni"});
}

TEST(BadConfig, ANegativeSize) {
  expect_yaml_refused("l2:\n  size: -256 KiB\n", ":3:9:", {"l2.size", "'-256 KiB'", "allowed: 64 B to 16 MiB"});
  expect_yaml_refused("render:\n  width: -64\n", ":3:10:", {"render.width", "'-64'", "allowed: 1 to 16384"});
}

TEST(BadConfig, ASizeWithoutAUnit) {
  expect_yaml_refused("l2:\n  size: 262144\n", ":3:9:", {"l2.size", "no unit", "B, KiB, MiB"});
}

TEST(BadConfig, ACacheOfThreeWaysOfAHundredBytes) {
  expect_yaml_refused("tni: {trv: {l1: {size: 300 B, line: 100 B, ways: 3}}}\n",
                      ":2:37:", {"tni.trv.l1.line", "'100 B'", "allowed: powers of two"});
  expect_yaml_refused("tni:\n  trv:\n    l1:\n      size: 300 B\n      ways: 3\n",
                      ":5:7:", {"tni.trv.l1.size", "300 bytes", "3 ways of 64 bytes"});
}

TEST(BadConfig, AValueOutOfRange) {
  expect_yaml_refused("cores: 0\n", ":2:8:", {"cores", "allowed: 1 to "});
  expect_yaml_refused("clocks: {tni: 500}\n", ":2:15:", {"clocks.tni", "no unit", "MHz"});
}

TEST(BadConfig, AnEffectThatThereIsNot) {
  expect_yaml_refused(
      "render:\n  effects: shadows, reflexions\n",
      ":3:3:", {"render.effects", "'reflexions' is no effect, did you mean 'reflections'?", "allowed: none, or"});
}

TEST(BadConfig, AnEffectThatTheProgramCannotTraceRaysFor) {
  const TempFolder folder;
  const std::string out = (folder.path() / "out").string();
  expect_refusal(raywatt({"run", "--program", "undersample", "--set", "render.effects=occlusion", "-o", out}),
                 {"render.effects: occlusion", "undersample", "allowed: shadows, reflections, refractions"});
  EXPECT_EQ(names_in(folder.path()), Words{});
}

TEST(BadConfig, ALowerRateOfEffectsThatThereAreNotOrWhereNothingFiltersThem) {
  expect_yaml_refused("render:\n  effect_rate: half\n",
                      ":3:3:", {"render.effect_rate", "effects has none", "allowed: full"});
  const TempFolder folder;
  const auto refused = [&](const Words& more, const Words& parts) {
    Words words = {"run", "--set", "render.effects=occlusion", "--set", "render.effect_rate=checkerboard"};
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"-o", (folder.path() / "out").string()});
    expect_refusal(raywatt(words), parts);
  };
  refused({"--program", "full:4"},
          {"render.effect_rate: checkerboard", "full:4", "allowed: full, or the program full:1"});
  refused({"--tile-sampling", "50%"}, {"--tile-sampling", "allowed: render.effect_rate=full"});
  EXPECT_EQ(names_in(folder.path()), Words{});
}

TEST(BadConfig, ABaseThatIsNotThere) {
  const TempFolder folder;
  const std::string file = folder.write("mine.yaml", "extends: nowhere\n").string();
  expect_config_refused(folder, file, {file + ":1:10:", "no configuration file 'nowhere'"});
}

TEST(BadConfig, BrokenYaml) { expect_yaml_refused("cores: [1, 2\n", ":2:1:", {"not valid YAML"}); }

TEST(BadConfig, AnEmptyFile) {
  const TempFolder folder;
  const std::string file = folder.write("empty.yaml", "").string();
  expect_config_refused(folder, file, {file});
}

TEST(BadConfig, AFolder) {
  const TempFolder folder;
  expect_config_refused(folder, folder.path().string(), {folder.path().string(), "is a folder"});
}

TEST(BadConfig, AnUnknownNameGetsTheNearestOneAndTheList) {
  const TempFolder folder;
  expect_config_refused(folder, "sgrt-2061", {"'sgrt-2061'", "did you mean 'sgrt-2016'?", "known: ", "sgrt-2016"});
  expect_config_refused(folder, std::string(5000, 'a'), {"no configuration is called 'aaa"});
}

TEST(BadConfig, SetOfAnUnknownKey) {
  expect_set_refused("l3.size=1", {"unknown key 'l3'", "did you mean 'l2'?"});
  expect_set_refused("tni.trv.rais=1", {"tni.trv.rais", "did you mean 'tni.trv.rays'?"});
}

TEST(BadConfig, AClockThatIsNotThereGetsTheClocksThatAre) {
  // The group dram and the boolean ideal.dram are not clocks.
  expect_set_refused("clocks.dram=3", {"clocks.dram: unknown key 'dram'; allowed: tni, srp, l2, synchroniser"});
}

TEST(BadConfig, SetOfABadValue) {
  expect_set_refused("l2.size=-1", {"l2.size", "'-1'", "allowed: 64 B to 16 MiB"});
  expect_set_refused("l2.ways=many", {"l2.ways", "'many'", "allowed: 1 to"});
  expect_set_refused("render.samples=sideways", {"render.samples", "allowed: regular"});
  expect_set_refused("l2=1", {"l2", "group of fields"});
}

TEST(BadConfig, SetOfAValueThatDoesNotFitTheOthers) {
  expect_refusal(raywatt({"config", "show", "--set", "tni.trv.l1.ways=3"}),
                 {"tni.trv.l1.size", "16384 bytes", "3 ways of 64 bytes"});
}

TEST(BadConfig, SetWithoutAValue) {
  for (const char* set : {"", "=", "=1"}) expect_set_refused(set, {"allowed: key=value"});
  expect_set_refused("cores", {"'cores' has no value; allowed: KEY=VALUE, e.g. --set cores=2"});
}

// Tests of JSON that is nested deeply enough to exhaust the stack of a recursive reader.

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
