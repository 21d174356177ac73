#include <filesystem>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/studies/baseline/baseline_suite.h"

// Tests of suites and stored values that cannot be used or compared.

namespace test {
namespace {

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
