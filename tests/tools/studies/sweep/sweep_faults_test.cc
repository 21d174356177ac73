#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <sys/mount.h>

#include "tests/tools/studies/sweep/small_sweep.h"

// Tests of faults that a sweep survives.

namespace test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTwelve = "axes: {cores: [1, 2], tni.trvs: [1, 2, 4], tni.trv.rays: [8, 16]}\n";
constexpr std::size_t kTwelvePoints = 12;

/// Returns the child processes of a process.
std::vector<pid_t> children_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/task/" + std::to_string(process) + "/children");
  std::vector<pid_t> children;
  for (pid_t child = 0; file >> child;) children.push_back(child);
  return children;
}

struct SweepFaults : testing::Test {
  TempFolder folder;
  fs::path out = folder.path() / "out", store = folder.path() / "store";

  /// Returns results.csv of the same sweep after an undisturbed run with its own store.
  std::string undisturbed_results(const std::string& lines) {
    const TempFolder other;
    EXPECT_EQ(raywatt(sweep_run(other, write_sweep(other, lines))).exit, 0);
    return read_bytes(other.path() / "out" / "results.csv");
  }
  void expect_nothing_left_over() {
    EXPECT_TRUE(names_in(store / "tmp").empty());
    EXPECT_TRUE(names_in(store / "locks").empty());
    EXPECT_TRUE(!fs::exists(store / "streams") || names_in(store / "streams").empty());
    EXPECT_FALSE(fs::exists(store / "damaged"));
  }
};

TEST_F(SweepFaults, AFolderRenamedDuringTheRunIsNamedWithWhatToDo) {
  const fs::path file = write_sweep(folder, kTwelve), moved = folder.path() / "moved";
  {
    Program program(sweep_run(folder, file, {"-j", "1"}));
    EXPECT_TRUE(wait_until([&] { return program.ended() || points_in(store) >= 1; }));
    fs::rename(out, moved);
    const ProcessResult ending = program.wait();
    EXPECT_EQ(ending.exit, 74);
    EXPECT_EQ(ending.err, "raywatt: " + out.string() +
                              ": was moved or removed during the run; computed points are in " + store.string() +
                              "; move it back and type the same command again\n");
  }
  fs::rename(moved, out);
  ASSERT_EQ(raywatt(sweep_run(folder, file)).exit, 0);
  EXPECT_EQ(last_run_counts(out), (Tally{12, 0, 12, 0}));
  EXPECT_EQ(read_bytes(out / "results.csv"), undisturbed_results(kTwelve));
}

TEST_F(SweepFaults, KilledAgainAndAgainItEndsWithTheSameTable) {
  const fs::path file = write_sweep(folder, kTwelve);
  std::size_t before = 0;
  int kills = 0;
  for (std::uint64_t round = 0; kills < 5 && before < kTwelvePoints; ++round) {
    Program program(sweep_run(folder, file, {"-j", "2"}));
    const std::size_t wanted = before + round % 3;
    EXPECT_TRUE(wait_until(
        [&] { return program.ended() || (points_in(store) >= wanted && !children_of(program.process()).empty()); }));
    const std::vector<pid_t> workers = children_of(program.process());
    program.send(SIGKILL);
    for (const pid_t worker : workers) ::kill(worker, SIGKILL);
    kills += program.wait().exit == 128 + SIGKILL;
    EXPECT_GE(points_in(store), before) << "nothing is lost";
    before = points_in(store);
  }
  EXPECT_GE(kills, 2) << "the sweep is too small to be killed";
  const ProcessResult last = raywatt(sweep_run(folder, file, {"-j", "2"}));
  EXPECT_EQ(last.exit, 0) << last.err << last.out;
  EXPECT_GE(last_run_counts(out)[2], static_cast<int>(before));
  EXPECT_EQ(points_in(store), kTwelvePoints);
  EXPECT_EQ(read_bytes(out / "results.csv"), undisturbed_results(kTwelve));
  expect_nothing_left_over();
}

TEST_F(SweepFaults, WhatAKilledProcessWasWritingIsRemovedByTheNextRun) {
  const fs::path file = write_sweep(folder, kTwelve);
  ASSERT_EQ(raywatt(sweep_run(folder, file)).exit, 0);
  const auto left = [&](const char* name) { return out / name; };
  for (const char* name : {"results.4194305-0.raywatt-tmp.csv", "index.4194305-0.raywatt-tmp.sqlite",
                           "sweep.4194305-0.raywatt-tmp.json"}) {
    std::ofstream(left(name)) << "half";
  }
  std::ofstream(left("notes.4194305-0.raywatt-tmp.csv")) << "another's";
  EXPECT_EQ(raywatt(sweep_run(folder, file)).exit, 0);
  EXPECT_FALSE(fs::exists(left("results.4194305-0.raywatt-tmp.csv")));
  EXPECT_FALSE(fs::exists(left("index.4194305-0.raywatt-tmp.sqlite")));
  EXPECT_FALSE(fs::exists(left("sweep.4194305-0.raywatt-tmp.json")));
  EXPECT_TRUE(fs::exists(left("notes.4194305-0.raywatt-tmp.csv")));
}

TEST_F(SweepFaults, TwoSweepsOnOneStoreComputeEachPointOnce) {
  sweep_twice_at_once(folder, write_sweep(folder, kTwelve));
  EXPECT_EQ(last_run_counts(out)[1] + last_run_counts(folder.path() / "second")[1], static_cast<int>(kTwelvePoints));
  EXPECT_EQ(read_bytes(out / "results.csv"), read_bytes(folder.path() / "second" / "results.csv"));
  EXPECT_EQ(read_bytes(out / "results.csv"), undisturbed_results(kTwelve));
  expect_nothing_left_over();
}

TEST_F(SweepFaults, TwoRunsOfOneFolderAreRefused) {
  const fs::path file = write_sweep(folder, "program: full:256\naxes: {resolution: [256x256]}\n");
  Program first(sweep_run(folder, file));
  EXPECT_TRUE(wait_until([&] { return fs::exists(out / "lock") && fs::exists(out / "points.jsonl"); }));
  const std::string points = read_bytes(out / "points.jsonl");
  const ProcessResult second = raywatt(sweep_run(folder, write_sweep(folder, kTwelve)));
  expect_refusal(second, {"another process is running this sweep"});
  EXPECT_EQ(read_bytes(out / "points.jsonl"), points);
}

TEST_F(SweepFaults, InterruptedItKeepsWhatIsFinished) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const fs::path file = write_sweep(folder, "axes:\n  resolution: [16x16, 16x32, 512x512]\n  program: [full:64]\n");
    Program program(sweep_run(folder, file, {"-j", "1", "--progress", "json"}));
    EXPECT_TRUE(program.wait_until([](const std::string& err) { return err.find("\"tile\":2") != std::string::npos; }));
    program.send(signal);
    const ProcessResult ending = program.wait();
    EXPECT_EQ(ending.exit, 128 + signal) << ending.err;
    EXPECT_SAYS(ending.err, "raywatt: interrupted; kept 2 of 3 points in " + out.string());
    EXPECT_SAYS(read_bytes(out / "results.csv"), ",missing,512x512,");
    EXPECT_EQ(points_in(store), 2U);
    expect_nothing_left_over();
  }
}

TEST_F(SweepFaults, CancelStopsWhoRunsIt) {
  const fs::path file = write_sweep(folder, "axes:\n  resolution: [16x16, 512x512]\n  program: [full:64]\n");
  Program program(sweep_run(folder, file, {"-j", "1", "--progress", "json"}));
  EXPECT_TRUE(program.wait_until([](const std::string& err) { return err.find("\"tile\":1") != std::string::npos; }));
  EXPECT_SAYS(raywatt({"sweep", "status", out}).out, "run by process " + std::to_string(program.process()));
  EXPECT_SAYS(raywatt({"sweep", "cancel", out}).out, "cancelled");
  EXPECT_EQ(program.wait().exit, 128 + SIGTERM);
  EXPECT_SAYS(raywatt({"sweep", "cancel", out}).out, "no process is running this sweep");
  EXPECT_EQ(points_in(store), 1U);
}

TEST_F(SweepFaults, AWorkerThatCrashesTakesOnlyItsPoint) {
  const fs::path file = write_sweep(folder, "axes:\n  resolution: [256x256, 16x16, 16x32]\n  program: [full:64]\n");
  Program program(sweep_run(folder, file, {"-j", "1"}));
  EXPECT_TRUE(wait_until([&] { return fs::exists(store / "tmp") && !names_in(store / "tmp").empty(); }));
  ASSERT_EQ(children_of(program.process()).size(), 1U);
  ::kill(children_of(program.process())[0], SIGSEGV);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 1) << ending.err;
  EXPECT_EQ(last_run_counts(out), (Tally{3, 2, 0, 1}));
  EXPECT_SAYS(ending.out, "the worker crashed: Segmentation fault");
  const ProcessResult status = raywatt({"sweep", "status", "--json", out});
  EXPECT_EQ(nlohmann::json::parse(status.out)["failures"][0]["exit"], 128 + SIGSEGV);
}

TEST_F(SweepFaults, AWorkerThatSomebodyKillsIsTriedAgain) {
  const fs::path file = write_sweep(folder, "axes:\n  resolution: [128x128, 16x16]\n  program: [full:16]\n");
  Program program(sweep_run(folder, file, {"-j", "1"}));
  EXPECT_TRUE(wait_until([&] { return fs::exists(store / "tmp") && !names_in(store / "tmp").empty(); }));
  ASSERT_EQ(children_of(program.process()).size(), 1U);
  ::kill(children_of(program.process())[0], SIGKILL);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(last_run_counts(out), (Tally{2, 2, 0, 0}));
  expect_nothing_left_over();
}

/// A file system of limited size that exists during a test.
class SmallDisk {
 public:
  explicit SmallDisk(fs::path path) : path_(std::move(path)) {
    fs::create_directories(path_);
    mounted_ = ::mount("none", path_.c_str(), "tmpfs", 0, "size=600k") == 0;
  }
  ~SmallDisk() {
    if (mounted_) ::umount2(path_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool is_mounted() const { return mounted_; }
  void grow() const { EXPECT_EQ(::mount("none", path_.c_str(), "tmpfs", MS_REMOUNT, "size=64m"), 0); }

 private:
  const fs::path path_;
  bool mounted_ = false;
};

TEST_F(SweepFaults, AFullDiskStopsItAndItGoesOnOnceThereIsRoom) {
  const SmallDisk disk(store);
  if (!disk.is_mounted()) GTEST_SKIP() << "needs the right to mount a small file system";
  const fs::path file = write_sweep(folder, kTwelve);
  const ProcessResult full = raywatt(sweep_run(folder, file, {"-j", "2"}));
  EXPECT_EQ(full.exit, 74) << full.err;
  EXPECT_SAYS(full.err, "No space left on device");
  EXPECT_EQ(std::ranges::count(full.err, '\n'), 1) << full.err;
  EXPECT_LT(points_in(store), kTwelvePoints);
  EXPECT_GT(points_in(store), 0U);
  EXPECT_EQ(raywatt(sweep_run(folder, file, {"-j", "2"})).exit, 74) << "still full";
  disk.grow();
  const ProcessResult more = raywatt(sweep_run(folder, file, {"-j", "2"}));
  EXPECT_EQ(more.exit, 0) << more.err << more.out;
  EXPECT_GT(last_run_counts(out)[2], 0);
  EXPECT_EQ(read_bytes(out / "results.csv"), undisturbed_results(kTwelve));
  expect_nothing_left_over();
}

TEST_F(SweepFaults, LinksOfTheNamesOfItsFilesAreRefused) {
  const fs::path file = write_sweep(folder, "axes: {cores: [1]}\n"), precious = folder.path() / "precious";
  ASSERT_EQ(raywatt(sweep_run(folder, file)).exit, 0);
  std::ofstream(precious) << "three years";
  for (const char* name : {"results.csv", "index.sqlite", "points.jsonl"}) {
    const std::string bytes = read_bytes(out / name);
    fs::remove(out / name);
    fs::create_symlink(precious, out / name);
    expect_refusal(raywatt(sweep_run(folder, file)), {name, "is a link"});
    EXPECT_TRUE(fs::is_symlink(out / name));
    fs::remove(out / name);
    std::ofstream(out / name) << bytes;
  }
  EXPECT_EQ(read_bytes(precious), "three years");
}

TEST_F(SweepFaults, HostileFilesInItsFolderAreRefused) {
  ASSERT_EQ(raywatt(sweep_run(folder, write_sweep(folder, "axes: {cores: [1]}\n"))).exit, 0);
  const std::string line = read_bytes(out / "points.jsonl");
  for (const std::string& bad : std::vector<std::string>{"{", "[]\n", line + line, "{\"n\":0,\"id\":\"../../x\"}\n",
                                                         line.substr(0, line.size() / 2)}) {
    std::ofstream(out / "points.jsonl") << bad;
    expect_refusal(raywatt({"sweep", "status", out}), {"points.jsonl:"});
  }
  std::ofstream(out / "sweep.json") << "{\"schema\": 3}";
  expect_refusal(raywatt({"sweep", "status", out}), {"sweep"});
  std::ofstream(out / "sweep.json") << std::string(200'000, '[');
  expect_refusal(raywatt({"sweep", "status", out}), {"sweep.json", "nested"});
}

}  // namespace
}  // namespace test
