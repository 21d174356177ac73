#include <gtest/gtest.h>

#include "tests/tools/program.h"

// Tests of invalid configurations. Each causes one line on stderr with the position (file, line and column, or
// argument) and what is allowed, exit code 2, and no output.

namespace test {
namespace {

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

}  // namespace
}  // namespace test
