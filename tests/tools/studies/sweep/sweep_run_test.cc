#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/tools/studies/sweep/small_sweep.h"

// Tests of running sweeps from the command line.

namespace test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFour = "axes: {cores: [1, 2], tni.trvs: [2, 4]}\n";

Words lines_in(const fs::path& file) {
  Words lines;
  std::istringstream text(read_bytes(file));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

struct SweepRun : testing::Test {
  TempFolder folder;
  fs::path out = folder.path() / "out", store = folder.path() / "store";

  ProcessResult run(const std::string& lines, const Words& more = {}) {
    return raywatt(sweep_run(folder, write_sweep(folder, lines), more));
  }
  ProcessResult sweep(Words words) {
    words.insert(words.begin(), "sweep");
    return raywatt(words);
  }
};

TEST_F(SweepRun, ComputesEveryPointAsARunDoes) {
  const ProcessResult ending = run(kFour);
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(last_run_counts(out), (Tally{4, 4, 0, 0}));
  EXPECT_SAYS(ending.out, "busy");
  EXPECT_EQ(points_in(store), 4U);
  const Words lines = lines_in(out / "points.jsonl");
  ASSERT_EQ(lines.size(), 4U);
  const nlohmann::json last = nlohmann::json::parse(lines[3]);
  EXPECT_EQ(last["axes"], (nlohmann::json{{"cores", "2"}, {"tni.trvs", "4"}}));
  const std::string id = last["id"];
  const fs::path alone = folder.path() / "alone";
  raywatt({"run", "--resolution", "16x16", "--set", "cores=2", "--set", "tni.trvs=4", "--threads", "1", "-o", alone});
  EXPECT_EQ(comparable(read_json(store / "points" / id.substr(0, 2) / id / "report.json")),
            comparable(read_json(alone / "report.json")));
  EXPECT_EQ(read_bytes(store / "points" / id.substr(0, 2) / id / "config.yaml"), read_bytes(alone / "config.yaml"));
  EXPECT_EQ(names_in(store / "points" / id.substr(0, 2) / id), (Words{"config.yaml", "point.json", "report.json"}))
      << "no picture unless it is asked for";
}

TEST_F(SweepRun, KeepsItsFrameRateWhenItIsResumedBeforeItsPointsWereWritten) {
  ASSERT_EQ(run("axes: {cores: [1]}\n", {"--fps", "60"}).exit, 0);
  const std::string points = read_bytes(out / "points.jsonl");
  EXPECT_SAYS(points, "frame.fps=60");
  fs::remove(out / "points.jsonl");
  const ProcessResult ending = sweep({"run", "--resume", "-o", out});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "1 points: 0 computed, 1 found");
  EXPECT_EQ(read_bytes(out / "points.jsonl"), points);
  ASSERT_EQ(sweep({"run", folder.path() / "sweep.yaml", "--resume", "-o", out}).exit, 0);
  EXPECT_EQ(read_bytes(out / "points.jsonl"), points) << "also where the file is named";
}

TEST_F(SweepRun, LoadsASceneAnewWhereItsTexturesAreLaidOutOtherwise) {
  EXPECT_EQ(run("scene: teapot\naxes: {render.mip_maps: [on, off]}\n", {"-j", "1"}).exit, 0);
  Words traffic;
  for (const std::string& line : lines_in(out / "points.jsonl")) {
    const nlohmann::json point = nlohmann::json::parse(line);
    const std::string id = point["id"], mip_maps = point["axes"]["render.mip_maps"];
    const fs::path alone = folder.path() / mip_maps;
    raywatt({"run", "--scene", "teapot", "--resolution", "16x16", "--set", "render.mip_maps=" + mip_maps, "--threads",
             "1", "-o", alone});
    const nlohmann::json report = read_json(alone / "report.json");
    EXPECT_EQ(comparable(read_json(store / "points" / id.substr(0, 2) / id / "report.json")), comparable(report));
    traffic.push_back(report["totals"]["dram_bytes"].dump());
  }
  ASSERT_EQ(traffic.size(), 2U);
  EXPECT_NE(traffic[0], traffic[1]) << "or this shows nothing";
}

TEST_F(SweepRun, AgainComputesNothingAndLeavesEveryByte) {
  ASSERT_EQ(run(kFour).exit, 0);
  const std::string results = read_bytes(out / "results.csv"), points = read_bytes(out / "points.jsonl");
  const auto begin = std::chrono::steady_clock::now();
  run(kFour);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
  EXPECT_EQ(last_run_counts(out), (Tally{4, 0, 4, 0}));
  EXPECT_EQ(read_bytes(out / "results.csv"), results);
  EXPECT_EQ(read_bytes(out / "points.jsonl"), points);
  EXPECT_EQ(std::ranges::count(results, '\n'), 5);
}

TEST_F(SweepRun, WithAnotherValueComputesNewPointsOnly) {
  ASSERT_EQ(run(kFour).exit, 0);
  run("axes: {cores: [1, 2], tni.trvs: [2, 3, 4]}\n");
  EXPECT_EQ(last_run_counts(out), (Tally{6, 2, 4, 0}));
}

TEST_F(SweepRun, UsesWhatAnotherSweepHasComputed) {
  ASSERT_EQ(run(kFour).exit, 0);
  ProcessEnvironment around;
  around.variables = {{"RAYWATT_STORE", store.string()}};
  const fs::path file = write_sweep(folder, "axes: {tni.trvs: [4, 8]}\nsets: [cores=2]\n");
  raywatt({"sweep", "run", file, "-o", folder.path() / "other"}, around);
  EXPECT_EQ(last_run_counts(folder.path() / "other"), (Tally{2, 1, 1, 0}));
}

TEST_F(SweepRun, RecordsAPointThatFailsGoesOnAndEndsWithOne) {
  const std::string lines = "axes: {camera: ['0', absent]}\nsets: [cores=1]\n";
  const ProcessResult ending = run(lines);
  EXPECT_EQ(ending.exit, 1) << ending.err;
  EXPECT_EQ(last_run_counts(out), (Tally{2, 1, 0, 1}));
  EXPECT_SAYS(ending.out, "1     camera=absent: ");
  const std::string results = read_bytes(out / "results.csv");
  EXPECT_SAYS(results, ",done,");
  EXPECT_SAYS(results, ",failed,absent,");
  run(lines);
  EXPECT_EQ(last_run_counts(out), (Tally{2, 0, 1, 1})) << "not tried again";
  run(lines, {"--retry-failed"});
  EXPECT_EQ(last_run_counts(out), (Tally{2, 0, 1, 1}));
  const ProcessResult status = sweep({"status", out, "--json"});
  const auto json = nlohmann::json::parse(status.out);
  EXPECT_EQ(json["done"], 1);
  EXPECT_EQ(json["failed"], 1);
  EXPECT_EQ(json["failures"][0]["exit"], 2);
  EXPECT_EQ(json["missing"], 0);
}

TEST_F(SweepRun, PointsWhoseValuesDoNotGoTogetherFailAndOthersAreComputed) {
  const ProcessResult ending = run("axes: {tni.trv.l1.size: [64 B, 16 KiB]}\n");
  EXPECT_EQ(ending.exit, 1) << ending.err;
  EXPECT_EQ(last_run_counts(out), (Tally{2, 1, 0, 1}));
  EXPECT_SAYS(ending.out, "tni.trv.l1");
}

TEST_F(SweepRun, ComputesAPointOnceHoweverOftenItIsSaid) {
  const ProcessResult ending = run("axes: {tni.trv.l1.size: [16 KiB, 16384 B]}\n");
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_EQ(points_in(store), 1U);
  EXPECT_EQ(last_run_counts(out), (Tally{2, 1, 1, 0}));
}

TEST_F(SweepRun, ComputesADamagedPointAnew) {
  ASSERT_EQ(run(kFour).exit, 0);
  const std::string results = read_bytes(out / "results.csv");
  const std::string id = nlohmann::json::parse(lines_in(out / "points.jsonl")[1])["id"];
  const fs::path report = store / "points" / id.substr(0, 2) / id / "report.json";
  fs::resize_file(report, fs::file_size(report) / 2);
  EXPECT_EQ(nlohmann::json::parse(sweep({"status", out, "--json"}).out)["damaged"], 1);
  run(kFour);
  EXPECT_EQ(last_run_counts(out), (Tally{4, 1, 3, 0}));
  EXPECT_EQ(read_bytes(out / "results.csv"), results);
  EXPECT_EQ(names_in(store / "damaged"), Words{id + ".1"});
}

TEST_F(SweepRun, GoesOnWithoutItsFile) {
  ASSERT_EQ(run(kFour).exit, 0);
  fs::remove_all(store);
  EXPECT_SAYS(sweep({"run", "--resume", "-o", out, "-j", "1"}).out, "1 worker busy");
  EXPECT_EQ(last_run_counts(out), (Tally{4, 4, 0, 0}));
  EXPECT_EQ(points_in(store), 4U) << "in the store that the folder names";
}

TEST_F(SweepRun, GoesOnWithoutItsFileWhereItWasKilledBeforeItHadPoints) {
  ASSERT_EQ(run(kFour).exit, 0);
  const std::string points = read_bytes(out / "points.jsonl");
  fs::remove(out / "points.jsonl");
  EXPECT_SAYS(sweep({"run", "--resume", "-o", out, "--dry-run"}).out, "4 points, 4 of them in the store");
  EXPECT_FALSE(fs::exists(out / "points.jsonl"));
  EXPECT_EQ(sweep({"run", "--resume", "-o", out}).exit, 0);
  EXPECT_EQ(read_bytes(out / "points.jsonl"), points);
  fs::remove(out / "points.jsonl");
  std::ofstream(out / "sweep.yaml") << "schema: raywatt-sweep/1\nscene: gone.glb\n";
  expect_refusal(sweep({"run", "--resume", "-o", out}), {"sweep.yaml:2:8", "gone.glb"});
  EXPECT_FALSE(fs::exists(out / "points.jsonl"));
}

TEST_F(SweepRun, ListsItsPointsAndWritesNothing) {
  const ProcessResult ending = run(kFour, {"--dry-run"});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "4 points, 0 of them in the store");
  EXPECT_SAYS(ending.out, "to compute");
  EXPECT_FALSE(fs::exists(out));
  EXPECT_FALSE(fs::exists(store));
}

TEST_F(SweepRun, KeepsPicturesThatAreAskedFor) {
  ASSERT_EQ(run("image: yes\n").exit, 0);
  const std::string id = nlohmann::json::parse(lines_in(out / "points.jsonl")[0])["id"];
  EXPECT_TRUE(fs::exists(store / "points" / id.substr(0, 2) / id / "image.png"));
}

TEST_F(SweepRun, ComparesWithAReferenceAndGoesThroughFrames) {
  const ProcessResult ending =
      run("axes: {program: [full:1, 'multirate:under']}\nreference: full:4\nframes: 0:1\nscene: cornell\n");
  EXPECT_EQ(ending.exit, 0) << ending.err << ending.out;
  EXPECT_SAYS(lines_in(out / "results.csv")[0], "totals.psnr_db");
  const fs::path alone = folder.path() / "alone";
  const ProcessResult run_alone = raywatt({"run", "--resolution", "16x16", "--scene", "cornell", "--frames", "0:1",
                                           "--program", "multirate:under", "--reference", "full:4", "-o", alone});
  EXPECT_EQ(run_alone.exit, 0) << run_alone.err;
  const std::string id = nlohmann::json::parse(lines_in(out / "points.jsonl")[1])["id"];
  EXPECT_EQ(comparable(read_json(store / "points" / id.substr(0, 2) / id / "report.json")),
            comparable(read_json(alone / "report.json")));
}

TEST_F(SweepRun, RefusesAFolderOfOtherThingsAndOneThatIsRun) {
  fs::create_directories(out);
  std::ofstream(out / "thesis.txt") << "three years";
  expect_refusal(run(kFour), {"holds files but no sweep"});
  EXPECT_EQ(names_in(out), Words{"thesis.txt"});
  EXPECT_FALSE(fs::exists(store));
  expect_refusal(sweep({"status", folder.path() / "none"}), {"holds no sweep"});
}

TEST_F(SweepRun, PointsOfAListAreComputedByTheirIndex) {
  ASSERT_EQ(run(kFour).exit, 0);
  fs::remove_all(store);
  Words ids;
  for (const std::string& line : lines_in(out / "points.jsonl")) ids.push_back(nlohmann::json::parse(line)["id"]);
  const fs::path list = folder.write("list.txt", ids[3] + "\n" + ids[0] + "\n" + ids[1] + "\n");
  const auto point = [&](const char* index) {
    return sweep({"point", out, "--list", list, "--chunk", "2", "--index", index});
  };
  EXPECT_EQ(point("1").exit, 0);
  EXPECT_TRUE(fs::exists(store / "points" / ids[1].substr(0, 2) / ids[1]));
  EXPECT_EQ(points_in(store), 1U);
  EXPECT_EQ(point("0").exit, 0);
  EXPECT_EQ(points_in(store), 3U);
  EXPECT_EQ(point("0").exit, 0) << "there already";
  expect_refusal(point("2"), {"--index 2", "there are 2 chunks of 2 points"});
  folder.write("list.txt", "absent\n");
  expect_refusal(point("0"), {"list.txt:1: 'absent' is no point of this sweep"});
}

}  // namespace
}  // namespace test
