#include <fstream>

#include <gtest/gtest.h>
#include <pugixml.hpp>

#include "tests/tools/program.h"

// A suite of small runs, its stored values, and what is said when something has moved.

namespace test {
namespace {

/// A suite of two runs on a machine of its own, one thing at a time, so that whatever moves can be named.
class Suite {
 public:
  explicit Suite(const std::string& keep = "{cycles: exact, rays: exact, energy_mj: 0.000001 %, units: exact}") {
    machine("");
    write("keep: " + keep + R"(
defaults: {config: machine.yaml, set: {scene.triangles: 500}}
runs:
  pixel: {resolution: 1x1}
  square: {resolution: 4x4}
)");
  }
  void write(const std::string& text) { file_ = folder_.write("suite.yaml", text).string(); }
  /// The suite's machine, with a line that changes it.
  void machine(const std::string& change) { folder_.write("machine.yaml", "extends: " + change_base_ + "\n" + change); }
  Ending baseline(const std::string& step, const Words& more = {}) const {
    Words words = {"baseline", step, file_};
    words.insert(words.end(), more.begin(), more.end());
    return raywatt(words);
  }
  std::string values() const { return read_bytes(folder_.path() / "suite.baseline.yaml"); }
  void write_values(const std::string& text) const { folder_.write("suite.baseline.yaml", text); }
  const TempFolder& folder() const { return folder_; }

 private:
  TempFolder folder_;
  std::string file_;
  const std::string change_base_ = folder_
                                       .write("serial.yaml", R"(
extends: sgrt-2016
cores: 1
tni: {trvs: 1, trv: {rays: 1, l1: {size: 1 KiB}}}
l2: {banks: 1}
tile_buffer: {tiles_in_flight: 1}
dram: {channels: 1, timing: {refi_pb: 0, refi_ab: 0}}
)")
                                       .filename()
                                       .string();
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

TEST(Baseline, OfAnUnchangedMachineIsAsStored) {
  const Suite suite;
  const Ending recorded = suite.baseline("record");
  ASSERT_EQ(recorded.exit, 0) << recorded.err;
  EXPECT_SAYS(recorded.out, "suite.baseline.yaml");
  const Ending checked = suite.baseline("check");
  EXPECT_EQ(checked.exit, 0) << checked.out << checked.err;
  EXPECT_SAYS(checked.out, "ok       pixel");
  EXPECT_SAYS(checked.out, "ok       square");
}

TEST(Baseline, IsTheSameFileHoweverManyRunAtOnce) {
  const Suite suite;
  ASSERT_EQ(suite.baseline("record", {"-j", "1"}).exit, 0);
  const std::string one = suite.values();
  ASSERT_EQ(suite.baseline("record", {"-j", "4", "--force"}).exit, 0);
  EXPECT_EQ(suite.values(), one);
}

TEST(Baseline, IsWrittenForPeopleToRead) {
  const Suite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const std::string text = suite.values();
  for (const char* part :
       {"schema: raywatt-baseline/1", "embree: ", "bvh_hash: ", "tni.trv.box_latency: 12", "program: full:1",
        "totals.rays: {", "units.core.tni.trv.why: {", "totals: {cycles: ", "totals.rays: {primary: "}) {
    EXPECT_SAYS(text, part);
  }
}

TEST(Baseline, RecordDoesNotReplaceValuesUnseen) {
  const Suite suite;
  expect_refusal(suite.baseline("check"), {"suite.baseline.yaml", "baseline record"});
  expect_refusal(suite.baseline("accept"), {"suite.baseline.yaml", "baseline record"});
  ASSERT_EQ(suite.baseline("record").exit, 0);
  expect_refusal(suite.baseline("record"), {"suite.baseline.yaml", "accept", "--force"});
}

/// A change of one cycle, or as near as its unit comes, and where it is.
struct Latency {
  const char* change;
  const char* unit;
};

TEST(Baseline, ACycleMoreInOneLatencyFailsAndNamesTheUnit) {
  Suite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  for (const Latency& l :
       {Latency{"tni: {trv: {box_latency: 13}}", "core.tni.trv"},
        Latency{"tni: {trv: {stack_latency: 3}}", "core.tni.trv"},
        Latency{"tni: {trv: {leaf_latency: 5}}", "core.tni.trv"},
        Latency{"tni: {trv: {l1: {hit_cycles: 3}}}", "core.tni.trv"},
        Latency{"tni: {ist: {l1: {hit_cycles: 3}}}", "core.tni.ist"},
        Latency{"tni: {ist: {latency: 23}}", "core.tni.ist"}, Latency{"l2: {hit_cycles: 13}", "l2.bank"},
        Latency{"l2: {lookup_cycles: 5}", "l2.bank"}, Latency{"dram: {timing: {rl: 29}}", "dram.channel"},
        Latency{"dram: {timing: {rcd: 30}}", "dram.channel"}, Latency{"srp: {latency: {fp_add: 3}}", "core.srp"},
        Latency{"srp: {switch_cycles: 101}", "core.srp"},
        Latency{"interconnect: {latency: 5}", "interconnect between first-level caches and L2"},
        Latency{"dram: {fabric: 52 ns}", "way between L2 and memory"}}) {
    suite.machine(l.change);
    const Ending ending = suite.baseline("check");
    EXPECT_EQ(ending.exit, 1) << l.change << ending.err;
    EXPECT_SAYS(ending.out, std::string("\nMost likely in ") + l.unit + ",") << l.change;
    EXPECT_SAYS(ending.out, "totals.cycles");
    EXPECT_SAYS(ending.out, "The configuration has changed: ");
  }
}

TEST(Baseline, SaysWhatMovedByHowMuchAndWhichKeyIsToBlame) {
  Suite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("tni: {trv: {box_latency: 13}}");
  const Ending ending = suite.baseline("check");
  EXPECT_SAYS(ending.out, "MOVED    pixel: ");
  EXPECT_SAYS(ending.out, "units.core.tni.trv.why.pipe: ");
  EXPECT_SAYS(ending.out, "tni.trv.box_latency was 12, is 13");
  EXPECT_SAYS(ending.out, "2 of 2 runs moved");
}

TEST(Baseline, ATolerancePasses) {
  Suite suite("{cycles: 20 %}");
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("tni: {trv: {box_latency: 13}}");
  EXPECT_EQ(suite.baseline("check").exit, 0);
  suite.machine("tni: {trv: {box_latency: 40}}");
  const Ending ending = suite.baseline("check");
  EXPECT_EQ(ending.exit, 1);
  EXPECT_SAYS(ending.out, "1 of 1 values");
  EXPECT_EQ(ending.out.find("Most likely"), std::string::npos) << "no counters of units are kept";
}

TEST(Baseline, ThePathNamedLastHasItsTolerance) {
  Suite suite(
      "{totals.rays: exact, units: exact, units.core: 100 %, units.dram: 100 %, units.l2: 100 %, "
      "units.tile_dispatcher: 100 %}");
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("tni: {trv: {box_latency: 13}}");
  EXPECT_EQ(suite.baseline("check").exit, 0) << suite.baseline("check").out;
}

TEST(Baseline, AcceptShowsWhatMovedAndTakesIt) {
  Suite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("l2: {lookup_cycles: 5}");
  const Ending accepted = suite.baseline("accept");
  EXPECT_EQ(accepted.exit, 0) << accepted.err;
  EXPECT_SAYS(accepted.out, "Most likely in l2.bank");
  EXPECT_SAYS(accepted.out, "MOVED    square");
  EXPECT_EQ(suite.baseline("check").exit, 0);
}

TEST(Baseline, OfAnotherEmbreeIsRefusedBeforeAnythingIsComputed) {
  const Suite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  std::string text = suite.values();
  const std::size_t at = text.find("embree: ") + 8;
  text.replace(at, text.find('\n', at) - at, "2.17.7");
  suite.write_values(text);
  expect_refusal(suite.baseline("check"), {"stored with Embree 2.17.7", "other trees", "accept"});
}

/// Ended with 2 and a line of why; other than a refusal it has told of the runs before.
void expect_not_comparable(const Ending& ending, const Words& parts) {
  EXPECT_EQ(ending.exit, 2) << ending.out;
  for (const std::string& part : parts) EXPECT_SAYS(ending.err, part);
  EXPECT_SAYS(ending.out, "REFUSED");
  EXPECT_EQ(ending.out.find("MOVED"), std::string::npos) << ending.out;
}

TEST(Baseline, OfAnotherTreeIsRefusedAndNoRegression) {
  Suite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const std::string text = suite.values();
  const std::size_t at = text.find("bvh_hash: ") + 10;
  suite.write_values(std::string(text).replace(at, 6, "abcdef"));
  expect_not_comparable(suite.baseline("check"),
                        {"1 of 2 runs cannot be checked", "'pixel'", "another tree", "bvh_hash was abcdef"});
  suite.write_values(text);
  suite.machine("bvh: {traversal_cost: 3}");
  expect_not_comparable(suite.baseline("check"), {"2 of 2 runs", "bvh.traversal_cost was 1.0, is 3.0"});
}

TEST(Baseline, OfOtherWorkIsRefused) {
  Suite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const std::string text = suite.values();
  suite.machine("render: {depth: 2}");
  expect_not_comparable(suite.baseline("check"), {"render.depth was 3, is 2"});
  suite.machine("");
  suite.write_values(replaced(text, "program: full:1", "program: full:4"));
  expect_not_comparable(suite.baseline("check"), {"stored of program full:4, now full:1"});
  suite.write_values(replaced(text, "scene_sha256: ", "scene_sha256: 0"));
  expect_not_comparable(suite.baseline("check"), {"another scene"});
}

TEST(Baseline, OfOtherRunsIsRefused) {
  Suite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const std::string text = suite.values();
  suite.write_values(replaced(text, "  square:", "  round:"));
  expect_refusal(suite.baseline("check"), {"'round'", "no longer in the suite"});
  suite.write_values(text.substr(0, text.find("  square:")));
  expect_not_comparable(suite.baseline("check"), {"nothing is stored of it"});
  EXPECT_EQ(suite.baseline("accept").exit, 0);
  EXPECT_EQ(suite.values(), text);
}

TEST(Baseline, ValuesThatAreNotStoredOrNotKeptHaveMoved) {
  Suite suite("{cycles: exact, rays.primary: exact}");
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.write(replaced(read_bytes(suite.folder().path() / "suite.yaml"), "rays.primary", "rays.shadow"));
  const Ending ending = suite.baseline("check");
  EXPECT_EQ(ending.exit, 1);
  EXPECT_SAYS(ending.out, "totals.rays.primary: was 1, is gone");
  EXPECT_SAYS(ending.out, "nothing stored");
}

TEST(Baseline, WritesJunitXmlThatOthersCanRead) {
  Suite suite;
  suite.write(R"(
keep: {cycles: exact, units: exact}
defaults: {config: machine.yaml, resolution: 1x1, set: {scene.triangles: 500}}
runs:
  "a<b> & \"c\"": {}
  gone: {}
  steady: {config: serial.yaml}
)");
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("tni: {trv: {box_latency: 13}}");
  const std::string file = (suite.folder().path() / "junit.xml").string();
  const std::string text = suite.values();
  suite.write_values(text.substr(0, text.find("  gone:")) + text.substr(text.find("  steady:")));
  EXPECT_EQ(suite.baseline("check", {"--junit", file}).exit, 2);
  pugi::xml_document document;
  ASSERT_TRUE(document.load_file(file.c_str()));
  const pugi::xml_node root = document.child("testsuite");
  EXPECT_STREQ(root.attribute("name").value(), "suite");
  EXPECT_EQ(root.attribute("tests").as_int(), 3);
  EXPECT_EQ(root.attribute("failures").as_int(), 1);
  EXPECT_EQ(root.attribute("errors").as_int(), 1);
  const pugi::xml_node first = root.first_child(), second = first.next_sibling(), third = second.next_sibling();
  EXPECT_STREQ(first.attribute("name").value(), "a<b> & \"c\"");
  EXPECT_STREQ(first.attribute("classname").value(), "suite");
  EXPECT_GT(first.attribute("time").as_double(), 0);
  EXPECT_SAYS(std::string(first.child("failure").attribute("message").value()), "totals.cycles");
  EXPECT_SAYS(std::string(first.child("failure").child_value()), "most likely in core.tni.trv");
  EXPECT_SAYS(std::string(first.child("failure").child_value()), "units.core.tni.trv.why.pipe: ");
  EXPECT_SAYS(std::string(second.child("error").attribute("message").value()), "nothing is stored");
  EXPECT_FALSE(third.first_child()) << "all is well";
}

TEST(Baseline, AnXmlFileThatCannotBeWrittenIsSaid) {
  const Suite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const Ending ending = suite.baseline("check", {"--junit", (suite.folder().path() / "none" / "junit.xml").string()});
  EXPECT_EQ(ending.exit, 74);
  EXPECT_SAYS(ending.err, "junit");
}

TEST(Baseline, ASuiteThatCannotBeUsedIsRefusedWithItsPlace) {
  Suite suite;
  const auto refused = [&](const std::string& text, const Words& parts) {
    suite.write(text);
    for (const char* step : {"record", "check"}) expect_refusal(suite.baseline(step), parts);
  };
  suite.write_values("schema: raywatt-baseline/1\nruns: {}\n");
  suite.write("");
  expect_refusal(suite.baseline("check"), {"suite.yaml", "empty"});
  std::filesystem::remove(suite.folder().path() / "suite.baseline.yaml");
  const std::string keep = "keep: {cycles: exact}\n";
  refused("runs: {a: {}}\n", {"suite.yaml", "keep", "is missing"});
  refused(keep, {"suite.yaml", "runs", "is missing"});
  refused(keep + "runs: {}\n", {"runs", "is missing or empty"});
  refused(keep + "runs: [a]\n", {"suite.yaml:2:7", "mapping"});
  refused(keep + "run: {a: {}}\n", {"suite.yaml:2:1", "run", "did you mean 'runs'?"});
  refused(keep + "runs: {a: {scenes: teapot}}\n", {"suite.yaml:2:12", "scenes", "did you mean 'scene'?"});
  refused(keep + "runs: {a: {scene: [teapot]}}\n", {"suite.yaml:2:19", "plain value"});
  refused(keep + "runs: {a: {program: fool}}\n", {"suite.yaml:2:8", "runs.a", "'fool'"});
  refused(keep + "runs: {a: {resolution: 1}}\n", {"runs.a", "WIDTHxHEIGHT"});
  refused(keep + "runs: {a: {set: {tni.trv.ray: 1}}}\n", {"runs.a", "tni.trv.ray", "did you mean"});
  refused(keep + "runs: {a: {config: nowhere}}\n", {"runs.a", "nowhere"});
  refused(keep + "runs: {\"a\\nb\": {}}\n", {"suite.yaml:2:8", "printable"});
  refused("keep: {cycles: 5}\nruns: {a: {}}\n", {"suite.yaml:1:16", "exact", "0.5 %"});
  refused("keep: {cycles: -5 %}\nruns: {a: {}}\n", {"0 % to 100 %"});
}

TEST(Baseline, WhatOnlyARunCanTellIsRefusedThen) {
  Suite suite;
  const std::string runs = "\nruns: {a: {resolution: 1x1, set: {scene.triangles: 500}}}\n";
  suite.write("keep: {cycels: exact}" + runs);
  const Ending unknown = suite.baseline("record");
  EXPECT_EQ(unknown.exit, 2);
  EXPECT_SAYS(unknown.err, "suite.yaml:1:8: keep: there is no report path 'cycels', did you mean 'cycles'?");
  suite.write("keep: {nominal: exact}" + runs);
  EXPECT_SAYS(suite.baseline("record").err, "may mean any of");
  suite.write("keep: {cycles: exact}\nruns: {a: {scene: nowhere.glb}}\n");
  const Ending scene = suite.baseline("record");
  EXPECT_EQ(scene.exit, 2);
  EXPECT_SAYS(scene.err, "runs.a: ");
  EXPECT_SAYS(scene.err, "nowhere.glb");
  EXPECT_EQ(names_in(suite.folder().path()), (Words{"machine.yaml", "serial.yaml", "suite.yaml"}));
}

TEST(Baseline, StoredValuesThatAreNoneAreRefused) {
  const Suite suite;
  const std::string begin = "schema: raywatt-baseline/1\n";
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"", "empty"},
           {"schema: raywatt-report/1\nruns: {}\n", "schema"},
           {begin, "runs"},
           {begin + "runs: 5\n", "mapping"},
           {begin + "runs: {a: {values: {totals: {cycles: many}}}}\n", "must be a number"},
           {begin + "runs: {a: {values: {totals: 5}}}\n", "mapping"},
           {begin + "runs: {a: {program: {}}}\n", "plain value"},
           {begin + "runs: {a: {}}\n", "Embree"},
       }) {
    suite.write_values(text);
    expect_refusal(suite.baseline("check"), {"suite.baseline.yaml", part});
  }
}

}  // namespace
}  // namespace test
