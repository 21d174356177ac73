#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <pugixml.hpp>
#include <sys/stat.h>

#include "tests/full_size.h"
#include "tests/tools/studies/baseline/baseline_suite.h"

// Tests of `raywatt baseline`: a suite of small runs, its stored values, and the output after a change.

namespace test {
namespace {

namespace fs = std::filesystem;

TEST(Baseline, PassesForAnUnchangedMachine) {
  const BaselineSuite suite;
  const ProcessResult recorded = suite.baseline("record");
  ASSERT_EQ(recorded.exit, 0) << recorded.err;
  EXPECT_SAYS(recorded.out, "suite.baseline.yaml");
  const ProcessResult checked = suite.baseline("check");
  EXPECT_EQ(checked.exit, 0) << checked.out << checked.err;
  EXPECT_SAYS(checked.out, "ok       pixel");
  EXPECT_SAYS(checked.out, "ok       square");
}

TEST(Baseline, IsTheSameFileForAnyNumberOfJobs) {
  const BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record", {"-j", "1"}).exit, 0);
  const std::string one = suite.values();
  ASSERT_EQ(suite.baseline("record", {"-j", "4", "--force"}).exit, 0);
  EXPECT_EQ(suite.values(), one);
}

TEST(Baseline, IsReadableYaml) {
  const BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const std::string text = suite.values();
  for (const char* part :
       {"schema: raywatt-baseline/1", "embree: ", "bvh_hash: ", "tni.trv.box_latency: 12", "program: full:1",
        "totals.rays: {", "units.core.tni.trv.why: {", "totals: {cycles: ", "totals.rays: {primary: "}) {
    EXPECT_SAYS(text, part);
  }
}

TEST(Baseline, RecordDoesNotReplaceStoredValues) {
  const BaselineSuite suite;
  expect_refusal(suite.baseline("check"), {"suite.baseline.yaml", "baseline record"});
  expect_refusal(suite.baseline("accept"), {"suite.baseline.yaml", "baseline record"});
  ASSERT_EQ(suite.baseline("record").exit, 0);
  expect_refusal(suite.baseline("record"), {"suite.baseline.yaml", "accept", "--force"});
}

/// A change of the machine by one cycle, or by the smallest step of the key.
struct Latency {
  const char* change;  ///< line to add to the machine's configuration
  const char* key;
  const char *was, *is;
  const char* located;  ///< unit located from counters alone
  const char* unit;     ///< unit located by the changed key
};

constexpr Latency kLatencies[] = {
    {"tni: {trv: {box_latency: 13}}", "tni.trv.box_latency", "12", "13", "core.tni.trv", "core.tni.trv"},
    {"tni: {trv: {stack_latency: 3}}", "tni.trv.stack_latency", "2", "3", "core.tni.trv", "core.tni.trv"},
    {"tni: {trv: {leaf_latency: 5}}", "tni.trv.leaf_latency", "4", "5", "core.tni.trv", "core.tni.trv"},
    {"tni: {trv: {l1: {hit_cycles: 3}}}", "tni.trv.l1.hit_cycles", "2", "3", "core.tni.trv", "core.tni.trv"},
    {"tni: {ist: {l1: {hit_cycles: 3}}}", "tni.ist.l1.hit_cycles", "2", "3", "core.tni.ist", "core.tni.ist"},
    {"tni: {ist: {latency: 23}}", "tni.ist.latency", "22", "23", "core.tni.ist", "core.tni.ist"},
    {"l2: {hit_cycles: 13}", "l2.hit_cycles", "12", "13", "l2.bank", "l2.bank"},
    {"l2: {lookup_cycles: 5}", "l2.lookup_cycles", "4", "5", "l2.bank", "l2.bank"},
    {"dram: {timing: {rl: 29}}", "dram.timing.rl", "28", "29", "dram.channel", "dram.channel"},
    {"dram: {timing: {rcd: 30}}", "dram.timing.rcd", "29", "30", "dram.channel", "dram.channel"},
    {"srp: {latency: {fp_add: 3}}", "srp.latency.fp_add", "2", "3", "core.srp", "core.srp"},
    {"srp: {switch_cycles: 101}", "srp.switch_cycles", "8", "101", "core.srp", "core.srp"},
    {"interconnect: {latency: 5}", "interconnect.latency", "4", "5", "interconnect between first-level caches and L2",
     "interconnect"},
    {"dram: {fabric: 52 ns}", "dram.fabric", "50 ns", "52 ns", "path between L2 and memory", "dram.channel"}};

/// Returns changes of all latencies at full size, otherwise one of each unit.
std::vector<Latency> changed_latencies() {
  std::vector<Latency> out;
  for (const Latency& l : kLatencies) {
    if (is_full_size() || out.empty() || std::string(out.back().located) != l.located) out.push_back(l);
  }
  return out;
}

TEST(Baseline, OneMoreCycleOfLatencyFailsAndNamesTheKeyAndItsUnit) {
  BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  for (const Latency& l : changed_latencies()) {
    suite.machine(l.change);
    const ProcessResult ending = suite.baseline("check");
    EXPECT_EQ(ending.exit, 1) << l.change << ending.err;
    EXPECT_SAYS(ending.out, "totals.cycles");
    const std::string changed = fmt::format("\nChanged in {}: {} was {}, is {}\n", l.unit, l.key, l.was, l.is);
    EXPECT_SAYS(ending.out, changed);
    EXPECT_LT(ending.out.find(changed), ending.out.find("\nMoved most in "));
    EXPECT_EQ(ending.out.find("ost likely in "), std::string::npos) << "the key is known";
  }
}

TEST(Baseline, CountersNameTheUnitIfNoKeyChanged) {
  BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const std::string text = suite.values();
  for (const Latency& l : changed_latencies()) {
    // Imitates a changed model: the stored configuration now gives other values.
    suite.machine(l.change);
    suite.write_values(replaced(text, fmt::format("  {}: {}\n", l.key, l.was), fmt::format("  {}: {}\n", l.key, l.is)));
    const ProcessResult ending = suite.baseline("check");
    EXPECT_EQ(ending.exit, 1) << l.change << ending.err;
    EXPECT_SAYS(ending.out, std::string("\nMost likely in ") + l.located + ": ") << l.change;
    EXPECT_EQ(ending.out.find("Changed"), std::string::npos);
  }
}

TEST(Baseline, NamesAChangedKeyWithoutEffect) {
  BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("tni: {rau: {rows: 8}}");
  const ProcessResult ending = suite.baseline("check");
  EXPECT_EQ(ending.exit, 0);
  EXPECT_SAYS(ending.out, "Changed in tni: tni.rau.rows was 16, is 8\nNo kept value has moved.\n");
}

TEST(Baseline, NamesChangedKeysAndALargeGroupOnce) {
  BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("dram: {extends: dram/lpddr3-1600}\nl2: {lookup_cycles: 5}");
  const ProcessResult ending = suite.baseline("check");
  EXPECT_SAYS(ending.out, "\nChanged in l2.bank: l2.lookup_cycles was 4, is 5\n");
  EXPECT_SAYS(ending.out,
              "\nChanged in dram.channel: dram.timing.burst was 8, is 4, and 28 more keys of dram.timing\n");
}

TEST(Baseline, DoesNotBlameAKeyOfOneConfigurationOnly) {
  BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.write_values(replaced(replaced(suite.values(), "  l2.lookup_cycles: 4\n", "  l2.lookup_cycles: 5\n"),
                              "  dma.depth: 8\n", "  dma.of_an_older_model: 8\n"));
  suite.machine("l2: {lookup_cycles: 5}");
  const ProcessResult ending = suite.baseline("check");
  EXPECT_SAYS(ending.out, "\nMost likely in l2.bank: ");
  EXPECT_SAYS(ending.out,
              "\nKeys of only one of the two configurations:\nChanged in core.dma: dma.depth was none, is 8\n"
              "Changed in core.dma: dma.of_an_older_model was 8, is none\n");
}

TEST(Baseline, PrintsEachChangeAndItsKey) {
  BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("tni: {trv: {box_latency: 13}}");
  const ProcessResult ending = suite.baseline("check");
  EXPECT_SAYS(ending.out, "MOVED    pixel: ");
  EXPECT_SAYS(ending.out, "units.core.tni.trv.why.pipe: ");
  EXPECT_SAYS(ending.out, "\n  Changed in core.tni.trv: tni.trv.box_latency was 12, is 13\n");
  EXPECT_SAYS(ending.out, "2 of 2 runs moved");
}

TEST(Baseline, PassesWithinATolerance) {
  BaselineSuite suite("{cycles: 20 %}");
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("tni: {trv: {box_latency: 13}}");
  EXPECT_EQ(suite.baseline("check").exit, 0);
  suite.machine("tni: {trv: {box_latency: 40}}");
  const ProcessResult ending = suite.baseline("check");
  EXPECT_EQ(ending.exit, 1);
  EXPECT_SAYS(ending.out, "1 of 1 values");
  EXPECT_EQ(ending.out.find("Most likely"), std::string::npos) << "no counters of units are kept";
}

TEST(Baseline, WithReplicatesOnlyChangesBeyondNoiseFail) {
  // A machine of several cores, whose cycle count depends on when each core starts.
  BaselineSuite suite;
  const auto machine = [&](const std::string& change) {
    suite.folder().write("cores.yaml", "extends: sgrt-2016\n" + change);
  };
  machine("");
  suite.write(R"(
keep: {cycles: exact, rays: exact}
defaults: {config: cores.yaml, set: {scene.triangles: 500, cores: 2}}
runs:
  few: {resolution: 64x32}
)");
  ASSERT_EQ(suite.baseline("record", {"--replicates", "5"}).exit, 0);
  EXPECT_SAYS(suite.values(), "    replicates:\n      totals.cycles: {count: 5, mean: ");
  EXPECT_EQ(suite.baseline("check").exit, 0) << "values are those of the plain run";
  machine("l2: {lookup_cycles: 5}");
  EXPECT_EQ(suite.baseline("check").exit, 1);
  EXPECT_EQ(suite.baseline("check", {"--replicates", "5"}).exit, 0) << "a cycle is lost in the noise";
  machine("clocks: {srp: 100 MHz}");
  const ProcessResult slow = suite.baseline("check", {"--replicates", "5"});
  EXPECT_EQ(slow.exit, 1);
  EXPECT_SAYS(slow.out, "totals.cycles ");
  EXPECT_SAYS(slow.out, " noise ");
}

TEST(Baseline, WithReplicatesAStoredValueCountsAsOneDraw) {
  BaselineSuite suite("{cycles: exact, rays: exact}");
  ASSERT_EQ(suite.baseline("record").exit, 0);
  EXPECT_EQ(suite.values().find("replicates"), std::string::npos);
  EXPECT_EQ(suite.baseline("check", {"--replicates", "3"}).exit, 0);
  suite.machine("clocks: {srp: 100 MHz}");
  EXPECT_EQ(suite.baseline("check", {"--replicates", "3"}).exit, 1);
}

TEST(Baseline, TheLastMatchingToleranceApplies) {
  BaselineSuite suite(
      "{totals.rays: exact, units: exact, units.core: 100 %, units.dram: 100 %, units.l2: 100 %, "
      "units.tile_dispatcher: 100 %}");
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("tni: {trv: {box_latency: 13}}");
  EXPECT_EQ(suite.baseline("check").exit, 0) << suite.baseline("check").out;
}

TEST(Baseline, AcceptPrintsTheChangesAndStoresThem) {
  BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.machine("l2: {lookup_cycles: 5}");
  const ProcessResult accepted = suite.baseline("accept");
  EXPECT_EQ(accepted.exit, 0) << accepted.err;
  EXPECT_SAYS(accepted.out, "Changed in l2.bank: l2.lookup_cycles was 4, is 5");
  EXPECT_SAYS(accepted.out, "MOVED    square");
  EXPECT_EQ(suite.baseline("check").exit, 0);
}

TEST(Baseline, AddedAndRemovedValuesCountAsChanges) {
  BaselineSuite suite("{cycles: exact, rays.primary: exact}");
  ASSERT_EQ(suite.baseline("record").exit, 0);
  suite.write(replaced(read_bytes(suite.folder().path() / "suite.yaml"), "rays.primary", "rays.shadow"));
  const ProcessResult ending = suite.baseline("check");
  EXPECT_EQ(ending.exit, 1);
  EXPECT_SAYS(ending.out, "totals.rays.primary: was 1, is missing");
  EXPECT_SAYS(ending.out, "not stored");
}

TEST(Baseline, WritesValidJunitXml) {
  BaselineSuite suite;
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
  EXPECT_SAYS(std::string(first.child("failure").child_value()),
              "Changed in core.tni.trv: tni.trv.box_latency was 12, is 13");
  EXPECT_SAYS(std::string(first.child("failure").child_value()), "units.core.tni.trv.why.pipe: ");
  EXPECT_SAYS(std::string(second.child("error").attribute("message").value()), "it has no stored values");
  EXPECT_FALSE(third.first_child()) << "all is well";
}

TEST(Baseline, JunitXmlReplacesOnlyJunitXml) {
  const BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const auto check = [&](const fs::path& file, const Words& more = {}) {
    Words words = {"--junit", file.string()};
    words.insert(words.end(), more.begin(), more.end());
    return suite.baseline("check", words);
  };
  const fs::path own = suite.folder().path() / "own.xml", thesis = suite.folder().path() / "thesis.xml",
                 link = suite.folder().path() / "link.xml", pipe = suite.folder().path() / "pipe.xml";
  EXPECT_EQ(check(own).exit, 0);
  EXPECT_EQ(check(own).exit, 0) << "again";
  suite.folder().write("thesis.xml", "three years");
  expect_refusal(check(thesis), {"thesis.xml: is there and is no JUnit file of this verb"});
  EXPECT_EQ(read_bytes(thesis), "three years");
  fs::create_symlink(own, link);
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const Words& more : {Words{}, Words{"--force"}}) {
    expect_refusal(check(link, more), {"link.xml: is there and is a link"});
    expect_refusal(check(pipe, more), {"pipe.xml: is there and is not a regular file"});
    expect_refusal(check("/dev/null", more), {"/dev/null: is there and is not a regular file"});
    expect_refusal(check(suite.folder().path(), more), {"is a folder, not a file"});
  }
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(check(thesis, {"--force"}).exit, 0);
}

TEST(Baseline, StoredValuesReplaceOnlyStoredValues) {
  BaselineSuite suite;
  suite.write_values("three years");
  expect_refusal(suite.baseline("record"), {"is there and is no file of stored values"});
  EXPECT_EQ(suite.values(), "three years");
  EXPECT_EQ(suite.baseline("record", {"--force"}).exit, 0);
}

TEST(Baseline, ReportsAnXmlFileThatCannotBeWritten) {
  const BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const ProcessResult ending =
      suite.baseline("check", {"--junit", (suite.folder().path() / "none" / "junit.xml").string()});
  EXPECT_EQ(ending.exit, 2) << "before anything is computed";
  EXPECT_SAYS(ending.err, "junit.xml: cannot be written: there is no folder");
}

// Tests of suites and stored values that cannot be used or compared.

/// Expects exit code 2 and one line of error that follows the lines on the runs.
void expect_not_comparable(const ProcessResult& ending, const Words& parts) {
  EXPECT_EQ(ending.exit, 2) << ending.out;
  for (const std::string& part : parts) EXPECT_SAYS(ending.err, part);
  EXPECT_SAYS(ending.out, "REFUSED");
  EXPECT_EQ(ending.out.find("MOVED"), std::string::npos) << ending.out;
}

TEST(Baseline, RefusesAnotherTree) {
  BaselineSuite suite;
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

TEST(Baseline, AcceptsAnotherEmbreeIfItsTreesAreEqual) {
  const BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  std::string text = suite.values();
  const std::size_t at = text.find("embree: ") + 8;
  text.replace(at, text.find('\n', at) - at, "2.17.7");
  suite.write_values(text);
  EXPECT_EQ(suite.baseline("check").exit, 0);
  suite.write_values(text.replace(text.find("bvh_hash: ") + 10, 6, "abcdef"));
  expect_not_comparable(suite.baseline("check"), {"another tree", "stored with Embree 2.17.7, this program has "});
}

TEST(Baseline, RefusesControlCharacters) {
  const BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const std::string text = suite.values();
  for (const char* from : {"embree: ", "program: ", "bvh_hash: "}) {
    std::string changed = text;
    const std::size_t at = text.find(from) + std::string_view(from).size();
    suite.write_values(changed.replace(at, text.find('\n', at) - at, "\"a\\e[31m\""));
    const ProcessResult ending = suite.baseline("check");
    EXPECT_EQ(ending.exit, 2);
    EXPECT_SAYS(ending.err, "holds text that is not printable");
    EXPECT_EQ((ending.out + ending.err).find('\x1b'), std::string::npos);
  }
}

TEST(Baseline, RefusesOtherWork) {
  BaselineSuite suite;
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

TEST(Baseline, RefusesOtherRuns) {
  BaselineSuite suite;
  ASSERT_EQ(suite.baseline("record").exit, 0);
  const std::string text = suite.values();
  suite.write_values(replaced(text, "  square:", "  round:"));
  expect_refusal(suite.baseline("check"), {"'round'", "no longer in the suite"});
  suite.write_values(text.substr(0, text.find("  square:")));
  expect_not_comparable(suite.baseline("check"), {"it has no stored values"});
  EXPECT_EQ(suite.baseline("accept").exit, 0);
  EXPECT_EQ(suite.values(), text);
}

TEST(Baseline, RefusesABrokenSuiteWithItsLine) {
  BaselineSuite suite;
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

TEST(Baseline, RefusesBadValuesThatOnlyARunFinds) {
  BaselineSuite suite;
  const std::string runs = "\nruns: {a: {resolution: 1x1, set: {scene.triangles: 500}}}\n";
  suite.write("keep: {cycels: exact}" + runs);
  const ProcessResult unknown = suite.baseline("record");
  EXPECT_EQ(unknown.exit, 2);
  EXPECT_SAYS(unknown.err, "suite.yaml:1:8: keep: there is no report path 'cycels', did you mean 'cycles'?");
  EXPECT_EQ(unknown.out, "") << "before the first run";
  suite.write("keep: {nominal: exact}" + runs);
  EXPECT_SAYS(suite.baseline("record").err, "may mean any of");
  suite.write("keep: {cycles: exact}\nruns: {a: {scene: nowhere.glb}}\n");
  const ProcessResult scene = suite.baseline("record");
  EXPECT_EQ(scene.exit, 2);
  EXPECT_SAYS(scene.err, "runs.a: ");
  EXPECT_SAYS(scene.err, "nowhere.glb");
  EXPECT_EQ(names_in(suite.folder().path()), (Words{"machine.yaml", "serial.yaml", "suite.yaml"}));
}

TEST(Baseline, RefusesBrokenStoredValues) {
  const BaselineSuite suite;
  const std::string begin = "schema: raywatt-baseline/1\n";
  for (const auto& [text, part] : std::vector<std::pair<std::string, std::string>>{
           {"", "empty"},
           {"schema: raywatt-report/1\nruns: {}\n", "schema"},
           {begin, "runs"},
           {begin + "runs: 5\n", "mapping"},
           {begin + "runs: {a: {values: {totals: {cycles: many}}}}\n", "must be a number"},
           {begin + "runs: {a: {values: {totals: 5}}}\n", "mapping"},
           {begin + "runs: {a: {program: {}}}\n", "plain value"},
           {begin + "runs: {a: {}}\n", "no longer in the suite"},
       }) {
    suite.write_values(text);
    expect_refusal(suite.baseline("check"), {"suite.baseline.yaml", part});
  }
}

}  // namespace
}  // namespace test
