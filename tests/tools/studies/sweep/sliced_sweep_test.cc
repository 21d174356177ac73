#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/sha256.h"
#include "tests/tools/studies/sweep/small_sweep.h"
#include "tools/studies/sweep/store/store.h"

// Tests of sweeps whose points are computed slice by slice.

namespace test {
namespace {

namespace fs = std::filesystem;
using tools::sweep::Point;
using tools::sweep::Store;

/// Writes a sweep of two machines. Their frames of 256 tiles are split into four slices.
constexpr const char* kTwo =
    "schema: raywatt-sweep/1\nresolution: 64x64\nsets: [render.tile=4]\nslices: 4\naxes: {cores: [1, 2]}\n";
constexpr std::size_t kPoints = 2, kSlices = 4;

struct SlicedSweep : testing::Test {
  TempFolder folder;
  fs::path out = folder.path() / "out";
  Store store{folder.path() / "store"};

  ProcessResult run(const Words& more = {}, const std::string& lines = kTwo) {
    return raywatt(sweep_run(folder, folder.write("sweep.yaml", lines), more));
  }
  std::vector<Point> points() const {
    std::istringstream lines(read_bytes(out / "points.jsonl"));
    std::vector<Point> all;
    for (std::string line; std::getline(lines, line);) all.push_back(tools::sweep::parse_point_line(line, "points"));
    return all;
  }
  std::string table() const { return read_bytes(out / "results.csv"); }
  void forget(const Point& point) const { fs::remove_all(store.folder_of(point.id)); }
  std::string collect() const {
    const ProcessResult ending = raywatt({"sweep", "collect", out});
    EXPECT_EQ(ending.exit, 0) << ending.err;
    return ending.out + ending.err;
  }
  void expect_nothing_left_over() const {
    EXPECT_TRUE(names_in(store.root() / "tmp").empty());
    EXPECT_TRUE(names_in(store.root() / "locks").empty());
  }
};

/// Returns the table of the sweep after an undisturbed run.
const std::string& undisturbed_results() {
  static const std::string table = [] {
    const TempFolder folder;
    EXPECT_EQ(raywatt(sweep_run(folder, folder.write("sweep.yaml", kTwo), {"-j", "2"})).exit, 0);
    return read_bytes(folder.path() / "out" / "results.csv");
  }();
  return table;
}

TEST_F(SlicedSweep, AReportIsThatOfARunInSlices) {
  const ProcessResult ending = run({"-j", "2"});
  ASSERT_EQ(ending.exit, 0) << ending.err << ending.out;
  EXPECT_SAYS(ending.out, "2 points: 2 computed, 0 found, 0 failed");
  EXPECT_EQ(points_in(store.root()), kPoints + kPoints * kSlices);
  for (const Point& point : points()) {
    const fs::path alone = folder.path() / point.id;
    const ProcessResult one = raywatt({"run", "--resolution", "64x64", "--set", "render.tile=4", "--set",
                                       "cores=" + point.axes[0].second, "--slices", "4", "-o", alone});
    ASSERT_EQ(one.exit, 0) << one.err;
    const nlohmann::json joined = read_json(store.folder_of(point.id) / "report.json");
    EXPECT_EQ(comparable(joined), comparable(read_json(alone / "report.json")));
    EXPECT_EQ(joined["totals"]["sliced"]["slices"], 4);
    EXPECT_EQ(joined["host"]["slices_s"].size(), kSlices);
    EXPECT_GT(joined["host"]["rays_per_s"], 0);
    EXPECT_EQ(read_bytes(store.folder_of(point.id) / "config.yaml"), read_bytes(alone / "config.yaml"));
  }
  EXPECT_EQ(std::ranges::count(table(), '\n'), 3) << "a row a point";
  EXPECT_EQ(run().exit, 0);
  EXPECT_EQ(last_run_counts(out), (Tally{2, 0, 2, 0}));
  expect_nothing_left_over();
  const ProcessResult best = raywatt({"sweep", "best", out, "--max", "fps"});
  EXPECT_EQ(best.exit, 0) << best.err;
  EXPECT_SAYS(best.out, "--slices 4");
}

TEST_F(SlicedSweep, FramesOfAnAnimationAreJoinedOneByOne) {
  const std::string lines = std::string(kTwo) + "scene: cornell\nframes: 0:1\nwhere: [{cores: 1}]\n";
  ASSERT_EQ(run({"-j", "2"}, lines).exit, 0);
  const fs::path alone = folder.path() / "alone";
  ASSERT_EQ(raywatt({"run", "--scene", "cornell", "--frames", "0:1", "--resolution", "64x64", "--set", "render.tile=4",
                     "--set", "cores=1", "--slices", "4", "-o", alone})
                .exit,
            0);
  EXPECT_EQ(comparable(read_json(store.folder_of(points()[0].id) / "report.json")),
            comparable(read_json(alone / "report.json")));
}

TEST_F(SlicedSweep, NothingDependsOnTheOrderOfSlicesAndOnWhoComputesThem) {
  ASSERT_EQ(run({"-j", "1"}).exit, 0);
  EXPECT_EQ(table(), undisturbed_results());
  fs::remove_all(store.root());
  const auto point = [&](int index) { return raywatt({"sweep", "point", out, "--index", std::to_string(index)}); };
  for (int index = kPoints * kSlices - 1; index > 0; --index) EXPECT_EQ(point(index).exit, 0) << index;
  EXPECT_EQ(points_in(store.root()), 1 + kPoints * kSlices - 1) << "one is joined, one lacks a slice";
  EXPECT_SAYS(collect(), "2 points: 1 done, 1 missing");
  EXPECT_EQ(point(0).exit, 0);
  EXPECT_EQ(points_in(store.root()), kPoints + kPoints * kSlices);
  EXPECT_SAYS(collect(), "2 points: 2 done");
  EXPECT_EQ(table(), undisturbed_results());
  expect_refusal(point(kPoints * kSlices), {"--index 8", "there are 8 chunks"});
  const fs::path list = folder.write("list.txt", points()[1].id + " " + slices_of(points()[0])[2].id + "\n");
  fs::remove_all(store.root());
  EXPECT_EQ(raywatt({"sweep", "point", out, "--list", list, "--index", "0"}).exit, 0) << "a whole point, and a slice";
  EXPECT_EQ(points_in(store.root()), 1 + kSlices + 1);
}

TEST_F(SlicedSweep, TwoSweepsOnOneStoreShareTheSlicesOfAPoint) {
  sweep_twice_at_once(folder, folder.write("sweep.yaml", kTwo));
  EXPECT_EQ(table(), undisturbed_results());
  EXPECT_EQ(read_bytes(folder.path() / "second" / "results.csv"), undisturbed_results());
  EXPECT_EQ(points_in(store.root()), kPoints + kPoints * kSlices);
  expect_nothing_left_over();
}

TEST_F(SlicedSweep, KilledAgainAndAgainItEndsWithTheSameTable) {
  std::size_t before = 0;
  int kills = 0;
  for (int round = 0; round < 20 && kills < 4; ++round) {
    Program program(sweep_run(folder, folder.write("sweep.yaml", kTwo), {"-j", "2"}));
    EXPECT_TRUE(wait_until([&] { return program.ended() || points_in(store.root()) > before; }));
    program.send(SIGKILL);  // its workers end with it
    kills += program.wait().exit == 128 + SIGKILL;
    EXPECT_GE(points_in(store.root()), before) << "nothing is lost";
    before = points_in(store.root());
  }
  EXPECT_GE(kills, 2) << "the sweep is too small to be killed";
  EXPECT_EQ(run({"-j", "2"}).exit, 0);
  EXPECT_EQ(table(), undisturbed_results());
  EXPECT_EQ(points_in(store.root()), kPoints + kPoints * kSlices);
  expect_nothing_left_over();
}

TEST_F(SlicedSweep, SlicesThatNobodyHasJoinedAreJoinedByCollectAndByTheNextRun) {
  ASSERT_EQ(run().exit, 0);
  const std::vector<Point> all = points();
  forget(all[1]);
  EXPECT_SAYS(raywatt({"sweep", "status", out}).out, "2 points: 1 done, 0 failed, 1 missing (0 of them");
  EXPECT_SAYS(raywatt({"sweep", "status", out}).out, "of their slices 4 of 4 are done");
  EXPECT_SAYS(collect(), "2 points: 2 done");
  EXPECT_EQ(table(), undisturbed_results());
  forget(all[0]);
  ASSERT_EQ(run().exit, 0);
  EXPECT_EQ(table(), undisturbed_results());
  expect_nothing_left_over();
}

TEST_F(SlicedSweep, ASliceThatIsMissingOrDamagedIsComputedAlone) {
  ASSERT_EQ(run().exit, 0);
  const std::vector<Point> slices = slices_of(points()[1]);
  const auto written = [&](std::size_t s) { return fs::last_write_time(store.folder_of(slices[s].id) / "slice.json"); };
  const auto others = std::vector{written(0), written(1)};
  forget(points()[1]);
  forget(slices[2]);
  std::ofstream(store.folder_of(slices[3].id) / "slice.json", std::ios::app) << " ";
  EXPECT_SAYS(collect(), "2 points: 1 done, 1 missing");
  const ProcessResult plan = run({"--dry-run"});
  EXPECT_SAYS(plan.out, "to compute, 2 of 4 slices in the store");
  EXPECT_SAYS(plan.out, "2 points, 1 of them in the store");
  ASSERT_EQ(run().exit, 0);
  EXPECT_EQ(last_run_counts(out), (Tally{2, 1, 1, 0}));
  EXPECT_EQ(table(), undisturbed_results());
  EXPECT_EQ((std::vector{written(0), written(1)}), others);
  EXPECT_EQ(names_in(store.root() / "damaged"), Words{slices[3].id + ".1"});
}

TEST_F(SlicedSweep, ASliceWhoseWorkerCrashesFailsItsPointUntilItIsComputedAnew) {
  const std::string lines =
      "schema: raywatt-sweep/1\nresolution: 160x160\nprogram: full:16\nsets: [render.tile=8]\nslices: 3\n";
  Program program(sweep_run(folder, folder.write("sweep.yaml", lines), {"-j", "1"}));
  EXPECT_TRUE(wait_until([&] { return fs::exists(store.root() / "tmp") && !names_in(store.root() / "tmp").empty(); }));
  std::ifstream children("/proc/" + std::to_string(program.process()) + "/task/" + std::to_string(program.process()) +
                         "/children");
  pid_t worker = 0;
  ASSERT_TRUE(children >> worker);
  ::kill(worker, SIGSEGV);
  const ProcessResult ending = program.wait();
  EXPECT_EQ(ending.exit, 1) << ending.err;
  EXPECT_SAYS(ending.out, "slice 1 of 3: the worker crashed: Segmentation fault");
  EXPECT_SAYS(table(), ",failed,");
  EXPECT_EQ(points_in(store.root()), 2U) << "the others are there";
  EXPECT_EQ(run({}, lines).exit, 1) << "fails again without being computed";
  fs::remove(store.failure_file(points()[0].id));
  EXPECT_SAYS(collect(), "1 points: 0 done, 1 failed");
  EXPECT_EQ(run({"--retry-failed"}, lines).exit, 0);
  EXPECT_EQ(last_run_counts(out), (Tally{1, 1, 0, 0}));
  EXPECT_EQ(points_in(store.root()), 4U);
  EXPECT_SAYS(table(), ",done,");
}

TEST_F(SlicedSweep, APointFailsWithItsFirstSliceThatDoes) {
  const ProcessResult ending = run({"-j", "1"}, std::string(kTwo) + "camera: absent\nwhere: [{cores: 1}]\n");
  EXPECT_EQ(ending.exit, 1);
  EXPECT_SAYS(ending.out, "slice 1 of 4: ");
  fs::remove_all(store.root());
  EXPECT_EQ(raywatt({"sweep", "point", out, "--index", "2"}).exit, 1);
  const std::string status = raywatt({"sweep", "status", out}).out;
  EXPECT_SAYS(status, "1 points: 0 done, 1 failed");
  EXPECT_SAYS(status, "slice 3 of 4: ");
  EXPECT_SAYS(status, "absent");
}

TEST_F(SlicedSweep, ASliceThatIsNoneFailsItsPoint) {
  ASSERT_EQ(run().exit, 0);
  const fs::path at = store.folder_of(slices_of(points()[0])[1].id);
  const std::string whole = read_bytes(at / "slice.json");
  const auto put = [&](const std::string& text) {
    std::ofstream(at / "slice.json") << text;
    auto description = nlohmann::ordered_json::parse(read_bytes(at / "point.json"));
    description["files"]["slice.json"] = sim::sha256_hex(text);
    std::ofstream(at / "point.json") << description.dump();
    forget(points()[0]);
  };
  auto other = nlohmann::ordered_json::parse(whole);
  other["frames"][0]["units"][2]["path"] = "gpu";
  for (const std::string& bad :
       std::vector<std::string>{"{", "[]", "{\"frames\":[]}", other.dump(), std::string(100'000, '[')}) {
    put(bad);
    const ProcessResult ending = run({"--retry-failed"});
    EXPECT_EQ(ending.exit, 1) << bad.substr(0, 20) << ending.err;
    EXPECT_EQ(last_run_counts(out), (Tally{2, 0, 1, 1})) << bad.substr(0, 20);
  }
  put(whole);
  EXPECT_EQ(run({"--retry-failed"}).exit, 0);
  EXPECT_EQ(table(), undisturbed_results());
}

TEST(SlicesOfPoints, HaveNamesOfTheirOwnAndAreReadFromTheirLines) {
  const std::vector<Point> whole = points_of("sets: [render.tile=2, cores=1]\n"),
                           cut = points_of("sets: [render.tile=2, cores=1]\nslices: 3\n"),
                           more = points_of("sets: [render.tile=2, cores=1]\nslices: 4\n");
  ASSERT_EQ(cut[0].error, "");
  EXPECT_NE(whole[0].id, cut[0].id);
  EXPECT_NE(more[0].id, cut[0].id);
  EXPECT_TRUE(cut[0].stream.empty());
  EXPECT_TRUE(slices_of(whole[0]).empty());
  const std::vector<Point> slices = slices_of(cut[0]);
  ASSERT_EQ(slices.size(), 3U);
  EXPECT_NE(slices[0].id, slices[1].id);
  EXPECT_NE(slices[0].id, slices_of(more[0])[0].id);
  EXPECT_TRUE(slices_of(slices[0]).empty());
  EXPECT_EQ(format_point_line(whole_point_of(slices[2])), format_point_line(cut[0]));
  const std::string line = format_point_line(slices[1]);
  EXPECT_EQ(format_point_line(tools::sweep::parse_point_line(line, "here")), line);
  for (const char* bad : {R"("slice":4)", R"("slice":0)"}) {
    std::string damaged = line;
    damaged.replace(damaged.find("\"slice\":2"), 9, bad);
    EXPECT_THROW(tools::sweep::parse_point_line(damaged, "here"), sim::InputError) << bad;
  }
}

TEST(SlicesOfPoints, WhatDoesNotGoWithThemIsRefused) {
  const auto refused = [](const std::string& lines) { return complaint_of("slices: 2\n" + lines); };
  EXPECT_SAYS(refused("reference: full:1\n"), "sweep.yaml:3:9: slices: does not go with reference");
  EXPECT_SAYS(refused("tile_sampling: 5%\n"), "slices: does not go with tile_sampling");
  EXPECT_SAYS(refused("replicates: 2\n"), "slices: does not go with replicates");
  EXPECT_SAYS(refused("image: yes\n"), "slices: does not go with image");
  EXPECT_SAYS(refused("program: undersample\n"), "sweep.yaml:4:10: program: --slices: tiles of");
  EXPECT_SAYS(refused("axes: {program: [full:1, undersample]}\n"), "axes.program: --slices: tiles of");
  EXPECT_SAYS(complaint_of("slices: 1\n"), "sweep.yaml:3:9: slices");
  EXPECT_SAYS(complaint_of("slices: auto\n"), "sweep.yaml:3:9: slices");
}

TEST(SlicesOfPoints, MoreThanAFrameAllowsAreImpossible) {
  const std::vector<Point> points = points_of("slices: 9\naxes: {render.tile: [2, 8], cores: [1]}\n");
  EXPECT_EQ(points[0].error, "") << "64 tiles";
  EXPECT_SAYS(points[1].error, "--slices 9: too many for a frame of 4 tiles");
  EXPECT_TRUE(slices_of(points[1]).empty());
  const std::vector<Point> rastered = points_of("slices: 2\nsets: [render.tile=2, render.primary=raster]\n");
  EXPECT_SAYS(rastered[0].error, "render.primary=rays");
}

}  // namespace
}  // namespace test
