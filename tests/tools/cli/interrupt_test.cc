#include <csignal>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/program.h"

// Tests that an interrupted run leaves no partial files.

namespace test {
namespace {

namespace fs = std::filesystem;

/// Returns the last complete line of --progress json, or an empty object.
nlohmann::json last_progress(const std::string& err) {
  const std::size_t end = err.rfind('\n');
  if (end == std::string::npos) return nlohmann::json::object();
  const std::size_t begin = end == 0 ? std::string::npos : err.rfind('\n', end - 1);
  return nlohmann::json::parse(err.substr(begin + 1, end - begin - 1), nullptr, false);
}

/// Waits until some tiles are finished.
bool wait_for_tiles(Program& program) {
  return program.wait_until([](const std::string& err) {
    const nlohmann::json line = last_progress(err);
    return line.value("tile", 0) > 3 && line.value("tile", 0) < line.value("tiles", 0);
  });
}

/// Waits until a value appears in the progress output.
bool wait_for(Program& program, const std::string& key, const nlohmann::json& value) {
  return program.wait_until([&](const std::string& err) {
    const nlohmann::json line = last_progress(err);
    return line.contains(key) && line[key] == value;
  });
}

/// Returns the arguments of a run that takes many seconds and prints progress.
Words long_run(const fs::path& out) {
  return {"run", "--resolution", "256x256", "--program", "full:256",  "--threads",
          "2",   "--progress",   "json",    "-o",        out.string()};
}

/// Starts a run with output `out`, interrupts it by a signal, and returns how it ended.
ProcessResult interrupt_run(int signal, const fs::path& out) {
  Program program(long_run(out));
  EXPECT_TRUE(wait_for_tiles(program));
  program.send(signal);
  return program.wait();
}

/// Returns two sums over all units: elapsed cycles, and cycles of all reasons.
std::pair<std::uint64_t, std::uint64_t> elapsed_and_why(const nlohmann::json& units) {
  std::pair<std::uint64_t, std::uint64_t> sums;
  if (units.contains("elapsed")) {
    sums.first += units["elapsed"].get<std::uint64_t>();
    for (const auto& [reason, cycles] : units["why"].items()) sums.second += cycles.get<std::uint64_t>();
    return sums;
  }
  for (const auto& [name, below] : units.items()) {
    const auto [elapsed, why] = elapsed_and_why(below);
    sums.first += elapsed;
    sums.second += why;
  }
  return sums;
}

TEST(Interrupt, WhileTheSceneIsLoadedLeavesNothing) {
  const TempFolder folder;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Program program({"run", "--scene", "chess", "--set", "scene.triangles=4000000", "--threads", "1", "--progress",
                     "json", "-o", (folder.path() / "new" / "out").string()});
    EXPECT_TRUE(program.wait_for_complaint());
    program.send(signal);
    const ProcessResult ending = program.wait();
    EXPECT_EQ(ending.exit, 128 + signal);
    EXPECT_EQ(ending.out, "");
    EXPECT_SAYS(ending.err, "raywatt: interrupted\n");
    EXPECT_EQ(last_progress(ending.err.substr(0, ending.err.find("raywatt")))["cycles"], 0) << "it was too late";
    EXPECT_EQ(names_in(folder.path()), Words{});
  }
}

TEST(Interrupt, InAFrameKeepsItsFinishedPart) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const ProcessResult ending = interrupt_run(signal, out);
    EXPECT_EQ(ending.exit, 128 + signal);
    const nlohmann::json report = read_json(out / "report.json");
    EXPECT_EQ(report["partial"], true);
    const nlohmann::json& frame = report["frames"][0];
    EXPECT_GT(frame["finished_tiles"], 3);
    EXPECT_LT(frame["finished_tiles"], frame["tiles"]);
    EXPECT_SAYS(ending.err, "raywatt: interrupted; kept " + frame["finished_tiles"].dump() + " of " +
                                frame["tiles"].dump() + " tiles of frame 0 in " + out.string() + "\n");
    EXPECT_SAYS(read_bytes(out / "report.txt"), "PARTIAL");
    const nlohmann::json& totals = report["totals"];
    const int tiles = frame["finished_tiles"].get<int>();
    EXPECT_EQ(totals["rays"]["primary"], tiles * 1024) << "a tile is four pixels";
    EXPECT_EQ(totals["kernels"]["pack_colour"]["items"], tiles * 4);
    const auto [elapsed, why] = elapsed_and_why(report["units"]);
    EXPECT_EQ(elapsed, why) << "what is reported of the part adds up";
    EXPECT_TRUE(fs::exists(out / "image.png"));
    EXPECT_EQ(names_in(folder.path()), Words{"out"});
    fs::remove_all(out);
  }
}

TEST(Interrupt, WithSampledTilesKeepsFinishedFramesAndNothingOfOthers) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  const auto stopped = [&](const Words& more, const std::function<bool(const nlohmann::json&)>& at) {
    Words words = {"run", "--tile-sampling", "5%", "--threads", "2", "--progress", "json", "-o", out.string()};
    words.insert(words.end(), more.begin(), more.end());
    Program program(words);
    EXPECT_TRUE(program.wait_until([&](const std::string& err) { return at(last_progress(err)); }));
    program.send(SIGINT);
    return program.wait();
  };
  const ProcessResult first = stopped(
      {"--resolution", "512x256", "--program", "full:64"},
      [](const nlohmann::json& line) { return line.value("phase", "") == "simulating" && line.value("tile", 0) > 3; });
  EXPECT_EQ(first.exit, 128 + SIGINT);
  EXPECT_SAYS(first.err, "raywatt: interrupted\n");
  EXPECT_EQ(last_progress(first.err.substr(0, first.err.find("raywatt")))["phase"], "interrupted");
  EXPECT_EQ(names_in(folder.path()), Words{});
  const ProcessResult later = stopped({"--scene", "chess", "--set", "scene.triangles=5000", "--set",
                                       "scene.frame_rate=2", "--frames", "0:100000", "--resolution", "64x32"},
                                      [](const nlohmann::json& line) { return line.value("frame", 0) > 2; });
  EXPECT_EQ(later.exit, 128 + SIGINT);
  const nlohmann::json report = read_json(out / "report.json");
  EXPECT_EQ(report["partial"], true);
  EXPECT_GE(report["frames"].size(), 2U);
  EXPECT_SAYS(later.err, "kept " + std::to_string(report["frames"].size()) + " of 100001 frames in");
}

/// Returns the report of `run --rays` on a ray list, without host times.
nlohmann::json figures_of_rays(const fs::path& out) {
  const nlohmann::json report = read_json(out / "report.json");
  nlohmann::json figures = {{"totals", report["totals"]}, {"units", report["units"]}};
  figures["totals"]["rays"].erase("listed");
  return figures;
}

TEST(Interrupt, InAListOfRaysKeepsThoseThatAreFinished) {
  constexpr std::size_t kRays = 1'000'000;
  const TempFolder folder;
  const fs::path list = folder.write("many.rays", ray_list(kRays)), out = folder.path() / "out";
  const auto words = [&](const fs::path& file, const fs::path& to) {
    return Words{"run",     "--rays",  file.string(), "--set", "cores=1", "--threads", "1",
                 "--scene", "cornell", "--progress",  "json",  "-o",      to.string()};
  };
  for (const int signal : {SIGINT, SIGTERM}) {
    Program program(words(list, out));
    EXPECT_TRUE(wait_for_tiles(program));
    program.send(signal);
    const ProcessResult ending = program.wait();
    EXPECT_EQ(ending.exit, 128 + signal);
    EXPECT_EQ(ending.out, "");
    const nlohmann::json report = read_json(out / "report.json");
    EXPECT_EQ(report["partial"], true);
    EXPECT_EQ(report["totals"]["rays"]["listed"], kRays);
    const auto rays = report["totals"]["rays"]["total"].get<std::size_t>();
    EXPECT_GT(rays, 0U);
    EXPECT_LT(rays, kRays);
    const std::string kept = std::to_string(rays) + " of 1000000 rays";
    EXPECT_SAYS(ending.err, "raywatt: interrupted; kept " + kept + " in " + out.string() + "\n");
    EXPECT_SAYS(ending.err, "\"phase\":\"interrupted\"");
    EXPECT_SAYS(read_bytes(out / "report.txt"), "PARTIAL: interrupted after " + kept);
    const auto [elapsed, why] = elapsed_and_why(report["units"]);
    EXPECT_EQ(elapsed, why);
    const fs::path first = folder.write("first.rays", ray_list(rays)), whole = folder.path() / "whole";
    ASSERT_EQ(raywatt(words(first, whole)).exit, 0);
    EXPECT_EQ(figures_of_rays(out), figures_of_rays(whole)) << "as a list of these rays alone, which one core plays";
    fs::remove_all(out);
  }
  ASSERT_EQ(raywatt(words(folder.write("few.rays", ray_list(100)), out)).exit, 0);
  const std::string former = read_bytes(out / "report.json");
  Program program(words(list, out));
  EXPECT_TRUE(wait_for_tiles(program));
  program.send(SIGINT);
  EXPECT_EQ(program.wait().exit, 128 + SIGINT);
  EXPECT_EQ(read_bytes(out / "report.json"), former) << "a part takes no former run's place";
}

TEST(Interrupt, WhileATraceIsRecordedLeavesNothing) {
  const TempFolder folder;
  Program program({"trace", "record", "--resolution", "256x256", "--program", "full:256", "--threads", "2",
                   "--progress", "json", (folder.path() / "a.trace").string()});
  EXPECT_TRUE(wait_for_tiles(program));
  program.send(SIGINT);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 128 + SIGINT);
  EXPECT_TRUE(ending.err.ends_with("raywatt: interrupted\n")) << ending.err;
  EXPECT_EQ(names_in(folder.path()), Words{});
}

TEST(Interrupt, OfBenchLeavesNoScratchFolder) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const TempFolder folder;
    ProcessEnvironment around;
    around.variables = {{"TMPDIR", folder.path().string()}};
    Program program({"bench", "--scene", "cornell", "--resolution", "64x64", "--program", "full:16", "--runs", "1",
                     "--threads", "1"},
                    around);
    EXPECT_TRUE(program.wait_for_file(folder.path(), ""));
    program.send(signal);
    const ProcessResult ending = program.wait();
    EXPECT_EQ(ending.exit, 128 + signal);
    EXPECT_EQ(ending.err, "raywatt: interrupted\n");
    EXPECT_EQ(names_in(folder.path()), Words{});
  }
}

TEST(Interrupt, InTheReferenceKeepsTheRun) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  Program program({"run", "--resolution", "64x64", "--reference", "full:1024", "--threads", "2", "--progress", "json",
                   "-o", out.string()});
  EXPECT_TRUE(wait_for(program, "part", 1));
  program.send(SIGINT);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 128 + SIGINT);
  EXPECT_SAYS(ending.err, "kept the run without its reference in");
  const nlohmann::json report = read_json(out / "report.json");
  EXPECT_EQ(report["partial"], true);
  EXPECT_EQ(report["totals"]["rays"]["primary"], 64 * 64);
  EXPECT_FALSE(report["totals"].contains("relative"));
}

TEST(Interrupt, InReplicatesKeepsTheRunAndSpeaksOfThem) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  Program program({"run", "--resolution", "256x128", "--replicates", "100", "--threads", "1", "--progress", "json",
                   "-o", out.string()});
  EXPECT_TRUE(wait_for(program, "part", 1));
  program.send(SIGINT);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 128 + SIGINT);
  EXPECT_SAYS(ending.err, "raywatt: interrupted; kept the run without its replicates in " + out.string() + "\n");
  EXPECT_EQ(read_json(out / "report.json")["partial"], true);
}

TEST(Interrupt, OfAReplayKeepsTheFinishedPartOfTheFirstFrame) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  const std::string trace = (folder.path() / "a.trace").string();
  ASSERT_EQ(raywatt({"trace", "record", trace, "--resolution", "256x256", "--program", "full:9", "--quiet"}).exit, 0);
  Program program({"trace", "replay", trace, "--threads", "1", "--progress", "json", "-o", out.string()});
  EXPECT_TRUE(wait_for_tiles(program));
  program.send(SIGTERM);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 128 + SIGTERM);
  const nlohmann::json report = read_json(out / "report.json");
  EXPECT_EQ(report["partial"], true);
  const nlohmann::json& frame = report["frames"][0];
  EXPECT_GT(frame["finished_tiles"], 3);
  EXPECT_LT(frame["finished_tiles"], frame["tiles"]);
  EXPECT_EQ(frame["sampling"], nlohmann::json::object()) << "known of whole frames only";
  const std::size_t words = ending.err.find("raywatt: interrupted; kept " + frame["finished_tiles"].dump() + " of " +
                                            frame["tiles"].dump() + " tiles of frame 0 in " + out.string() + "\n");
  ASSERT_NE(words, std::string::npos) << ending.err;
  EXPECT_EQ(last_progress(ending.err.substr(0, words))["phase"], "interrupted");
  EXPECT_SAYS(read_bytes(out / "report.txt"), "PARTIAL");
  const auto [elapsed, why] = elapsed_and_why(report["units"]);
  EXPECT_EQ(elapsed, why) << "what is reported of the part adds up";
  EXPECT_EQ(names_in(out), (Words{"config.yaml", "intervals.bin.zst", "report.json", "report.txt", "tiles.json"}));
}

TEST(Interrupt, OfVerifyKeepsFinishedFrames) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  Program program({"verify", "--scene", "chess", "--set", "scene.triangles=5000", "--set", "scene.frame_rate=2",
                   "--frames", "0:100000", "--resolution", "64x32", "--threads", "1", "--progress", "json", "-o",
                   out.string()});
  EXPECT_TRUE(program.wait_until([](const std::string& err) { return last_progress(err).value("frame", 0) > 2; }));
  program.send(SIGINT);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 128 + SIGINT);
  const nlohmann::json report = read_json(out / "verify.json");
  EXPECT_EQ(report["partial"], true);
  EXPECT_GE(report["frames"].size(), 2U);
  EXPECT_SAYS(ending.err, "kept " + std::to_string(report["frames"].size()) + " of 100001 frames in");
  std::uint64_t rays = 0;
  for (const nlohmann::json& frame : report["frames"]) rays += frame["rays"].get<std::uint64_t>();
  EXPECT_EQ(report["rays"], rays);
  EXPECT_EQ(names_in(out), (Words{"embree.png", "image.png", "verify.json"}));
}

TEST(Interrupt, LeavesTheFormerRunAsItWas) {
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out)).exit, 0);
  const std::string former = read_bytes(out / "report.json");
  for (const int signal : {SIGINT, SIGKILL}) {
    EXPECT_EQ(interrupt_run(signal, out).exit, 128 + signal);
    EXPECT_EQ(read_bytes(out / "report.json"), former);
    EXPECT_EQ(names_in(folder.path()), Words{"out"});
  }
  EXPECT_EQ(raywatt(small_run(out)).exit, 0) << "the next run is not disturbed";
}

}  // namespace
}  // namespace test
