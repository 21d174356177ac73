#include "tools/host/view.h"

#include <algorithm>
#include <cctype>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/host/on_terminal.h"
#include "tests/tools/program.h"
#include "tests/tools/studies/sweep/small_sweep.h"

// Views of jobs that run: pictures and figures on a terminal.

namespace test {
namespace {

using tools::SmallPicture;

/// Pixels of a file of sixels as indices of its colours, by the format's own rules; -1: none.
std::vector<int> pixels_of(const std::string& sixels, std::size_t width, std::size_t height) {
  std::vector<int> pixels(width * height, -1);
  std::size_t at = sixels.find("q\"1;1;") + 6;
  at = sixels.find('#', at);
  std::size_t x = 0, top = 0;
  int colour = 0;
  const auto number = [&] {
    int value = 0;
    for (; std::isdigit(static_cast<unsigned char>(sixels[at])) != 0; ++at) value = 10 * value + sixels[at] - '0';
    return value;
  };
  while (sixels[at] != '\x1b') {
    const char c = sixels[at++];
    int times = 1;
    if (c == '#') {
      colour = number();
      while (sixels[at] == ';') ++at, number();
      continue;
    }
    if (c == '$' || c == '-') {
      x = 0;
      top += c == '-' ? 6 : 0;
      continue;
    }
    char sixel = c;
    if (c == '!') times = number(), sixel = sixels[at++];
    for (; times > 0; --times, ++x) {
      for (std::size_t bit = 0; bit < 6; ++bit) {
        if (((sixel - '?') >> bit & 1) != 0) pixels.at((top + bit) * width + x) = colour;
      }
    }
  }
  return pixels;
}

TEST(HalfBlocks, HaveTwoPixelsACharacter) {
  const SmallPicture picture{1, 3, {1, 2, 3, 4, 5, 6, 7, 8, 9}};
  EXPECT_EQ(tools::half_blocks(picture),
            "\r\x1b[38;2;1;2;3;48;2;4;5;6m\u2580\x1b[0m\x1b[K\n"
            "\r\x1b[38;2;7;8;9;48;2;0;0;0m\u2580\x1b[0m\x1b[K\n");
}

TEST(Sixels, ShowEachPixelInTheNearestOfItsColours) {
  constexpr std::size_t kWidth = 23, kHeight = 14;
  SmallPicture picture{kWidth, kHeight, {}};
  for (std::size_t i = 0; i < kWidth * kHeight; ++i) {
    for (const std::size_t channel : {i * 7, i / 5 * 40, i * i}) {
      picture.rgb.push_back(static_cast<std::uint8_t>(channel % 256));
    }
  }
  const std::string sixels = tools::sixels(picture);
  EXPECT_TRUE(sixels.starts_with("\x1bPq\"1;1;23;14#0;2;0;0;0")) << sixels.substr(0, 40);
  EXPECT_TRUE(sixels.ends_with("\x1b\\"));
  EXPECT_SAYS(sixels, "#215;2;100;100;100");
  const std::vector<int> pixels = pixels_of(sixels, kWidth, kHeight);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int colour = pixels[i];
    const int levels[3] = {colour / 36, colour / 6 % 6, colour % 6};
    for (std::size_t c = 0; c < 3; ++c) ASSERT_LE(std::abs(levels[c] * 51 - picture.rgb[3 * i + c]), 26) << i;
  }
}

Words watched(const TempFolder& folder) { return small_run(folder.path() / "out", {"--watch", "--scene", "teapot"}); }

TEST(Watch, ShowsPictureFiguresAndTheEndOnATerminalWithColours) {
  const TempFolder folder;
  Words words = watched(folder);
  *std::ranges::find(words, "64x32") = "512x256";  // lasts longer than the half second between two views on any host
  OnTerminal run(words, {{"COLORTERM", "truecolor"}, {"LANG", "C.UTF-8"}});
  EXPECT_EQ(run.wait(), 0);
  EXPECT_SAYS(run.screen(), "\u2580");
  EXPECT_SAYS(run.screen(), "done [");
  EXPECT_SAYS(run.screen(), "ends at ");
  EXPECT_SAYS(run.screen(), " W  at ");
  EXPECT_SAYS(run.screen(), "report:  ");
  EXPECT_EQ(run.screen().find("\x1bPq"), std::string::npos);
}

TEST(Watch, ShowsSixelsWhereTheTerminalAnswersThatItCan) {
  const TempFolder folder;
  OnTerminal run(watched(folder), {{"COLORTERM", "truecolor"}}, "\x1b[?62;4;22c");
  EXPECT_EQ(run.wait(), 0);
  EXPECT_SAYS(run.screen(), "\x1bPq");
  EXPECT_EQ(run.screen().find("\u2580"), std::string::npos);
}

TEST(Watch, ShowsNoPictureOnATerminalThatSaysNothing) {
  const TempFolder folder;
  OnTerminal run(watched(folder));
  EXPECT_EQ(run.wait(), 0);
  EXPECT_SAYS(run.screen(), "done [");
  EXPECT_EQ(run.screen().find("\u2580"), std::string::npos);
}

TEST(Watch, SaysPlainLinesElsewhereAndChangesNoResult) {
  const TempFolder folder;
  ASSERT_EQ(raywatt(small_run(folder.path() / "plain", {"--scene", "teapot"})).exit, 0);
  const Ending ending = raywatt(small_run(folder.path() / "out", {"--scene", "teapot", "--watch"}));
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
  const Ending ending = raywatt({"sweep", "watch", (folder.path() / "out").string()});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "2 points: 2 done, 0 failed, 0 missing");
}

}  // namespace
}  // namespace test
