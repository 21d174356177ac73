#include <gtest/gtest.h>

#include "harness.h"

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

}  // namespace
}  // namespace sim::test
