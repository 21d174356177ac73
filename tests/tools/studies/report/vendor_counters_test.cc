#include "tools/studies/report/vendor_counters.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tools/program.h"

// Tests of `raywatt report --counters`: formulas, identities between counters of a run, and files.

namespace test {
namespace {

using tools::ReportFile;
using tools::pages::vendor_counters;
using tools::pages::vendor_value;
using tools::pages::VendorCounter;

using Values = std::map<std::string, double>;

Values values_of(std::string_view gpu, const ReportFile& report) {
  Values out;
  for (const VendorCounter& counter : vendor_counters(gpu)) {
    if (const auto value = vendor_value(counter, report)) out[std::string(counter.name)] = *value;
  }
  return out;
}

/// Test inputs, made once: small runs on five kinds of machine.
class VendorCounters : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new TempFolder;
    make_run("base", {});
    make_run("wide", {"--set", "bvh.width=4", "--set", "bvh.format=q8"});
    make_run("rau", {"--set", "tni.miss_handling=rau", "--set", "cores=1", "--set", "tni.trvs=1"});
    make_run("prefetch", {"--set", "tni.trv.prefetch=sibling", "--set", "tni.trv.l1.size=1 KiB"});
    make_run("gather", {"--set", "tni.trv.gather=node", "--set", "tni.trv.l1.size=1 KiB"});
  }
  static void TearDownTestSuite() {
    delete folder;
    folder = nullptr;
  }
  static void make_run(const std::string& name, const Words& more) {
    Words words = {"run",   "--quiet", "--threads",           "1",  "--resolution",
                   "32x16", "--set",   "scene.triangles=500", "-o", name};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(raywatt(words, {.folder = folder->path()}).exit, 0) << name;
  }
  static ReportFile report_of(const std::string& run) { return tools::load_report(folder->path() / run); }
  static TempFolder* folder;
};
TempFolder* VendorCounters::folder = nullptr;

TEST_F(VendorCounters, OfRunsObeyTheIdentitiesOfTheUnit) {
  for (const char* run : {"base", "wide", "rau", "prefetch", "gather"}) {
    SCOPED_TRACE(run);
    const ReportFile report = report_of(run);
    const auto of = [&](const char* unit, const char* name) {
      return report.number(fmt::format("units.core.{}.counters.{}", unit, name));
    };
    const Values g1 = values_of("mali_g1", report), g715 = values_of("mali_g715", report),
                 adreno = values_of("adreno7xx", report);

    EXPECT_EQ(g1.at("RT_RAYS_STARTED"), report.number("totals.rays.total"));
    EXPECT_GT(g1.at("RT_MISS"), 0);
    EXPECT_EQ(g1.at("RT_TRI_ISSUE_COUNT"), g1.at("RT_OPAQUE_HIT + RT_NON_OPAQUE_HIT") + g1.at("RT_MISS"));
    EXPECT_EQ(g1.at("RT_TRI_ISSUE_COUNT"), adreno.at("SP_RTU_RAY_TRIANGLE_INTERSECTIONS"));
    EXPECT_EQ(g1.at("RT_BOX_ISSUE_COUNT"), g715.at("RT_RAY_BOX"));
    EXPECT_EQ(g1.at("RT_BOX_ISSUE_COUNT"), adreno.at("SP_RTU_RAY_BOX_INTERSECTIONS"));
    if (run != std::string("wide")) {
      EXPECT_EQ(g1.at("RT_BOX_ISSUE_COUNT"), 2 * of("tni.trv", "visits"));
    }
    EXPECT_GE(g1.at("RT_BOX_ISSUE_COUNT"), 2 * of("tni.trv", "visits")) << "an inner node has two children or more";
    EXPECT_EQ(adreno.at("SP_RAY_QUERY_INSTRUCTIONS"), of("tni.trv", "visits") + g715.at("RT_RAY_TRI"));

    const double lines =
        of("tni.trv", "l1_hits") + of("tni.trv", "rau_reads") + of("tni.ist", "l1_hits") + of("tni.ist", "rau_reads");
    EXPECT_GT(g1.at("RT_CACHE_READ_MISS"), 0);
    EXPECT_GE(g1.at("RT_CACHE_READ_HIT"), 0);
    EXPECT_GE(of("tni.trv", "l1_hits") + of("tni.trv", "rau_reads"), of("tni.trv", "l1_late"));
    EXPECT_EQ(g1.at("RT_CACHE_READ_HIT") + g1.at("RT_CACHE_READ_MISS"), lines);
    EXPECT_EQ(adreno.at("SP_RTU_L0_HITS") + adreno.at("SP_RTU_L0_MISSES") + adreno.at("SP_RTU_L0_HIT_ON_MISS"), lines);
    EXPECT_EQ(g1.at("BEATS_RD_RTU"), 4 * adreno.at("SP_RTU_BVH_FETCH_LATENCY_SAMPLES"));
    EXPECT_GE(adreno.at("SP_RTU_BVH_FETCH_LATENCY_CYCLES"), adreno.at("SP_RTU_BVH_FETCH_LATENCY_SAMPLES"));

    EXPECT_EQ(g1.at("MaliRTUIssueCy"), std::max(g1.at("RT_BOX_ISSUE_CYCLES"), g1.at("RT_TRI_ISSUE_CYCLES")));
    EXPECT_GE(g1.at("RT_ACTIVE") * report.number("units.core.tni.trv.units"), g1.at("RT_BOX_ISSUE_CYCLES"));
    EXPECT_GT(g1.at("MaliRTUUtil"), 0);
    EXPECT_LE(g1.at("MaliRTUUtil"), 100);
  }
}

TEST_F(VendorCounters, CountContinuedRaysOfTheReport) {
  ReportFile report = report_of("base");
  report.numbers["totals.rays.continued"] = 17;
  EXPECT_EQ(values_of("mali_g1", report).at("RT_TRACE_RESUME"), 17);
}

TEST_F(VendorCounters, EvaluateFormulasAsWritten) {
  ReportFile report;
  report.numbers = {
      {"units.core.tni.trv.counters.visits", 7}, {"units.core.tni.ist.why.testing", 3}, {"units.core.srp.elapsed", 8}};
  const auto value = [&](std::string_view formula) { return vendor_value({"X", 1, "rays", formula}, report); };
  EXPECT_EQ(value("trv.visits - ist.why.testing + 2"), 6);
  EXPECT_EQ(value("2 * (trv.visits - ist.why.testing) / srp.elapsed"), 1);
  EXPECT_EQ(value("max(0, ist.why.testing - trv.visits)"), 0);
  EXPECT_EQ(value("trv.visits / (ist.why.testing - 3)"), 0) << "a ratio of nothing";
  EXPECT_EQ(value("no counterpart: of the test"), std::nullopt);
  EXPECT_THROW(value("trv.leaves"), std::exception);
}

TEST_F(VendorCounters, HaveOneNameEachAndAFormulaOrAReason) {
  for (const std::string_view gpu : tools::pages::kVendorGpus) {
    std::set<std::string_view> names;
    std::set<int> ids;
    for (const VendorCounter& counter : vendor_counters(gpu)) {
      EXPECT_TRUE(names.insert(counter.name).second) << counter.name;
      EXPECT_TRUE(counter.id == 0 || ids.insert(counter.id).second) << counter.name;
      EXPECT_FALSE(counter.unit.empty() || counter.source.empty()) << counter.name;
    }
    EXPECT_GE(names.size(), 20U);
  }
}

TEST_F(VendorCounters, AreATableAndAFileOfTheSameRows) {
  const ProcessResult shown =
      raywatt({"report", "base", "--counters", "mali_g1", "-o", "g1.csv"}, {.folder = folder->path()});
  ASSERT_EQ(shown.exit, 0) << shown.err;
  EXPECT_SAYS(shown.out, "no counterpart: ");
  const std::string csv = read_bytes(folder->path() / "g1.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "counter,id,value,unit,formula");
  const double rays = report_of("base").number("totals.rays.total");
  EXPECT_SAYS(csv, fmt::format("\nRT_RAYS_STARTED,312,{:.0f},rays,dispatcher.rays_in\n", rays));
  for (const VendorCounter& counter : vendor_counters("mali_g1")) {
    EXPECT_SAYS(shown.out, std::string(counter.name));
    EXPECT_SAYS(csv, fmt::format("\n{},", counter.name));
  }
}

TEST_F(VendorCounters, RefuseOtherInputsAndFiles) {
  folder->write("mine.csv", "a,b\n");
  const auto refused = [&](const Words& words) { return raywatt(words, {.folder = folder->path()}); };
  expect_refusal(refused({"report", "base", "rau", "--counters", "mali_g1"}), {"2 folders", "allowed"});
  expect_refusal(refused({"report", "nowhere", "--counters", "mali_g1"}), {"nowhere"});
  expect_refusal(refused({"report", "base", "--counters", "mali_g1", "-o", "mine.csv"}), {"mine.csv"});
  EXPECT_EQ(read_bytes(folder->path() / "mine.csv"), "a,b\n");
  EXPECT_NE(refused({"report", "base", "--counters", "radeon"}).exit, 0);
  EXPECT_NE(refused({"report", "base"}).exit, 0) << "a page needs a file";
}

}  // namespace
}  // namespace test
