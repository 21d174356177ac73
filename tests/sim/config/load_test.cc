#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "../folder.h"
#include "harness.h"
#include "machine.h"
#include "sim/config/config.h"
#include "sim/config/describe.h"
#include "sim/config/variant.h"
#include "sim/error.h"
#include "sim/named.h"
#include "tests/param_name.h"

namespace sim::test {
namespace {

TEST(LoadConfig, TakesEveryKindOfValue) {
  const MachineConfig c = ConfigHarness().load(R"(
direct: false
seed: 18446744073709551615
threshold: -2.5e-1
name: "a: b # c"
clock: 1.2 GHz
fabric: 12.5 ns
refresh: {low: 0.5, nominal: 1 pJ, high: 1.5}
events:
  tni.box_test: 12 pJ
  cache.l1_read@16KiB: {low: 5, nominal: 7.8, high: 16}
unit:
  rays: 16 rays
  stack: restart
  l1: {size: 8 KiB, line: 32 B, ways: 2}
)");
  EXPECT_FALSE(c.direct);
  EXPECT_EQ(c.seed, 18446744073709551615U);
  EXPECT_EQ(c.threshold, -0.25);
  EXPECT_EQ(c.name, "a: b # c");
  EXPECT_EQ(c.clock.hz, 1'200'000'000U);
  EXPECT_EQ(c.fabric.time, 12'500'000U);
  EXPECT_EQ(c.refresh, (Band{0.5, 1, 1.5}));
  EXPECT_EQ(c.events.at("tni.box_test"), (Band{12, 12, 12}));
  EXPECT_EQ(c.events.at("cache.l1_read@16KiB"), (Band{5, 7.8, 16}));
  EXPECT_EQ(c.unit.rays, 16U);
  EXPECT_EQ(c.unit.stack, Stack::kRestart);
  EXPECT_EQ(c.unit.l1.size.bytes, 8192U);
}

TEST(LoadConfig, KeepsDefaultsOfAbsentKeys) { EXPECT_EQ(ConfigHarness().load("seed: 7\n"), MachineConfig{}); }

TEST(LoadConfig, AnAliasRepeatsItsAnchor) {
  const MachineConfig c = ConfigHarness().load("unit:\n  l1: &small {size: 1 KiB}\nl2: *small\n");
  EXPECT_EQ(c.l2.size.bytes, 1024U);
}

TEST(Extends, ReadsTheBaseFirstAtAnyPositionOfTheKey) {
  ConfigHarness b;
  b.file("base.yaml", "seed: 1\nunit: {rays: 8, stack: short}\n");
  const MachineConfig c = b.load("unit: {rays: 9}\nextends: base.yaml\n");
  EXPECT_EQ(c.seed, 1U);
  EXPECT_EQ(c.unit.rays, 9U);
  EXPECT_EQ(c.unit.stack, Stack::kShort);
}

TEST(Extends, WorksInsideAnyGroupAndMergesMaps) {
  ConfigHarness b;
  b.file("caches/small.yaml", "extends: tiny.yaml\nways: 2\n").file("caches/tiny.yaml", "size: 256 B\nways: 1\n");
  b.file("base.yaml", "events: {a: 1, b: 2}\n");
  const MachineConfig c = b.load("extends: base\nl2: {extends: caches/small.yaml, line: 32 B}\nevents: {b: 3, c: 4}\n");
  EXPECT_EQ(c.l2, (CacheConfig{{256}, {32}, 2}));
  EXPECT_EQ(c.events, (std::map<std::string, Band>{{"a", {1, 1, 1}}, {"b", {3, 3, 3}}, {"c", {4, 4, 4}}}));
}

TEST(Extends, SearchesNextToTheFileThenOnTheSearchPath) {
  ConfigHarness b;
  b.file("share/base.yaml", "seed: 2\nl2: {extends: caches/big}\n").file("share/caches/big.yaml", "size: 1 MiB\n");
  EXPECT_EQ(b.error("extends: base\n"), "a.yaml:1:10: extends: no configuration file 'base'");
  set_config_search_path({b.folder().path() / "none", b.folder().path() / "share"});
  EXPECT_EQ(b.load("extends: base\n").l2.size.bytes, 1024U * 1024);
  b.file("base.yaml", "seed: 3\n");
  EXPECT_EQ(b.load("extends: base\n").seed, 3U);
}

TEST(Extends, RefusesCirclesAndLongChains) {
  ConfigHarness b;
  b.file("b.yaml", "extends: a.yaml\n");
  EXPECT_EQ(b.error("extends: b.yaml\n"), "b.yaml:1:10: extends: 'a.yaml' extends itself");
  EXPECT_EQ(b.error("unit: {extends: a.yaml}\n"), "a.yaml:1:17: unit.extends: 'a.yaml' extends itself");
  for (int i = 0; i < 20; ++i) {
    b.file("c" + std::to_string(i) + ".yaml", "extends: c" + std::to_string(i + 1) + ".yaml\n");
  }
  EXPECT_EQ(b.error("extends: c0.yaml\n"), "c14.yaml:1:10: extends: more than 16 files extend each other");
  EXPECT_EQ(b.error("extends: [b.yaml]\n"), "a.yaml:1:10: extends: allowed: the name of a configuration file");
}

TEST(Sets, AreAppliedLastAndInOrder) {
  ConfigHarness b;
  b.file("small.yaml", "size: 1 KiB\nways: 2\n");
  set_config_search_path({b.folder().path()});
  const MachineConfig c =
      b.load("seed: 1\nl2: {ways: 8}\n", {"seed=2", "seed=3", "unit.rays=5 rays", "l2.extends=small.yaml",
                                          "unit.l1={size: 512 B, ways: 1}", "name= spaced = out", "refresh=2 pJ",
                                          "events.tni.box={low: 1, nominal: 2, high: 3}", "events={tni.tri: 9}"});
  EXPECT_EQ(c.seed, 3U);
  EXPECT_EQ(c.unit.rays, 5U);
  EXPECT_EQ(c.l2, (CacheConfig{{1024}, {64}, 2}));
  EXPECT_EQ(c.unit.l1, (CacheConfig{{512}, {64}, 1}));
  EXPECT_EQ(c.name, " spaced = out");
  EXPECT_EQ(c.refresh, (Band{2, 2, 2}));
  EXPECT_EQ(c.events, (std::map<std::string, Band>{{"tni.box", {1, 2, 3}}, {"tni.tri", {9, 9, 9}}}));
}

TEST(Sets, OneNumberSetsAllOfABand) {
  ConfigHarness b;
  for (const char* set : {"refresh=2", "refresh.nominal=2"}) {
    EXPECT_EQ(b.load("refresh: {low: 1, nominal: 3, high: 5}\n", {set}).refresh, (Band{2, 2, 2})) << set;
  }
  for (const char* set : {"events.tni.box=2", "events.tni.box.nominal=2"}) {
    const MachineConfig c = b.load("events: {tni.box: {low: 1, nominal: 3, high: 5}}\n", {set});
    EXPECT_EQ(c.events, (std::map<std::string, Band>{{"tni.box", {2, 2, 2}}})) << set;
  }
}

TEST(Sets, ABandIsNotSetInPart) {
  ConfigHarness b;
  EXPECT_EQ(b.error("seed: 1\n", {"events.tni.box.low=2"}),
            "--set events.tni.box.low=2: events.tni.box.low: is a part of a band; allowed: one number, which leaves no "
            "band, or all of {low: 1, nominal: 2, high: 3}");
  EXPECT_EQ(
      b.error("seed: 1\n", {"refresh.high=2"}),
      "--set refresh.high=2: refresh.high: is a part of a band; allowed: one number, which leaves no band, or all "
      "of {low: 1, nominal: 2, high: 3}");
}

TEST(Sets, ErrorsNameTheArgument) {
  ConfigHarness b;
  EXPECT_EQ(b.error("seed: 1\n", {"unit.rays=l33t"}),
            "--set unit.rays=l33t: unit.rays: 'l33t' is not a whole number; allowed: 1 to 64 rays");
  EXPECT_EQ(b.error("seed: 1\n", {"rays=1"}), "--set rays=1: rays: unknown key 'rays'; did you mean 'unit.rays'?");
  EXPECT_EQ(b.error("seed: 1\n", {"seed"}), "--set seed: allowed: key=value, e.g. --set cores=2");
  EXPECT_EQ(b.error("seed: 1\n", {"=1"}), "--set =1: allowed: key=value, e.g. --set cores=2");
  EXPECT_EQ(b.error("seed: 1\n", {"seed.x=1"}), "--set seed.x=1: seed.x: 'seed' is one value, without keys inside");
  EXPECT_EQ(b.error("seed: 1\n", {"unit=1"}), "--set unit=1: unit: is a group of fields; allowed: a mapping");
  EXPECT_EQ(b.error("seed: 1\n", {"unit={rays: 1, rays: 2}"}),
            "--set unit={rays: 1, rays: 2}:1:11: the key 'rays' is given twice");
  EXPECT_EQ(b.error("seed: 1\n", {"l2.ways=3"}), "--set l2.ways=3: l2.size: is no whole number of sets");
  EXPECT_EQ(b.error("seed: 1\n", {"l2.extends=x"}), "--set l2.extends=x: l2.extends: no configuration file 'x'");
}

TEST(ApplySets, ChangesAConfigurationInPlace) {
  MachineConfig c;
  apply_sets(c, std::vector<std::string>{"unit.stack=short"});
  EXPECT_EQ(c.unit.stack, Stack::kShort);
}

/// A configuration and a variant of it.
struct Bound {
  MachineConfig base, config;
  ConfigNode base_tree = config_tree(base), tree = config_tree(config);
  ConfigVariant variant{base_tree, tree};

  void set(const std::string& argument) { ConfigLoader(tree).apply_set(argument); }
  void expect_hashes_of_the_whole_tree() const {
    EXPECT_EQ(variant.hash({}), hash_tree(tree, {}));
    for (std::size_t i = 0; i < names_of(Affects{}).size(); ++i) {
      const auto only = static_cast<Affects>(i);
      EXPECT_EQ(variant.hash(only), hash_tree(tree, only)) << names_of(only)[i];
    }
  }
};

constexpr const char* kArguments[] = {"direct=false",
                                      "seed=99",
                                      "threshold=0.25",
                                      "name=\"a: b\"",
                                      "clock=333 MHz",
                                      "fabric=3 ns",
                                      "refresh={low: 1, nominal: 4, high: 9}",
                                      "events.tni.box_test=3",
                                      "unit.rays=7",
                                      "unit.stack=restart",
                                      "unit.prefetch=on",
                                      "unit.l1.size=4 KiB",
                                      "l2.ways=8"};

TEST(ConfigVariant, HashesAsItsWholeTreeWhateverHasChanged) {
  Bound b;
  b.expect_hashes_of_the_whole_tree();
  for (const char* argument : kArguments) {
    SCOPED_TRACE(argument);
    b.set(argument);
    b.expect_hashes_of_the_whole_tree();
  }
}

TEST(ConfigVariant, IsTheBaseAfterAReset) {
  Bound b;
  const std::string hash = b.variant.hash({});
  for (const char* argument : kArguments) {
    SCOPED_TRACE(argument);
    b.set(argument);
    EXPECT_NE(b.variant.hash({}), hash);
    b.variant.reset();
    EXPECT_EQ(b.config, b.base);
    EXPECT_EQ(b.variant.hash({}), hash);
    for (const ConfigNode& node : b.tree.children) EXPECT_EQ(node.origin, "") << node.key;
  }
}

TEST(ConfigVariant, NamesNoFormerArgumentAfterAReset) {
  Bound b;
  b.set("l2.ways=3");  // the number of sets is then not an integer
  EXPECT_THROW(check_tree(b.tree), std::exception);
  b.variant.reset();
  EXPECT_NO_THROW(check_tree(b.tree));
}

struct Config {
  Triple colour{0.5, 1, 0};
  static void describe(auto& c, auto&& field) {
    field(NAMED(c.colour), "", "linear RGB", between(0, 1), Affects::kFunction);
  }
};

Config with(const std::string& value) {
  Config config;
  const std::vector<std::string> sets = {"colour=" + value};
  apply_sets(config, sets);
  return config;
}

std::string refusal(const std::string& value) {
  try {
    with(value);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Triple, IsThreeNumbersInOneText) {
  EXPECT_EQ(with("0.25 0 1e-3").colour, (Triple{0.25, 0, 1e-3}));
  EXPECT_EQ(with("  1   1  1 ").colour, (Triple{1, 1, 1}));
}

TEST(Triple, IsDumpedAsItIsRead) {
  EXPECT_EQ(config_json(with("0.25 0 1"))["colour"], "0.25 0 1");
  EXPECT_NE(dump_config(with("0.25 0 1")).find("colour: 0.25 0 1  #"), std::string::npos);
}

TEST(Triple, RefusesWhatIsNotThreeNumbers) {
  for (const char* text : {"1 2", "1 2 3 4", "red", "1 x 0", "nan 0 0", ""}) {
    EXPECT_NE(refusal(text).find("is not three numbers"), std::string::npos) << text << ": " << refusal(text);
  }
}

TEST(Triple, KeepsItsLimitsInEveryNumber) {
  EXPECT_NE(refusal("0 0 1.5").find("'1.5' is out of range; allowed: three numbers, each 0 to 1"), std::string::npos)
      << refusal("0 0 1.5");
}

// Tests of keys that select files for several groups at once, and of files that scale values of the file that they
// extend.

struct BundleTable {
  std::string process = "none";
  std::map<std::string, Band> events;
  Band leakage{1, 2, 3};
  double share = 0.5;
  static void describe(auto& c, auto&& field) {
    field(NAMED(c.process), "", "what it describes", any(), Affects::kReport);
    field(NAMED(c.events), "pJ", "of one event", at_least(0), Affects::kEnergy);
    field(NAMED(c.leakage), "mW", "of storage", at_least(0), Affects::kEnergy);
    field(NAMED(c.share), "", "of the clock", between(0, 1), Affects::kEnergy);
  }
};

struct Chip {
  std::string process;
  BundleTable energy, area;
  static void describe(auto& c, auto&& field) {
    field.bundle_choice(NAMED(c.process), "of the chip", {"energy", "area"}, Affects::kEnergy);
    field.group(NAMED(c.energy), "energy");
    field.group(NAMED(c.area), "area");
  }
};

/// Tests with tables of 14 nm, and tables of 7 nm that scale them.
class Bundle : public testing::Test {
 protected:
  Bundle() {
    file("energy/14nm.yaml",
         "process: 14 nm\nevents: {a.one: {low: 1, nominal: 2, high: 4}, a.two: 3, a.b_c: 5, cache.read@1KiB: 8}\n");
    file("energy/7nm.yaml",
         "extends: 14nm.yaml\nprocess: 7 nm\n"
         "scale: {events: 0.5, events.a.one: {low: 0.25, nominal: 0.5, high: 1}, events.cache: 0.75, leakage: 0.1}\n");
    file("area/14nm.yaml", "process: 14 nm\n");
    file("area/7nm.yaml", "process: 7 nm\n");
    set_config_search_path({folder_.path()});
  }
  ~Bundle() override { set_config_search_path({}); }
  Bundle(const Bundle&) = delete;
  Bundle& operator=(const Bundle&) = delete;

  void file(const std::string& name, const std::string& text) { folder_.write(name, text); }
  Chip load(const std::string& text, const std::vector<std::string>& sets = {}) {
    return load_config<Chip>(folder_.write("a.yaml", text), sets);
  }
  std::string error(const std::string& text, const std::vector<std::string>& sets = {}) {
    return complaint<InputError>(folder_, [&] { load(text, sets); });
  }

  Folder folder_;
};

TEST_F(Bundle, ReadsTheFileOfItsNameInEachOfItsGroups) {
  const Chip c = load("process: 14nm\n");
  EXPECT_EQ(c.process, "14nm");
  EXPECT_EQ(c.energy.process, "14 nm");
  EXPECT_EQ(c.area.process, "14 nm");
}

TEST_F(Bundle, ScalesFiguresByTheLongestKeyThatCoversThem) {
  const BundleTable t = load("process: 7nm\n").energy;
  EXPECT_EQ(t.events.at("a.one"), (Band{0.25, 1, 4}));
  EXPECT_EQ(t.events.at("a.two"), (Band{1.5, 1.5, 1.5}));
  EXPECT_EQ(t.events.at("cache.read@1KiB"), (Band{6, 6, 6}));
  EXPECT_EQ(t.leakage, (Band{0.1, 2 * 0.1, 3 * 0.1}));
  EXPECT_EQ(t.share, 0.5);
}

TEST_F(Bundle, OfASettingIsReadWhereTheFileHasIts) {
  file("base.yaml", "process: 14nm\nenergy: {events: {a.two: 7}}\n");
  const Chip c = load("extends: base.yaml\n", {"process=7nm"});
  EXPECT_EQ(c.process, "7nm");
  EXPECT_EQ(c.energy.events.at("a.two").nominal, 7) << "a figure of a file stays, whichever process is chosen";
  EXPECT_EQ(c.energy.events.at("a.one").nominal, 1);
}

TEST_F(Bundle, OfTheOutermostFileCounts) {
  file("base.yaml", "process: 14nm\nenergy: {events: {a.two: 7}}\n");
  const Chip c = load("extends: base.yaml\nprocess: 7nm\n");
  EXPECT_EQ(c.process, "7nm");
  EXPECT_EQ(c.energy.process, "7 nm");
  EXPECT_EQ(c.energy.events.at("a.two").nominal, 7);
}

TEST_F(Bundle, IsSearchedBesideTheFileThatNamesIt) {
  file("base.yaml", "process: 14nm\n");
  folder_.write("mine/energy/own.yaml", "process: own\n");
  folder_.write("mine/area/own.yaml", "process: own\n");
  const auto chip = folder_.write("mine/chip.yaml", "extends: ../base.yaml\nprocess: own\n");
  EXPECT_EQ(load_config<Chip>(chip).energy.process, "own");
}

TEST_F(Bundle, OfTheLastSettingCounts) {
  EXPECT_EQ(load("process: 14nm\n", {"process=7nm", "process=14nm"}).area.process, "14 nm");
}

TEST_F(Bundle, MayBeFollowedByAnotherTableInOneGroup) {
  const Chip c = load("process: 14nm\n", {"area.extends=7nm"});
  EXPECT_EQ(c.energy.process, "14 nm");
  EXPECT_EQ(c.area.process, "7 nm");
}

TEST_F(Bundle, SurvivesADump) {
  const Chip c = load("process: 7nm\nenergy: {events: {a.one: 9}}\n");
  Chip again;
  ConfigNode tree = config_tree(again);
  ConfigLoader(tree).apply_text(dump_config(c), "dump");
  EXPECT_EQ(dump_config(again), dump_config(c));
}

TEST_F(Bundle, WithoutSuchAFileIsRefused) {
  const std::string unknown = error("process: 6nm\n");
  EXPECT_NE(unknown.find("a.yaml:1:10: process: no configuration file 'energy/6nm'"), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("known: 14nm, 7nm"), std::string::npos) << unknown;
  const std::string set = error("process: 14nm\n", {"process=6nm"});
  EXPECT_NE(set.find("--set process=6nm: process: no configuration file 'energy/6nm'"), std::string::npos) << set;
  EXPECT_NE(error("process: [7nm]\n").find("allowed: a name that files of energy, area have"), std::string::npos);
}

TEST_F(Bundle, ScalesThatFitNothingAreRefused) {
  file("energy/bad.yaml", "extends: 14nm.yaml\nscale: {events.nothing: 2}\n");
  file("energy/alone.yaml", "scale: {events: 2}\n");
  file("energy/share.yaml", "extends: 14nm.yaml\nscale: {share: 2}\n");
  file("energy/minus.yaml", "extends: 14nm.yaml\nscale: {events: -1}\n");
  EXPECT_NE(error("energy: {extends: bad}\n").find("energy.scale.events.nothing: covers no figure"), std::string::npos);
  EXPECT_NE(error("energy: {extends: alone}\n").find("allowed: after 'extends'"), std::string::npos);
  EXPECT_NE(error("energy: {extends: share}\n").find("energy.scale.share: covers no figure"), std::string::npos);
  EXPECT_NE(error("energy: {extends: minus}\n").find("energy.scale.events"), std::string::npos);
}

struct Case {
  const char* text;
  const char* complaint;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.text; }
std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  const std::string name = ::test::name_of_text(info.param.text);
  return name.substr(0, 40) + (name.empty() ? "" : "_") + std::to_string(info.index);
}

class ConfigError : public ::testing::TestWithParam<Case> {};

TEST_P(ConfigError, NamesFileLineColumnKeyAndWhatIsAllowed) {
  EXPECT_EQ(ConfigHarness().error(GetParam().text), GetParam().complaint);
}

INSTANTIATE_TEST_SUITE_P(
    Values, ConfigError,
    ::testing::Values(
        Case{"seed: 1\nunit:\n  rays: l33t\n",
             "a.yaml:3:9: unit.rays: 'l33t' is not a whole number; allowed: 1 to 64 rays"},
        Case{"unit: {rays: 65}", "a.yaml:1:14: unit.rays: '65' is out of range; allowed: 1 to 64 rays"},
        Case{"unit: {rays: 99999999999}",
             "a.yaml:1:14: unit.rays: '99999999999' is out of range; allowed: 1 to 64 rays"},
        Case{"unit: {rays: 1.5}", "a.yaml:1:14: unit.rays: '1.5' is not a whole number; allowed: 1 to 64 rays"},
        Case{"unit: {rays: -1}", "a.yaml:1:14: unit.rays: '-1' is out of range; allowed: 1 to 64 rays"},
        Case{"unit: {rays: 6 cycles}",
             "a.yaml:1:14: unit.rays: '6 cycles' is not a whole number; allowed: 1 to 64 rays"},
        Case{"unit: {rays: [1]}",
             "a.yaml:1:14: unit.rays: is a list; allowed: one value, 1 to 64 rays; lists are for axes of a sweep "
             "(docs/sweeps.md)"},
        Case{"unit: {rays: {x: 1}}", "a.yaml:1:14: unit.rays: has no value; allowed: 1 to 64 rays"},
        Case{"unit:\n  rays:\n", "a.yaml:2:3: unit.rays: has no value; allowed: 1 to 64 rays"},
        Case{"seed: 18446744073709551616",
             "a.yaml:1:7: seed: '18446744073709551616' is out of range; allowed: at least 0"},
        Case{"direct: yes", "a.yaml:1:9: direct: 'yes' is not true or false; allowed: true, false"},
        Case{"threshold: nan", "a.yaml:1:12: threshold: 'nan' is not a number; allowed: -1 to 1"},
        Case{"threshold: 2", "a.yaml:1:12: threshold: '2' is out of range; allowed: -1 to 1"},
        Case{"unit: {stack: shrt}",
             "a.yaml:1:15: unit.stack: 'shrt' is not one of the choices; allowed: full, short, restart"},
        Case{"clock: 500", "a.yaml:1:8: clock: '500' has no unit (one of Hz, kHz, MHz, GHz); allowed: 1 MHz to 10 GHz"},
        Case{"clock: 500 mhz",
             "a.yaml:1:8: clock: '500 mhz' has the unknown unit 'mhz' (not one of Hz, kHz, MHz, GHz); allowed: 1 MHz "
             "to 10 GHz"},
        Case{"clock: fast", "a.yaml:1:8: clock: 'fast' is not a number with a unit; allowed: 1 MHz to 10 GHz"},
        Case{"clock: 20 GHz", "a.yaml:1:8: clock: '20 GHz' is out of range; allowed: 1 MHz to 10 GHz"},
        Case{"l2: {line: 0.3 B}",
             "a.yaml:1:12: l2.line: '0.3 B' is not a whole number of B; allowed: powers of two from 16 B to 256 B"},
        Case{"l2: {line: 48 B}",
             "a.yaml:1:12: l2.line: '48 B' is out of range; allowed: powers of two from 16 B to 256 B"},
        Case{"fabric: 99999999999999 s", "a.yaml:1:9: fabric: '99999999999999 s' is too large; allowed: 0 fs to 1 us"},
        Case{"refresh: 3 mW", "a.yaml:1:10: refresh: '3 mW' is not a number; allowed: at least 0 pJ"},
        Case{"refresh: {low: 1, nominal: 2}", "a.yaml:1:10: refresh: is incomplete; allowed: low, nominal and high"},
        Case{"refresh: {low: 1, mid: 2}", "a.yaml:1:19: refresh.mid: unknown key; allowed: low, nominal, high"},
        Case{"refresh: {low: 1, nominal: x, high: 3}",
             "a.yaml:1:28: refresh.nominal: 'x' is not a number; allowed: at least 0 pJ"},
        Case{"refresh: {low: 3, nominal: 2, high: 1}",
             "a.yaml:1:10: refresh: '{low: 3, nominal: 2, high: 1}' is not in order; allowed: low <= nominal <= high"},
        Case{"events: 3", "a.yaml:1:9: events: '3' is not a mapping of names to figures; allowed: at least 0 pJ"},
        Case{"events: {a: -1}", "a.yaml:1:13: events.a: '-1' is out of range; allowed: at least 0 pJ"},
        Case{"unit: 3", "a.yaml:1:7: unit: is a group of fields; allowed: a mapping"},
        Case{"seed: 1\nl2: {line: 32 B, size: 100 B}", "a.yaml:2:18: l2.size: is no whole number of sets"},
        Case{"l2: {ways: 3}", "a.yaml:1:1: l2.size: is no whole number of sets"}),
    case_name);

INSTANTIATE_TEST_SUITE_P(
    Keys, ConfigError,
    ::testing::Values(Case{"unit: {rasy: 1}", "a.yaml:1:8: unit.rasy: unknown key 'rasy'; did you mean 'unit.rays'?"},
                      Case{"stack: full", "a.yaml:1:1: stack: unknown key 'stack'; did you mean 'unit.stack'?"},
                      Case{"l2: {blue: 1}", "a.yaml:1:6: l2.blue: unknown key 'blue'; allowed: size, line, ways"},
                      Case{"seed: 1\nseed: 2", "a.yaml:2:1: the key 'seed' is given twice"},
                      Case{"? [a]\n: 1", "a.yaml:1:3: a key must be plain text"},
                      Case{"~: 1", "a.yaml:1:1: a key must be plain text"}),
    case_name);

INSTANTIATE_TEST_SUITE_P(
    Files, ConfigError,
    ::testing::Values(
        Case{"", "a.yaml: is empty; allowed: a mapping"}, Case{"# nothing\n", "a.yaml: is empty; allowed: a mapping"},
        Case{"~", "a.yaml: is empty; allowed: a mapping"},
        Case{"- 1\n- 2\n", "a.yaml:1:1: holds no 'key: value' at its top level"},
        Case{"seed", "a.yaml:1:1: holds no 'key: value' at its top level"},
        Case{"seed: 1\n---\nseed: 2\n", "a.yaml:2:1: a second document begins; allowed: one"},
        Case{"seed: !!int 1",
             "a.yaml:1:7: the tag 'tag:yaml.org,2002:int' has no meaning here; allowed: values without tags"},
        Case{"unit: &x {l1: *x}", "a.yaml:1:15: an alias stands inside the value it repeats"},
        Case{"unit: {rays: 1\nseed: 3\nl2: 4\n", "a.yaml:2:5: is not valid YAML: end of map flow not found"},
        Case{"name: \"plain\nseed: 1\n", "a.yaml:2:8: is not valid YAML: illegal EOF in scalar"},
        Case{"seed: 1\n\tunit: 2\n", "a.yaml:2:1: a tab indents this line; allowed: spaces"}),
    case_name);

TEST(ConfigFile, AliasBombsAreRefusedAtOnce) {
  std::string bomb = "a0: &a0 [x, x]\n";
  for (int i = 1; i < 64; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + last + ", " + last + "]\n";
  }
  EXPECT_EQ(ConfigHarness().error(bomb + "unit: *a63\n").substr(0, 28), "a.yaml:1:1: a0: unknown key ");
}

TEST(ConfigFile, DeepNestingIsRefused) {
  const std::string deep = "unit: " + std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_NE(ConfigHarness().error(deep).find(": is nested too deeply"), std::string::npos);
}

TEST(ConfigFile, MustBeAReadableFileOfSensibleSize) {
  const ConfigHarness b;
  const auto load = [&](const char* name) {
    return complaint<InputError>(b.folder(), [&] { load_config<MachineConfig>(b.folder().path() / name); });
  };
  EXPECT_EQ(load("none.yaml"), "none.yaml: no such file");
  std::filesystem::create_directory(b.folder().path() / "folder.yaml");
  EXPECT_EQ(load("folder.yaml"), "folder.yaml: is a folder, not a file");
  ::mkfifo((b.folder().path() / "pipe.yaml").c_str(), 0600);
  EXPECT_EQ(load("pipe.yaml"), "pipe.yaml: is not a regular file");
  std::filesystem::create_symlink("loop.yaml", b.folder().path() / "loop.yaml");
  EXPECT_EQ(load("loop.yaml"), "loop.yaml: Too many levels of symbolic links");
  if (::geteuid() != 0) {
    ::chmod(b.folder().write("secret.yaml", "seed: 1").c_str(), 0);
    EXPECT_EQ(load("secret.yaml"), "secret.yaml: cannot be opened: Permission denied");
  }
  b.folder().write("large.yaml", std::string((4 << 20) + 1, '#'));
  EXPECT_EQ(load("large.yaml"), "large.yaml: is too large; allowed: 4194304 bytes");
}

TEST(ConfigFile, MessagesAreOneLineOfPrintableText) {
  const std::string message = ConfigHarness().error("unit: {\"ra\\nys\\e[31m\": 1}");
  EXPECT_EQ(message, "a.yaml:1:8: unit.ra?ys?[31m: unknown key 'ra?ys?[31m'; allowed: rays, stack, prefetch, l1");
}

TEST(ConfigRules, NameTheFileThatChangedTheOtherFieldOfTheRule) {
  ConfigHarness b;
  b.folder().write("base.yaml", "unit:\n  l1: {size: 1 KiB}\n");
  EXPECT_EQ(b.error("extends: base\nunit: {l1: {ways: 3}}\n"),
            "a.yaml:2:13: unit.l1.size: is no whole number of sets (base.yaml:2:8 has its value)");
  EXPECT_EQ(b.error("extends: base\nunit: {l1: {ways: 4, size: 100 B}}\n"),
            "a.yaml:2:22: unit.l1.size: is no whole number of sets");
}

TEST(ConfigRules, NameTheArgumentThatChangedTheOtherFieldOfTheRule) {
  const std::string file = "unit:\n  l1: {size: 1 KiB}\nl2: {size: 1 KiB}\n";
  EXPECT_EQ(ConfigHarness().error(file, {"unit.l1.ways=3", "unit.rays=8"}),
            "--set unit.l1.ways=3: unit.l1.size: is no whole number of sets (a.yaml:2:8 has its value)");
  EXPECT_EQ(
      ConfigHarness().error(file, {"unit.l1.ways=3", "unit.l1.line=128 B"}),
      "--set unit.l1.line=128 B, --set unit.l1.ways=3: unit.l1.size: is no whole number of sets (a.yaml:2:8 has its "
      "value)");
  EXPECT_EQ(ConfigHarness().error(file, {"unit.l1.size=100 B", "unit.l1.ways=4"}),
            "--set unit.l1.size=100 B: unit.l1.size: is no whole number of sets");
}

TEST(CheckConfig, NamesTheKeyOfAStructFilledInCode) {
  MachineConfig c;
  EXPECT_NO_THROW(check_config(c));
  c.unit.rays = 0;
  const Folder folder;
  EXPECT_EQ(complaint<InputError>(folder, [&] { check_config(c); }),
            "unit.rays: '0' is out of range; allowed: 1 to 64 rays");
  c.unit.rays = 1;
  c.l2.ways = 3;
  EXPECT_EQ(complaint<InputError>(folder, [&] { check_config(c); }), "l2.size: is no whole number of sets");
}

}  // namespace

}  // namespace sim::test
