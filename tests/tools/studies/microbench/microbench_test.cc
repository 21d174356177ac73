#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

// Tests of the command `raywatt microbench`.

namespace test {
namespace {

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
