#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/host/on_terminal.h"
#include "tests/tools/program.h"
#include "tests/tools/studies/sweep/small_sweep.h"
#include "tools/host/progress.h"

// Tests of the live view, which shows picture and statistics on a terminal.

namespace test {
namespace {

using tools::SmallPicture;

TEST(HalfBlocks, HaveTwoPixelsACharacter) {
  const SmallPicture picture{1, 3, {1, 2, 3, 4, 5, 6, 7, 8, 9}};
  EXPECT_EQ(tools::draw_half_blocks(picture),
            "\r\x1b[38;2;1;2;3;48;2;4;5;6m\u2580\x1b[0m\x1b[K\n"
            "\r\x1b[38;2;7;8;9;48;2;0;0;0m\u2580\x1b[0m\x1b[K\n");
}

Words watched(const TempFolder& folder) { return small_run(folder.path() / "out", {"--watch", "--scene", "teapot"}); }

TEST(Watch, ShowsPictureStatisticsAndTheEndOnATerminalWithColours) {
  const TempFolder folder;
  Words words = watched(folder);
  *std::ranges::find(words, "64x32") = "512x256";  // longer than the half second between two views on any host
  OnTerminal run(words, {{"COLORTERM", "truecolor"}, {"LANG", "C.UTF-8"}});
  EXPECT_EQ(run.wait(), 0);
  EXPECT_SAYS(run.screen(), "\u2580");
  EXPECT_SAYS(run.screen(), "done [");
  EXPECT_SAYS(run.screen(), "ends at ");
  EXPECT_SAYS(run.screen(), " W  at ");
  EXPECT_SAYS(run.screen(), "report:  ");
}

TEST(Watch, ShowsNoPictureWithoutTwentyFourBitColour) {
  const TempFolder folder;
  OnTerminal run(watched(folder));
  EXPECT_EQ(run.wait(), 0);
  EXPECT_SAYS(run.screen(), "done [");
  EXPECT_EQ(run.screen().find("\u2580"), std::string::npos);
}

TEST(Watch, PrintsPlainLinesElsewhereAndChangesNoResult) {
  const TempFolder folder;
  ASSERT_EQ(raywatt(small_run(folder.path() / "plain", {"--scene", "teapot"})).exit, 0);
  const ProcessResult ending = raywatt(small_run(folder.path() / "out", {"--scene", "teapot", "--watch"}));
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.err, "done [");
  EXPECT_EQ(ending.err.find('\x1b'), std::string::npos);
  EXPECT_EQ(comparable(read_json(folder.path() / "plain" / "report.json")),
            comparable(read_json(folder.path() / "out" / "report.json")));
  for (const char* file : {"image.exr", "intervals.bin.zst"}) {
    EXPECT_EQ(read_bytes(folder.path() / "plain" / file), read_bytes(folder.path() / "out" / file)) << file;
  }
}

TEST(Watch, OfASweepEndsWhenItsPointsHave) {
  const TempFolder folder;
  ASSERT_EQ(raywatt(sweep_run(folder, write_sweep(folder, "axes:\n  cores: [1, 2]\n"))).exit, 0);
  const ProcessResult ending = raywatt({"sweep", "watch", (folder.path() / "out").string()});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "2 points: 2 done, 0 failed, 0 missing");
}

}  // namespace
}  // namespace test
