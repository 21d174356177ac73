#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

// Tests of an interrupted `raywatt reproduce`: its results, and how it continues.

namespace test {
namespace {

namespace fs = std::filesystem;

Words small_hybrid(const fs::path& out, const Words& more = {}) {
  Words words = {"reproduce", "hybrid", "--quick", "--shrink", "8", "--threads", "1", "-o", out.string()};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Tests that interrupt small experiments after their start.
ProcessResult begun(const fs::path& out) {
  Program program({"reproduce", "hybrid", "--threads", "1", "-o", out.string()});
  EXPECT_TRUE(program.wait_for_complaint());
  program.send(SIGINT);
  return program.wait();
}

class GoOn : public testing::Test {
 protected:
  /// Writes partial results, as an interrupt before the last rows would leave them.
  void interrupt_late() {
    ASSERT_EQ(raywatt(small_hybrid(out)).exit, 0);
    whole = results();
    nlohmann::ordered_json part = whole;
    part["partial"] = true;
    for (int i = 0; i < 3; ++i) part["rows"].erase(part["rows"].size() - 1);
    part["rows"][0]["measured"] = 77;  // values that no run measures
    std::ofstream(out / "reproduce.json") << part.dump(2);
  }
  /// Starts or continues a run, and sends it a signal after the first rows are written.
  ProcessResult lee2016_until(int signal) const {
    const bool is_anew = !fs::exists(out);
    const auto before = is_anew ? fs::file_time_type::min() : fs::last_write_time(out / "reproduce.json");
    Program program({"reproduce", "lee2016", "--quick", "--threads", "1", "-o", out.string()});
    EXPECT_TRUE(program.wait_until([&](const std::string&) {
      std::error_code absent;
      return fs::last_write_time(out / "reproduce.json", absent) > before && !absent;
    }));
    program.send(signal);
    return program.wait();
  }
  nlohmann::ordered_json results() const { return nlohmann::ordered_json::parse(read_bytes(out / "reproduce.json")); }
  double first_figure() const { return results()["rows"][0]["measured"]; }

  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  nlohmann::ordered_json whole;
};

TEST_F(GoOn, KeepsFinishedRowsAfterAnInterrupt) {
  EXPECT_EQ(lee2016_until(SIGINT).exit, 128 + SIGINT);
  EXPECT_EQ(results()["partial"], true);
  EXPECT_GE(results()["rows"].size(), 1U);
  EXPECT_SAYS(read_bytes(out / "reproduce.md"), "PARTIAL");
}

TEST_F(GoOn, KeepsFinishedRowsAfterAKill) {
  lee2016_until(SIGKILL);
  EXPECT_EQ(results()["partial"], true);
  const std::size_t rows = results()["rows"].size();
  EXPECT_GE(rows, 1U);
  EXPECT_SAYS(lee2016_until(SIGKILL).err, "continues after " + std::to_string(rows) + " finished rows");
  EXPECT_GT(results()["rows"].size(), rows);
}

TEST_F(GoOn, ReusesFinishedRowsAndMeasuresTheRest) {
  interrupt_late();
  const Words pictures = names_in(out);
  const ProcessResult ending = raywatt(small_hybrid(out));
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.err, "continues after");
  EXPECT_EQ(first_figure(), 77);
  nlohmann::ordered_json now = results();
  now["rows"][0]["measured"] = whole["rows"][0]["measured"];
  EXPECT_EQ(now, whole);
  EXPECT_EQ(names_in(out), pictures);
}

TEST_F(GoOn, MeasuresAllRowsForOtherOptions) {
  interrupt_late();
  EXPECT_EQ(raywatt(small_hybrid(out, {"--config", "sgrt-balanced"})).exit, 0);
  EXPECT_NE(first_figure(), 77);
}

TEST_F(GoOn, DoesNotReplaceResultsByFewer) {
  ASSERT_EQ(raywatt(small_hybrid(out)).exit, 0);
  const std::string before = read_bytes(out / "reproduce.json");
  EXPECT_EQ(begun(out).exit, 128 + SIGINT);
  EXPECT_EQ(read_bytes(out / "reproduce.json"), before);
}

TEST_F(GoOn, StartsInSpiteOfUnreadableResults) {
  fs::create_directories(out);
  std::ofstream(out / "reproduce.json") << R"({"schema": "raywatt-reproduce/1", "rows": )";
  EXPECT_EQ(raywatt(small_hybrid(out)).exit, 0);
  EXPECT_EQ(results()["partial"], false);
}

}  // namespace
}  // namespace test
