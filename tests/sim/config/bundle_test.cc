#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "../folder.h"
#include "sim/config/config.h"
#include "sim/error.h"
#include "sim/named.h"

// Tests of keys that select files for several groups at once, and of files that scale values of the file that they
// extend.

namespace sim::test {
namespace {

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

}  // namespace
}  // namespace sim::test
