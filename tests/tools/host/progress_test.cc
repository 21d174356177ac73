#include "tools/host/progress.h"

#include <algorithm>
#include <chrono>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/host/on_terminal.h"
#include "tests/tools/program.h"

// Tests of progress output during a run.

namespace test {
namespace {

namespace fs = std::filesystem;

tools::ProgressState half_way() {
  tools::ProgressState state;
  state.phase = "simulating";
  state.frame = 7;
  state.part = 1;
  state.parts = 4;
  state.tile = 50;
  state.tiles = 100;
  state.rays = 3'000'000;
  state.cycles = 9'000'000;
  state.busy_seconds = 3;
  state.traced_seconds = 2;
  state.seconds = 4;
  return state;
}

TEST(ProgressLine, ShowsShareRateAndTimeLeft) {
  EXPECT_EQ(tools::progress_line(half_way(), 200),
            "simulating frame 7 [#########...............] 38 %  1.50 Mrays/s  5 s left");
}

TEST(ProgressLine, ShowsTheDurationAfterTheEndAndNoTimeLeft) {
  tools::ProgressState state = half_way();
  state.phase = "interrupted";
  state.ended = true;
  EXPECT_EQ(tools::progress_line(state, 200),
            "interrupted frame 7 [#########...............] 38 %  1.50 Mrays/s  after 4 s");
}

TEST(ProgressLine, CountsWhatOthersHaveDoneAsDoneButNotAsDoneInThisTime) {
  tools::ProgressState state;
  state.phase = "computing";
  state.tiles = 100;
  state.tile = state.tile_before = 40;
  state.busy_seconds = 10;
  EXPECT_LT(state.seconds_left(), 0) << "nothing is known yet";
  EXPECT_EQ(tools::progress_line(state, 200), "computing [#########...............] 40 %");
  state.tile = 50;
  EXPECT_DOUBLE_EQ(state.seconds_left(), 50);
}

TEST(ProgressLine, NeverFillsTheTerminal) {
  for (const std::size_t columns : {1U, 2U, 20U, 60U}) {
    EXPECT_LT(tools::progress_line(half_way(), columns).size(), columns);
  }
}

TEST(ProgressLine, ShowsTheActivityBeforeThereAreTiles) {
  tools::ProgressState state;
  state.seconds = 200;
  EXPECT_EQ(tools::progress_line(state, 80), "loading ...  3 min 20 s");
}

TEST(ProgressJson, IsOneLineWithEveryValue) {
  const std::string line = tools::progress_json(half_way());
  EXPECT_EQ(std::ranges::count(line, '\n'), 1);
  const nlohmann::json json = nlohmann::json::parse(line);
  EXPECT_EQ(json, (nlohmann::json{{"time", 4.0},
                                  {"phase", "simulating"},
                                  {"frame", 7},
                                  {"part", 1},
                                  {"parts", 4},
                                  {"tile", 50},
                                  {"tiles", 100},
                                  {"rays", 3'000'000},
                                  {"cycles", 9'000'000},
                                  {"rays_per_s", 1.5e6},
                                  {"seconds_left", 5.0}}));
}

TEST(ProgressJson, CountsNoTimeBetweenPartsInItsRate) {
  constexpr std::uint64_t kRays = 1'000'000;
  const std::chrono::seconds writing(1);
  testing::internal::CaptureStderr();
  {
    tools::Progress progress("json", true);
    progress.expect_parts(2);
    progress.begin_part("simulating", 0, 2);
    progress.set_tiles_done(1, kRays / 2, 1);
    progress.set_tiles_done(2, kRays, 1);
    progress.set_phase("writing the picture");
    std::this_thread::sleep_for(writing);
    progress.begin_part("simulating", 1, 2);
    progress.set_tiles_done(1, kRays, 1);
    progress.set_phase("writing the picture");  // interrupts the part
    std::this_thread::sleep_for(writing);
    progress.finish("interrupted");
  }
  const std::string said = testing::internal::GetCapturedStderr();
  const nlohmann::json last = nlohmann::json::parse(said.substr(said.rfind('{')));
  EXPECT_EQ(last["rays"], 2 * kRays);
  EXPECT_GT(last["rays_per_s"].get<double>(), 2 * kRays / 0.5) << "of the time in parts, which is next to none";
}

TEST(ProgressJson, GoesUpAndEndsWithTheWholeRun) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  const ProcessResult ending = raywatt(
      {"run", "--resolution", "1024x512", "--threads", "1", "--quiet", "--progress", "json", "-o", out.string()});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  std::vector<nlohmann::json> lines;
  std::istringstream err(ending.err);
  for (std::string line; std::getline(err, line);) lines.push_back(nlohmann::json::parse(line));
  ASSERT_GE(lines.size(), 2U);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_GE(lines[i]["time"], lines[i - 1]["time"]);
    EXPECT_GE(lines[i]["rays"], lines[i - 1]["rays"]);
    EXPECT_GE(lines[i]["cycles"], lines[i - 1]["cycles"]);
    if (i + 1 < lines.size()) {
      EXPECT_GE(lines[i]["time"].get<double>() - lines[i - 1]["time"].get<double>(), 0.15) << "at most five a second";
    }
  }
  const nlohmann::json report = read_json(out / "report.json");
  EXPECT_EQ(lines.back()["phase"], "done");
  EXPECT_EQ(lines.back()["part"], 1);
  EXPECT_EQ(lines.back()["rays"], report["totals"]["rays"]["total"]);
  EXPECT_NEAR(lines.back()["cycles"].get<double>(), report["totals"]["cycles"].get<double>(),
              0.01 * report["totals"]["cycles"].get<double>());
}

TEST(ProgressJson, OfSampledTilesGoesUpThroughAllRoundsAndEndsWithThem) {
  const TempFolder folder;
  const ProcessResult ending =
      raywatt({"run", "--resolution", "512x256", "--tile-sampling", "auto", "--image", "none", "--threads", "1",
               "--quiet", "--progress", "json", "-o", (folder.path() / "out").string()});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  std::uint64_t rays = 0, tiles = 0;
  nlohmann::json last;
  std::istringstream err(ending.err);
  for (std::string line; std::getline(err, line);) {
    last = nlohmann::json::parse(line);
    EXPECT_GE(last["rays"], rays);
    EXPECT_GE(last["tile"], tiles);
    EXPECT_TRUE(last["part"] == 0 || last["tile"] == last["tiles"]) << "a frame is one part, done with its last tile";
    rays = last["rays"], tiles = last["tile"];
  }
  EXPECT_EQ(last["phase"], "done");
  EXPECT_EQ(last["part"], 1);
  EXPECT_GT(rays, 10000U);
  EXPECT_EQ(last["tile"], last["tiles"]);
}

TEST(ProgressJson, OfVerifyAndReproduceIsThereToo) {
  const TempFolder folder;
  const ProcessResult verify =
      raywatt({"verify", "--resolution", "64x32", "--progress", "json", "-o", (folder.path() / "verify").string()});
  EXPECT_SAYS(verify.err, "\"phase\":\"done\"");
  EXPECT_SAYS(verify.err, "\"part\":2,\"parts\":2");
  EXPECT_SAYS(raywatt({"reproduce", "--help"}).out, "--progress");
}

TEST(ProgressJson, OfAListOfRaysGoesUpAndEndsWithAllOfThem) {
  constexpr std::size_t kRays = 300'000;
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  const ProcessResult ending = raywatt({"run", "--rays", folder.write("a.rays", ray_list(kRays)).string(), "--quiet",
                                        "--progress", "json", "-o", out.string()});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  nlohmann::json last = {{"rays", 0}, {"tile", 0}, {"cycles", 0}};
  std::istringstream err(ending.err);
  for (std::string line; std::getline(err, line);) {
    const nlohmann::json json = nlohmann::json::parse(line);
    for (const char* figure : {"rays", "tile", "cycles"}) EXPECT_GE(json[figure], last[figure]);
    last = json;
  }
  const nlohmann::json totals = read_json(out / "report.json")["totals"];
  EXPECT_EQ(last["phase"], "done");
  EXPECT_EQ(last["part"], 1);
  EXPECT_EQ(last["rays"], kRays);
  EXPECT_EQ(last["tile"], (kRays + 63) / 64);
  EXPECT_EQ(last["tiles"], last["tile"]);
  EXPECT_EQ(totals["rays"]["listed"], kRays);
  EXPECT_NEAR(last["cycles"].get<double>(), totals["cycles"].get<double>(), 0.01 * totals["cycles"].get<double>());
}

TEST(ProgressJson, OfARecordingGoesThroughAllFramesAndTheirReferences) {
  const TempFolder folder;
  const ProcessResult ending = raywatt({"trace", "record", "--scene", "chess", "--set", "scene.triangles=5000", "--set",
                                        "scene.frame_rate=2", "--frames", "0:1", "--resolution", "64x32", "--reference",
                                        "full:4", "--progress", "json", (folder.path() / "a.trace").string()});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.err, "\"phase\":\"done\",\"frame\":1,\"part\":4,\"parts\":4");
}

constexpr char kControlC = '\x03';

Words long_run(const TempFolder& folder) {
  return {"run",       "--resolution", "256x256",
          "--program", "full:256",     "--threads",
          "2",         "-o",           (folder.path() / "out").string()};
}

TEST(ProgressBar, AppearsAfterTwoSecondsAndIsErasedByAnInterrupt) {
  const TempFolder folder;
  const auto begin = std::chrono::steady_clock::now();
  OnTerminal run(long_run(folder));
  ASSERT_TRUE(run.wait_for("rays/s")) << run.screen();
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(1900));
  EXPECT_TRUE(run.wait_for(" left"));
  EXPECT_SAYS(run.screen(), "simulating [");
  run.type(kControlC);
  EXPECT_EQ(run.wait(), 130);
  EXPECT_SAYS(run.screen(), "\r\x1b[Kraywatt: interrupted; kept ");
}

TEST(ProgressBar, IsErasedBeforeTheTable) {
  const TempFolder folder;
  // Longer than the two seconds after which the bar appears.
  OnTerminal run({"run", "--scene", "chess", "--set", "scene.triangles=600000", "--resolution", "64x32", "--threads",
                  "1", "-o", (folder.path() / "out").string()});
  EXPECT_EQ(run.wait(), 0);
  const std::size_t bar = run.screen().find("building the tree ...");
  if (bar == std::string::npos) GTEST_SKIP() << "this host is too fast";
  EXPECT_NE(run.screen().find("\r\x1b[Kchess  64x32"), std::string::npos) << run.screen();
}

TEST(ProgressBar, IsAbsentInAPipeAndIfTurnedOff) {
  const TempFolder folders[4];
  const auto words = [&](int run, const Words& unwanted) {
    Words all = long_run(folders[run]);
    all.insert(all.end(), unwanted.begin(), unwanted.end());
    return all;
  };
  Program piped(words(0, {}));
  OnTerminal quiet(words(1, {"--quiet"})), unwanted(words(2, {"--progress", "none"}));
  OnTerminal last(words(3, {}));
  ASSERT_TRUE(last.wait_for("rays/s")) << "a run that began later has its bar";
  piped.send(SIGINT);
  const std::string said = piped.wait().err;
  EXPECT_TRUE(said.starts_with("raywatt: interrupted") || said.starts_with("raywatt: this may take")) << said;
  EXPECT_EQ(said.find('\r'), std::string::npos) << said;
  for (OnTerminal* run : {&quiet, &unwanted}) {
    run->type(kControlC);
    EXPECT_EQ(run->wait(), 130);
    EXPECT_TRUE(run->screen().starts_with("^Craywatt: interrupted")) << run->screen();
  }
}

}  // namespace
}  // namespace test
