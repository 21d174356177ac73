#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"
#include "tests/traces/scene/tiny_gltf_file.h"

// Tests of runs over several frames of an animated scene, and of workload files with frames.

namespace test {
namespace {

namespace fs = std::filesystem;

/// Arguments of a run of the smallest chess scene while the first piece moves.
Words chess(const Words& more) {
  Words words = {"--scene", "chess", "--set", "scene.triangles=5000", "--set", "scene.frame_rate=2"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

nlohmann::json frames_report(const fs::path& out, const Words& more) {
  const ProcessResult ending = raywatt(small_run(out, chess(more)));
  EXPECT_EQ(ending.exit, 0) << ending.err;
  return read_json(out / "report.json");
}

TEST(Frames, HaveTheirOwnResultsAndPicturesAndTheTotalIsTheirSum) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  const nlohmann::json report = frames_report(out, {"--frames", "1:3"});
  ASSERT_EQ(report["frames"].size(), 3U);
  std::uint64_t cycles = 0, rays = 0;
  double energy = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const nlohmann::json& frame = report["frames"][i];
    EXPECT_EQ(frame["frame"], i + 1);
    cycles += frame["cycles"].get<std::uint64_t>();
    rays += frame["rays"]["total"].get<std::uint64_t>();
    energy += frame["energy_mj"]["nominal"].get<double>();
  }
  const nlohmann::json& totals = report["totals"];
  EXPECT_EQ(totals["cycles"], cycles);
  EXPECT_EQ(totals["rays"]["total"], rays);
  EXPECT_NEAR(totals["energy_mj"]["nominal"].get<double>(), energy, 1e-9 * energy);
  EXPECT_NEAR(totals["perf"]["fps"].get<double>(), 3000 / totals["time_ms"].get<double>(), 1e-6);
  EXPECT_EQ(read_bytes(out / "image.png"), read_bytes(out / "frame-0001.png"));
  EXPECT_NE(read_bytes(out / "frame-0001.png"), read_bytes(out / "frame-0003.png")) << "a piece has moved";
}

TEST(Frames, CountAsRaysPerSecondOfTheHostWithoutLoading) {
  const TempFolder folder;
  for (const char* threads : {"1", "2"}) {
    const fs::path out = folder.path() / threads;
    Words words = chess({"run", "--frames", "0:2", "--resolution", "64x32", "--threads", threads, "-o", out.string()});
    std::rotate(words.begin(), std::ranges::find(words, "run"), words.end());
    ASSERT_EQ(raywatt(words).exit, 0);
    const nlohmann::json report = read_json(out / "report.json");
    const nlohmann::json &host = report["host"], &totals = report["totals"];
    const double seconds = host["wall_s"].get<double>() - host["load_s"].get<double>();
    const auto rays = totals["rays"]["total"].get<double>(), steps = totals["traversal_steps"].get<double>();
    EXPECT_NEAR(host["rays_per_s"].get<double>(), rays / seconds, 1e-6 * rays / seconds);
    EXPECT_NEAR(host["steps_per_s"].get<double>(), steps / seconds, 1e-6 * steps / seconds);
    EXPECT_GT(host["update_s"], 0) << "a piece moves";
    EXPECT_LT(host["update_s"], host["load_s"]) << "is part of it";
    EXPECT_GT(host["peak_rss_mb"], 10);
  }
}

TEST(Frames, AreTheSameAloneAndInARun) {
  const TempFolder folder;
  const nlohmann::json all = frames_report(folder.path() / "all", {"--frames", "0:2"});
  const nlohmann::json last = frames_report(folder.path() / "last", {"--frames", "2"});
  EXPECT_EQ(all["frames"][2], last["frames"][0]);
  EXPECT_EQ(read_bytes(folder.path() / "all" / "frame-0002.png"), read_bytes(folder.path() / "last" / "image.png"));
}

TEST(Frames, OfAFormerRunAreReplaced) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  frames_report(out, {"--frames", "0:2"});
  frames_report(out, {"--frames", "1:2"});
  EXPECT_FALSE(fs::exists(out / "frame-0000.png"));
  EXPECT_TRUE(fs::exists(out / "frame-0002.png"));
}

TEST(Frames, AgreeWithEmbreeWhenTheTreeIsRefittedOrRebuilt) {
  const TempFolder folder;
  for (const char* update : {"refit", "rebuild"}) {
    Words words = chess({"--frames", "1:3", "--set", std::string("bvh.update=") + update});
    words.insert(words.begin(), "verify");
    words.insert(words.end(), {"--resolution", "64x32", "--quiet", "-o", (folder.path() / update).string()});
    const ProcessResult ending = raywatt(words);
    EXPECT_EQ(ending.exit, 0) << ending.err;
    EXPECT_EQ(read_json(folder.path() / update / "verify.json")["frames"].size(), 3U);
  }
}

TEST(Frames, FinishedBeforeAnInterruptAreKept) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  Program program(small_run(out, chess({"--frames", "0:100000"})));
  EXPECT_TRUE(program.wait_for_file(folder.path(), "frame-0001.png"));
  program.send(SIGINT);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 128 + SIGINT);
  const nlohmann::json report = read_json(out / "report.json");
  EXPECT_SAYS(ending.err, "kept " + std::to_string(report["frames"].size()) + " of 100001 frames in");
  EXPECT_EQ(report["partial"], true);
  EXPECT_GE(report["frames"].size(), 2U);
  EXPECT_TRUE(fs::exists(out / "frame-0001.png"));
  EXPECT_EQ(names_in(folder.path()), Words{"out"});
}

TEST(Frames, FewerOfAnInterruptedRunDoNotReplaceMore) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out, chess({"--frames", "0:5"}))).exit, 0);
  const std::string former = read_bytes(out / "report.json");
  Program program(small_run(out, chess({"--frames", "0:100000", "--program", "full:16"})));
  EXPECT_TRUE(program.wait_for_file(folder.path(), "frame-0001.png"));
  program.send(SIGINT);
  EXPECT_EQ(program.wait().exit, 128 + SIGINT);
  EXPECT_EQ(read_bytes(out / "report.json"), former);
  EXPECT_TRUE(fs::exists(out / "frame-0005.png"));
  EXPECT_EQ(names_in(folder.path()), Words{"out"});
}

/// Starts a verb with progress output and interrupts it after its first frame.
ProcessResult interrupted_after_a_frame(Words words) {
  words.insert(words.end(), {"--progress", "json", "--threads", "1"});
  Program program(words);
  EXPECT_TRUE(program.wait_until([](const std::string& err) {
    constexpr std::string_view kFrame = "\"frame\":";
    const std::size_t at = err.rfind(kFrame);
    return at != std::string::npos && std::atoi(err.c_str() + at + kFrame.size()) > 0;
  }));
  program.send(SIGINT);
  return program.wait();
}

TEST(Frames, FewerOfAnInterruptedVerifyDoNotReplaceMore) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  const auto verify = [&](const Words& more) {
    Words words = chess(more);
    words.insert(words.begin(), "verify");
    words.insert(words.end(), {"-o", out.string()});
    return words;
  };
  ASSERT_EQ(raywatt(verify({"--frames", "0:9", "--resolution", "16x16"})).exit, 0);
  const std::string former = read_bytes(out / "verify.json"), picture = read_bytes(out / "image.png");
  const ProcessResult ending =
      interrupted_after_a_frame(verify({"--frames", "0:1000", "--resolution", "64x64", "--program", "full:4"}));
  EXPECT_EQ(ending.exit, 128 + SIGINT);
  EXPECT_SAYS(ending.err, "raywatt: interrupted\n");
  EXPECT_EQ(read_bytes(out / "verify.json"), former);
  EXPECT_EQ(read_bytes(out / "image.png"), picture);
  EXPECT_EQ(names_in(folder.path()), Words{"out"});
}

TEST(Frames, FewerOfAnInterruptedReplayDoNotReplaceMore) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  const std::string trace = (folder.path() / "a.trace").string();
  Words record = chess({"--frames", "0:7", "--resolution", "32x32", "--program", "full:4", "--quiet", trace});
  record.insert(record.begin(), {"trace", "record"});
  ASSERT_EQ(raywatt(record).exit, 0);
  const Words replay = {"trace", "replay", trace, "-o", out.string()};
  ASSERT_EQ(raywatt(replay).exit, 0);
  const std::string former = read_bytes(out / "report.json");
  const ProcessResult ending = interrupted_after_a_frame(replay);
  EXPECT_EQ(ending.exit, 128 + SIGINT);
  EXPECT_SAYS(ending.err, "raywatt: interrupted\n");
  EXPECT_EQ(read_bytes(out / "report.json"), former);
  EXPECT_EQ(names_in(folder.path()), (Words{"a.trace", "out"}));
}

TEST(Frames, ThatMakeNoSenseAreRefused) {
  const TempFolder folder;
  for (const char* text : {"3:1", "a", "1:", ":2", "1:2:3", "-1"}) {
    expect_refusal(raywatt(small_run(folder.path() / "out", {std::string("--frames=") + text})), {"--frames", text});
  }
  EXPECT_TRUE(names_in(folder.path()).empty());
}

TEST(WorkloadFile, DefinesTheSceneAndYieldsToSets) {
  const TempFolder folder;
  folder.write("triangle.glb", TinyGltf().glb());
  const std::string file =
      folder.write("mine.yaml", "scene: {name: ./triangle.glb, first_frame: 4, last_frame: 4}\nrender: {depth: 2}\n")
          .string();
  const ProcessResult ending = raywatt({"run", "--scene", file, "--set", "scene.last_frame=5", "--resolution", "16x16",
                                        "--quiet", "-o", (folder.path() / "out").string()});
  ASSERT_EQ(ending.exit, 0) << ending.err;
  const nlohmann::json report = read_json(folder.path() / "out" / "report.json");
  EXPECT_EQ(report["scene"]["name"], "triangle") << "found beside the workload file";
  EXPECT_EQ(report["config"]["render"]["depth"], 2);
  EXPECT_EQ(report["frames"].size(), 2U);
}

TEST(WorkloadFile, RefusesKeysOfTheMachine) {
  const TempFolder folder;
  const std::string file = folder.write("bad.yaml", "scene: {name: teapot}\ncores: 2\n").string();
  expect_refusal(raywatt({"run", "--scene", file, "-o", (folder.path() / "out").string()}),
                 {"bad.yaml:2:1", "cores", "scene, render, bvh"});
}

TEST(WorkloadFile, OfASceneThatIsNotThereIsNamed) {
  const TempFolder folder;
  const std::string file = folder.write("bad.yaml", "scene: {name: teapott}\n").string();
  expect_refusal(raywatt({"run", "--scene", file, "-o", (folder.path() / "out").string()}),
                 {"bad.yaml: scene.name: no scene is called 'teapott'", "did you mean 'teapot'?"});
}

TEST(WorkloadFile, OfTheProjectIsFoundByItsName) {
  const TempFolder folder;
  const ProcessResult ending = raywatt(small_run(folder.path() / "out", {"--scene", "lee2016-teapot"}));
  ASSERT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(read_json(folder.path() / "out" / "report.json")["scene"]["name"], "teapot");
}

}  // namespace
}  // namespace test
