#include <fstream>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/full_size.h"
#include "tests/tools/program.h"

// Tests that measurements of `raywatt microbench` equal their formulas, and that some formulas equal hand-computed
// values.

namespace test {
namespace {

using Json = nlohmann::json;

const std::map<std::string, Words> kMachines = {
    {"the default", {}},
    {"clocks that do not divide each other",
     {"--set", "clocks.l2=800 MHz", "--set", "clocks.tni=333 MHz", "--set", "clocks.synchroniser=3", "--set",
      "interconnect.latency=7", "--set", "dram.extends=dram/lpddr5-6400"}},
    {"narrow and small",
     {"--set", "cores=1", "--set", "dram.extends=dram/lpddr3-1600", "--set", "dram.channels=1", "--set",
      "interconnect.width=8", "--set", "l2.banks=1", "--set", "l2.hit_cycles=1", "--set", "l2.lookup_cycles=1", "--set",
      "clocks.synchroniser=0"}},
    {"little room", {"--set", "tni.trv.rays=4",
                     "--set", "tni.ist.leaves=2",
                     "--set", "tni.miss_handling=rau",
                     "--set", "direct_interface.interval=1",
                     "--set", "direct_interface.depth=1",
                     "--set", "tni.link_depth=1",
                     "--set", "interconnect.link_depth=1",
                     "--set", "l2.mshrs=4",
                     "--set", "bvh.triangle_bytes=36",
                     "--set", "srp.array.local_ports=8",
                     "--set", "dram.controller.mapping=row_bank_channel_column"}},
};

Json measured(const std::string& benchmark, const Words& more = {}) {
  Words words = {"microbench", benchmark, "--json"};
  words.insert(words.end(), more.begin(), more.end());
  const ProcessResult ending = raywatt(words);
  EXPECT_EQ(ending.exit, 0) << ending.err << ending.out;
  return Json::parse(ending.out);
}

double value_of(const Json& all, const std::string& figure) {
  for (const Json& f : all["figures"]) {
    if (f["name"] == figure) return f["measured"];
  }
  ADD_FAILURE() << "no figure is called " << figure;
  return 0;
}

class Microbench : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, Microbench,
                         testing::Values("chase", "bandwidth", "mshr", "rays", "early_exit", "tile_buffer", "kernels"),
                         [](const auto& benchmark) { return std::string(benchmark.param); });

TEST_P(Microbench, EqualsItsClosedFormsOnEveryMachine) {
  const std::map<std::string, std::pair<double, double>> least_and_most = {{"exactly", {-1e-9, 1e-9}},
                                                                           {"within 2 %", {-0.02, 0.02}},
                                                                           {"an upper bound", {-0.75, 0.02}},
                                                                           {"a lower bound", {0, 9}}};
  for (const auto& [name, sets] : kMachines) {
    // The longest benchmark runs on one machine, except at full size.
    if (GetParam() == std::string_view("tile_buffer") && name != "the default" && !is_full_size()) continue;
    const Json all = measured(GetParam(), sets);
    EXPECT_EQ(all["schema"], "raywatt-microbench/1");
    EXPECT_EQ(all["benchmark"], GetParam());
    EXPECT_FALSE(all["figures"].empty());
    EXPECT_TRUE(all["good"]);
    for (const Json& f : all["figures"]) {
      const std::string what = name + ": " + f["name"].get<std::string>();
      const double error = f["relative_error"];
      EXPECT_LE(error, least_and_most.at(f["holds"]).second) << what;
      EXPECT_GE(error, least_and_most.at(f["holds"]).first) << what;
    }
  }
}

// L2 cycles of 2 ns: wire 1, distance 4, bank 12, distance 4, wire 1; then the L1's 2 again.
// DRAM: 1 + 4 + 4 cycles and the wire to the channel are 20 ns, two of its cycles later 21.25; 47, 76 or 105 of them
// for the line, 80 for the fabric; a wire and two L2 cycles, up to the next edge; bank 1, distance 4, wire 1, L1 2.
TEST(MicrobenchChase, AddsUpThePathToEachLevel) {
  const Json all = measured("chase", {"--set", "dram.channels=2"});
  EXPECT_DOUBLE_EQ(value_of(all, "L1 hit"), 2 * 2);
  EXPECT_DOUBLE_EQ(value_of(all, "L2 hit"), 2 * (22 + 2));
  EXPECT_NEAR(value_of(all, "DRAM, row open"), 21.25 + 0.625 * (47 + 80 + 1) + 4 + 16, 2);
  EXPECT_NEAR(value_of(all, "DRAM, bank closed"), 21.25 + 0.625 * (76 + 80 + 1) + 4 + 16, 2);
  EXPECT_NEAR(value_of(all, "DRAM, other row open"), 21.25 + 0.625 * (105 + 80 + 1) + 4 + 16, 2);
}

TEST(MicrobenchBandwidth, ReachesANarrowPort) {
  // A line in 8 cycles of 2 ns.
  const Json all = measured("bandwidth", {"--set", "cores=1", "--set", "interconnect.width=8"});
  EXPECT_NEAR(value_of(all, "LPDDR4-3200, stream"), 4, 0.08);
  EXPECT_EQ(all["figures"][0]["remark"], "core ports");
}

TEST(MicrobenchBandwidth, NearlyReachesTheStreamOfOneChannel) {
  const Json all = measured("bandwidth", {"--set", "dram.channels=1"});
  EXPECT_GT(value_of(all, "LPDDR4-3200, stream"), 0.9 * 6.4);
  EXPECT_LT(value_of(all, "LPDDR4-3200, stream"), 6.4);
  EXPECT_EQ(all["figures"][0]["remark"], "DRAM");
}

TEST(MicrobenchBandwidth, HasTwoRowsForEachGrade) {
  const Json all = measured("bandwidth", {"--all-grades", "--set", "dram.channels=1"});
  ASSERT_EQ(all["figures"].size(), 14U);
  EXPECT_EQ(all["figures"][0]["name"], "LPDDR3-1600, stream");
  EXPECT_EQ(all["figures"][13]["name"], "LPDDR6-10667, random");
}

TEST(MicrobenchBandwidth, FindsGradesInAllFoldersOfRaywattPath) {
  const TempFolder folder;
  std::filesystem::create_directories(folder.path() / "dram");
  folder.write("dram/mine.yaml", "extends: lpddr5-6400\ngrade: mine\n");
  const ProcessResult ending =
      raywatt({"microbench", "bandwidth", "--json", "--all-grades", "--set", "dram.channels=1"},
              {.variables = {{"RAYWATT_PATH", folder.path().string()}}});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const Json all = Json::parse(ending.out);
  ASSERT_EQ(all["figures"].size(), 16U);
  EXPECT_EQ(all["figures"][14]["name"], "mine, stream");
}

TEST(MicrobenchMshr, GivesALineForEachRegisterAndLatencyUntilThePortIsFull) {
  const Json all = measured("mshr");
  EXPECT_NEAR(value_of(all, "1 miss register, lines in the L2"), 1e3 / 44, 0.01);
  EXPECT_NEAR(value_of(all, "4 miss registers, lines in the L2"), 4e3 / 44, 0.5);
  EXPECT_NEAR(value_of(all, "32 miss registers, lines in the L2"), 250, 0.1) << "a line in two cycles of 2 ns";
}

// A request slot is occupied for a cycle of the client, three of the L2 to cross, and one until the pop is seen: 2 + 4
// x 1.25 ns, up to the next edge 8 ns, for two slots.
TEST(MicrobenchMshr, FindsTheWireThatAClockCrossingFills) {
  const Json all = measured("mshr", {"--set", "clocks.l2=800 MHz", "--set", "clocks.synchroniser=3"});
  EXPECT_NEAR(value_of(all, "64 miss registers, lines in the L2"), 2e3 / 8, 1);
  EXPECT_EQ(all["figures"][6]["remark"], "request wire");
}

TEST(MicrobenchRays, CountsPassesThroughThePipesOfAllTraversalUnits) {
  const Json all = measured("rays");
  EXPECT_NEAR(value_of(all, "1 TRV, 2 box testers, 16 nodes and 2 triangles"), 1. / 16, 0.001);
  EXPECT_NEAR(value_of(all, "1 TRV, 1 box tester, 16 nodes and 2 triangles"), 1. / (2 * 16 + 2), 0.001);
  EXPECT_NEAR(value_of(all, "8 TRVs, 2 box testers, 16 nodes and 2 triangles"), 1. / 3, 0.005) << "three lines a leaf";
  EXPECT_NEAR(value_of(all, "8 TRVs, 2 box testers, 4 nodes"), 1. / 2, 0.005) << "the interface's interval";
}

TEST(MicrobenchEarlyExit, StopsTimeAndEnergyAtThePhaseThatFails) {
  const Json all = measured("early_exit");
  EXPECT_DOUBLE_EQ(value_of(all, "a lone test, exit: distance"), 2 + 8);
  EXPECT_DOUBLE_EQ(value_of(all, "a lone test, exit: barycentric"), 2 + 16);
  EXPECT_DOUBLE_EQ(value_of(all, "a lone test, exit: hit"), 2 + 22);
  const double distance = value_of(all, "energy of a test, exit: distance");
  EXPECT_NEAR(value_of(all, "energy of a test, exit: barycentric") - distance, 31.5, 1e-6);
  EXPECT_NEAR(value_of(all, "energy of a test, exit: hit") - distance, 31.5 + 18, 1e-6);
}

TEST(MicrobenchEarlyExit, CountsTheExitsOfAScene) {
  const Json all = measured("early_exit", {"--scene", "teapot", "--resolution", "32x16"});
  EXPECT_GT(value_of(all, "teapot, 32x16, exit: distance"), 0);
  EXPECT_GT(value_of(all, "teapot, 32x16, exit: barycentric"), 0);
  EXPECT_GT(value_of(all, "teapot, 32x16, exit: hit"), 0);
  expect_refusal(raywatt({"microbench", "early_exit", "--scene", "teapt"}), {"teapt", "teapot"});
}

TEST(MicrobenchTileBuffer, LosesACycleForEachFurtherAccessOfABank) {
  const Json all = measured("tile_buffer");
  EXPECT_EQ(value_of(all, "stride 16 B, 1 bank"), 2) << "three accesses in a cycle";
  EXPECT_EQ(value_of(all, "stride 64 B, 1 bank"), 12 - 3) << "twelve in three cycles";
  EXPECT_EQ(value_of(all, "stride 64 B, 64 banks"), 0);
  EXPECT_GT(value_of(all, "all kernels, 1 bank"), value_of(all, "all kernels, 16 banks"));
}

TEST(MicrobenchKernels, NeedLessTimeOnALargerArrayUntilPortsOrRecurrencesBindThem) {
  const Json all = measured("kernels");
  EXPECT_GT(all["figures"].size(), 300U);
  for (std::size_t i = 0; i + 1 < all["figures"].size(); ++i) {
    const bool last_size = i % 5 == 4;
    EXPECT_TRUE(last_size || all["figures"][i]["measured"] >= all["figures"][i + 1]["measured"]) << all["figures"][i];
  }
  EXPECT_EQ(measured("kernels", {"--kernel", "sum_subpixels"})["figures"][4]["remark"], "recurrence");
}

TEST(MicrobenchKernels, AreTheNamedKernels) {
  EXPECT_EQ(measured("kernels", {"--kernel", "shade_diffuse", "--kernel", "absorb"})["figures"].size(), 10U);
  expect_refusal(raywatt({"microbench", "kernels", "--kernel", "shade_difuse"}), {"shade_difuse", "shade_diffuse"});
}

TEST(MicrobenchVerb, ListsWhatEachMeasures) {
  const ProcessResult list = raywatt({"microbench", "list"});
  EXPECT_EQ(list.exit, 0);
  const ProcessResult help = raywatt({"microbench", "--help"});
  for (const char* name : {"chase", "bandwidth", "mshr", "dram", "rays", "early_exit", "tile_buffer", "kernels"}) {
    EXPECT_SAYS(list.out, name);
    EXPECT_SAYS(help.out, name);
  }
}

TEST(MicrobenchVerb, PrintsATableWithTheMarginOfEachMeasurement) {
  const ProcessResult ending = raywatt({"microbench", "mshr"});
  EXPECT_EQ(ending.exit, 0);
  for (const char* part : {"closed form", "within 2 %", "core ports", "difference"}) EXPECT_SAYS(ending.out, part);
}

// Refreshes take more than half of the time of each bank, so that a stream cannot reach 90 % of the bus.
TEST(MicrobenchVerb, EndsWithOneIfAMeasurementMissesItsClosedForm) {
  const ProcessResult ending = raywatt({"microbench", "dram", "--set", "dram.timing.refi_pb=60"});
  EXPECT_EQ(ending.exit, 1);
  EXPECT_SAYS(ending.out, "MISSED");
  EXPECT_SAYS(ending.err, "differ from their closed forms");
}

TEST(MicrobenchVerb, MeasuresRealResourcesEvenIfTheConfigurationMakesThemIdeal) {
  EXPECT_EQ(measured("chase", {"--set", "ideal.dram=true"}), measured("chase"));
}

// Tests of the command `raywatt microbench`.

/// A stream file in a temporary folder.
class Stream {
 public:
  explicit Stream(const std::string& text) { std::ofstream(path()) << text; }
  std::string path() const { return (folder_.path() / "stream.txt").string(); }

 private:
  TempFolder folder_;
};

nlohmann::json played(const std::string& text, const Words& more = {}) {
  const Stream stream(text);
  Words words = {"microbench", "dram", "--stream", stream.path(), "--json"};
  words.insert(words.end(), more.begin(), more.end());
  const ProcessResult ending = raywatt(words);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return nlohmann::json::parse(ending.out);
}

TEST(MicrobenchDram, ComparesEveryGradeWithItsClosedForms) {
  for (const char* grade : {"lpddr3-1600", "lpddr4-3200", "lpddr4-4266", "lpddr4x-4266", "lpddr5-6400"}) {
    const ProcessResult ending =
        raywatt({"microbench", "dram", "--set", std::string("dram.extends=dram/") + grade, "--json"});
    ASSERT_EQ(ending.exit, 0) << ending.err;
    const nlohmann::json figures = nlohmann::json::parse(ending.out)["figures"];
    EXPECT_GE(figures.size(), 17U);
    for (const nlohmann::json& figure : figures) EXPECT_TRUE(figure["good"]) << grade << ": " << figure["name"];
  }
}

// Expected values are derived in docs/design/energy.md for one die. Idle: precharge standby, and a refresh of 2905 pJ
// every 488.75 ns.
TEST(MicrobenchDram, RefusesAGradeAndAStreamWithAllGrades) {
  for (const char* benchmark : {"dram", "bandwidth"}) {
    expect_refusal(raywatt({"microbench", benchmark, "--all-grades", "--set", "dram.extends=dram/lpddr5-6400"}),
                   {"--all-grades and --set dram.extends=dram/lpddr5-6400"});
  }
  expect_refusal(raywatt({"microbench", "dram", "--all-grades", "--stream", "nothere"}),
                 {"--all-grades and --stream exclude each other"});
}

TEST(MicrobenchDram, ComparesTheEnergyOfAllGrades) {
  const ProcessResult ending = raywatt({"microbench", "dram", "--all-grades", "--json"});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json figures = nlohmann::json::parse(ending.out)["figures"];
  ASSERT_EQ(figures.size(), 7U * 4U);
  EXPECT_EQ(figures[0]["name"], "LPDDR3-1600, energy, sequential reads");
  EXPECT_EQ(figures[18]["name"], "LPDDR5-6400, energy, idle");
  EXPECT_NEAR(figures[18]["measured"], 10.67 + 2905 / 488.75, 0.01);
  EXPECT_EQ(figures[18]["unit"], "mW");
  for (const nlohmann::json& figure : figures) EXPECT_TRUE(figure["good"]) << figure["name"];
}

TEST(MicrobenchDram, PrintsATable) {
  const ProcessResult ending = raywatt({"microbench", "dram"});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  for (const char* part : {"LPDDR4-3200", "closed form", "read, row open", "29.375", "exactly"}) {
    EXPECT_SAYS(ending.out, part);
  }
  EXPECT_EQ(ending.out.find("MISSED"), std::string::npos);
}

// Timing in cycles of 0.625 ns: tRCD 29, RL 28, tDQSCK 3, two bursts of 8, tRP 29; WL 14 and tDQSS 1.
TEST(MicrobenchDram, PrintsWhenEachRequestOfAFileEnds) {
  const nlohmann::json j = played(
      "# a closed bank, its row, another row\n"
      "\n"
      "0x40 R\n"
      "80 R 1000   # without 0x\n"
      "0x10000000 R 2000\r\n"
      "\t0x10000040 W 3000.3125",
      {"--refresh", "off"});
  const auto done = j["completion_ns"].get<std::vector<double>>();
  ASSERT_EQ(done.size(), 4U);
  EXPECT_DOUBLE_EQ(done[0], 0.625 * 76);
  EXPECT_DOUBLE_EQ(done[1], 1000 + 0.625 * 47);
  EXPECT_DOUBLE_EQ(done[2], 2000 + 0.625 * (29 + 76));
  EXPECT_DOUBLE_EQ(done[3], 3000.625 + 0.625 * 31) << "from the next edge of the clock";
  EXPECT_EQ(j["requests"], 4);
  EXPECT_EQ(j["row_hits"], 2);
  EXPECT_EQ(j["row_misses"], 1);
  EXPECT_EQ(j["row_conflicts"], 1);
  EXPECT_DOUBLE_EQ(j["row_hit_rate"], 0.5);
  EXPECT_DOUBLE_EQ(j["time_ns"], done[3]);
  EXPECT_DOUBLE_EQ(j["bandwidth_gbps"], 256 / done[3]);
  EXPECT_DOUBLE_EQ(j["peak_gbps"], 6.4);
  EXPECT_DOUBLE_EQ(j["latency_ns"]["min"], 0.625 * 31);
  EXPECT_DOUBLE_EQ(j["latency_ns"]["p50"], 0.625 * 47);
  EXPECT_DOUBLE_EQ(j["latency_ns"]["max"], 0.625 * 105);
  EXPECT_DOUBLE_EQ(j["write_latency_ns"]["mean"], 0.625 * 31);
  std::uint64_t cycles = 0;
  for (const auto& [reason, spent] : j["why"].items()) cycles += spent.get<std::uint64_t>();
  EXPECT_DOUBLE_EQ(static_cast<double>(cycles) * 0.625, done[3]) << "every cycle has a reason";
}

TEST(MicrobenchDram, CountsTheEnergyOfItsRequests) {
  const nlohmann::json j = played("0 R\n", {"--refresh", "off"});
  const double standby = 18.62 * 47.5;  // mW x ns: the row is open from the start
  const double pj = 616.9 + 2 * (551.3 + 412.2 + 512) + standby;
  EXPECT_NEAR(j["energy_pj_per_bit"]["nominal"].get<double>(), pj / 512, 1e-9);
}

TEST(MicrobenchDram, LimitsRequestsInFlight) {
  const std::string two_banks = "0x0 R\n0x800 R\n";
  const auto apart = [&](const char* outstanding) {
    const auto done = played(two_banks, {"--outstanding", outstanding, "--set", "dram.channels=1"})["completion_ns"];
    return done[1].get<double>() - done[0].get<double>();
  };
  EXPECT_DOUBLE_EQ(apart("1"), 0.625 * 76) << "one after the other";
  EXPECT_DOUBLE_EQ(apart("2"), 0.625 * 16) << "side by side but for the bus";
}

TEST(MicrobenchDram, SendsAllRequestsToOneChannel) {
  const std::string lines = "0x0 R\n0x40 R\n0x80 R\n0x800 R\n";
  EXPECT_EQ(played(lines, {"--set", "dram.channels=1"})["completion_ns"],
            played(lines, {"--set", "dram.channels=4"})["completion_ns"]);
}

TEST(MicrobenchDram, HasNoRefreshesIfDisabled) {
  const std::string late = "0 R\n0 R 1e6\n";
  EXPECT_EQ(played(late)["counters"]["refreshes"], 1'600'000 / 780);
  EXPECT_EQ(played(late, {"--refresh", "off"})["counters"]["refreshes"], 0);
}

TEST(MicrobenchDram, RefusesABrokenRequestWithItsLine) {
  const auto refusal = [](const std::string& text, const Words& parts) {
    const Stream stream("0 R\n\n" + text + "\n");
    Words expected = {stream.path() + ":3: ", "R or W"};
    expected.insert(expected.end(), parts.begin(), parts.end());
    expect_refusal(raywatt({"microbench", "dram", "--stream", stream.path()}), expected);
  };
  refusal("4g R", {"'4g'", "hexadecimal"});
  refusal("0x R", {"'0x'", "hexadecimal"});
  refusal("-4 R", {"'-4'", "hexadecimal"});
  refusal("12345678901234567 R", {"64 bits"});
  refusal("40", {"'40'", "neither R nor W"});
  refusal("40 X", {"'X'", "neither R nor W"});
  refusal("40 R soon", {"'soon'", "ns"});
  refusal("40 R -1", {"'-1'", "ns"});
  refusal("40 R nan", {"'nan'", "ns"});
  refusal("40 R 1e10", {"'1e10'", "1e9"});
  refusal("40 R 1 2", {"'2'", "too many"});
  refusal(std::string("\x1b[31m R"), {"hexadecimal"});
}

TEST(MicrobenchDram, RefusesFilesWithoutRequestsAndNumbersOutOfRange) {
  const Stream empty("# nothing\n\n");
  expect_refusal(raywatt({"microbench", "dram", "--stream", empty.path()}), {empty.path(), "no requests"});
  expect_refusal(raywatt({"microbench", "dram", "--stream", empty.path() + "x"}), {"no such file"});
  expect_refusal(raywatt({"microbench", "dram", "--outstanding", "0"}), {"--outstanding", "65536"});
  expect_refusal(raywatt({"microbench", "dram", "--refresh", "maybe"}), {"--refresh", "on", "off"});
  expect_refusal(raywatt({"microbench", "dramm"}), {"dramm", "did you mean 'dram'"});
  expect_refusal(raywatt({"microbench", "dram", "--set", "dram.timing.refi_pb=1"}), {"dram.timing", "refresh"});
}

}  // namespace
}  // namespace test
