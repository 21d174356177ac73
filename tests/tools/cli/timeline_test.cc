#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/temp_folder.h"
#include "tests/tools/program.h"

// Tests of the option --timeline: its file, its entry in the report, its errors.

namespace test {
namespace {

namespace fs = std::filesystem;

struct TimelineOption : testing::Test {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";

  ProcessResult run(const std::string& asked, const Words& more = {}) const {
    Words words = small_run(out, more);
    words.insert(words.end(), {"--timeline", asked});
    return raywatt(words);
  }
  nlohmann::json report() const { return read_json(out / "report.json"); }
};

TEST_F(TimelineOption, WritesAFileAndDescribesIt) {
  const ProcessResult ending = run("slowest:2");
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_GT(fs::file_size(out / "timeline.pftrace"), 1000U);
  EXPECT_EQ(report()["timeline"]["asked"], "slowest:2");
  EXPECT_GT(report()["timeline"]["slices"], 0);
  EXPECT_EQ(report()["timeline"]["dropped"], 0);
}

TEST_F(TimelineOption, ChangesNothingElseOfTheReport) {
  ASSERT_EQ(run("all").exit, 0);
  const nlohmann::json with = report();
  fs::remove_all(out);
  ASSERT_EQ(raywatt(small_run(out)).exit, 0);
  EXPECT_EQ(with["totals"], report()["totals"]);
  EXPECT_EQ(with["units"], report()["units"]);
  EXPECT_FALSE(report().contains("timeline"));
  EXPECT_FALSE(fs::exists(out / "timeline.pftrace"));
}

TEST_F(TimelineOption, RefusesWhatItCannotShowBeforeTheFrame) {
  expect_refusal(run("pixel:64,0"),
                 {"--timeline pixel:64,0", "no such pixel", "64 across and 32 down", "0,0 to 63,31"});
  expect_refusal(run("tile:99,99", {"--set", "render.tile=16"}),
                 {"--timeline tile:99,99", "no such tile", "4 across and 2 down", "0,0 to 3,1"});
  expect_refusal(run("tile:4,0", {"--record", (folder.path() / "a.trace").string()}), {"no such tile"});
  EXPECT_FALSE(fs::exists(folder.path() / "a.trace"));
  expect_refusal(run("fastest:3"), {"--timeline 'fastest:3'", "slowest:8"});
  expect_refusal(run("all", {"--tile-sampling", "50%"}), {"--timeline", "--tile-sampling"});
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace test
