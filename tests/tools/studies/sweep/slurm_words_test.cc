#include <algorithm>
#include <csignal>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/studies/sweep/small_sweep.h"
#include "tools/studies/sweep/launch/slurm.h"

// Tests of calling Slurm's commands, with shell scripts in their place. tests/slurm tests the real commands.

namespace test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFourPoints = "axes: {cores: [1, 2], tni.trvs: [2, 4]}\n";

struct SlurmWords : testing::Test {
  TempFolder folder;
  fs::path out = folder.path() / "out";

  /// Writes a command that records its arguments, one line each, and then runs these lines of shell.
  void command(const std::string& name, const std::string& lines) {
    fs::create_directories(folder.path() / "bin");
    const fs::path file = folder.write("bin/" + name, "#!/bin/sh\nprintf '%s\\n' \"$@\" >>" +
                                                          (folder.path() / name).string() + ".said\n" + lines + "\n");
    fs::permissions(file, fs::perms::owner_all);
  }
  std::string said_to(const std::string& name) { return read_bytes(folder.path() / (name + ".said")); }

  /// A fake Slurm that accepts every command and does nothing.
  void idle_slurm() {
    command("squeue", "");
    command("scontrol", "echo 'MaxArraySize            = 1001'");
    command("sbatch", "echo '12;cluster'");
    command("scancel", "");
  }
  ProcessResult with_commands(const Words& words) {
    ProcessEnvironment around;
    around.variables = {{"PATH", (folder.path() / "bin").string() + ":/usr/bin:/bin"}};
    return raywatt(words, around);
  }
  ProcessResult run(const Words& more = {}, const char* lines = kFourPoints) {
    Words words = sweep_run(folder, write_sweep(folder, lines), {"--launcher", "slurm"});
    words.insert(words.end(), more.begin(), more.end());
    return with_commands(words);
  }
};

TEST_F(SlurmWords, AJobArrayIsHandedInAndTheCommandReturns) {
  idle_slurm();
  const ProcessResult ending = run({"--chunk", "1", "-j", "3", "--slurm-args", "--time=1:00:00 --partition=fat"});
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_SAYS(ending.out, "4 points: 4 handed in, 0 in the queue already, 0 with a result");
  EXPECT_SAYS(ending.out, "4 of job 12\n");
  const std::string said = said_to("sbatch");
  for (const char* word : {"--parsable\n", "--array=0-3%3\n", "--requeue\n", "--time=1:00:00\n--partition=fat\n"}) {
    EXPECT_SAYS(said, word);
  }
  EXPECT_TRUE(said.ends_with("/out/submit-1.sh\n")) << said;
  const std::string list = read_bytes(out / "submit-1.txt");
  EXPECT_EQ(std::ranges::count(list, '\n'), 4);
  EXPECT_SAYS(read_bytes(out / "submit-1.sh"), "sweep point");
}

TEST_F(SlurmWords, SlicesOfAPointAreHandedInLikePoints) {
  constexpr const char* kCut = "slices: 4\nsets: [render.tile=2]\naxes: {cores: [1, 2]}\n";
  idle_slurm();
  command(
      "sbatch",
      "for script; do :; done; for task in 7 6 5 4 3 2 1 0; do SLURM_ARRAY_TASK_ID=$task sh $script; done; echo 12");
  const ProcessResult begun = run({"--chunk", "1"}, kCut);
  EXPECT_EQ(begun.exit, 0) << begun.err;
  EXPECT_SAYS(begun.out, "2 points, 8 slices: 8 handed in, 0 in the queue already, 0 with a result");
  EXPECT_SAYS(said_to("sbatch"), "--array=0-7\n");
  const ProcessResult done = run({"--chunk", "1"}, kCut);
  EXPECT_EQ(done.exit, 0) << done.err;
  EXPECT_SAYS(done.out, "2 points: 0 computed, 2 found, 0 failed");
  EXPECT_FALSE(fs::exists(out / "submit-2.sh"));
  const fs::path file = write_sweep(folder, kCut);
  const std::string table = read_bytes(out / "results.csv");
  fs::remove_all(folder.path() / "store");
  ASSERT_EQ(raywatt(sweep_run(folder, file)).exit, 0);
  EXPECT_EQ(read_bytes(out / "results.csv"), table);
}

TEST_F(SlurmWords, CommandsAreEndedByThePipesTheyWriteInto) {
  idle_slurm();
  command("sbatch", "sed -n 's/SigIgn:.//p' /proc/$$/status >" + (folder.path() / "ignored").string() + "; echo 12");
  EXPECT_EQ(run().exit, 0);
  const std::uint64_t ignored = std::stoull(read_bytes(folder.path() / "ignored"), nullptr, 16);
  for (const int signal : {SIGPIPE, SIGXFSZ}) EXPECT_EQ(ignored >> (signal - 1) & 1, 0U) << signal;
}

TEST_F(SlurmWords, WhatIsInTheQueueIsNotHandedInAgain) {
  idle_slurm();
  ASSERT_EQ(run({"--chunk", "1"}).exit, 0);
  command("squeue", "echo '12|1|PENDING|Priority||" + (fs::canonical(out) / "submit-1.sh").string() +
                        "'; echo '9|0|RUNNING|None|n1|/else/submit-1.sh'; echo '10|N/A|RUNNING|None|n1|/else/job'");
  EXPECT_SAYS(run({"--chunk", "3"}).out, "4 points: 3 handed in, 1 in the queue already");
  EXPECT_EQ(std::ranges::count(read_bytes(out / "submit-2.txt"), '\n'), 1);
  const ProcessResult status = with_commands({"sweep", "status", out});
  EXPECT_SAYS(status.out, "in Slurm's queue: 0 tasks running, 1 waiting (Priority), of jobs 12\n");
  EXPECT_EQ(nlohmann::json::parse(with_commands({"sweep", "status", out, "--json"}).out)["slurm"]["waiting"], 1);
}

TEST_F(SlurmWords, ArraysAreNoLargerThanSlurmAllows) {
  idle_slurm();
  command("scontrol", "echo 'MaxArraySize = 3'");
  EXPECT_EQ(run({"--chunk", "1"}).exit, 0);
  const std::string said = said_to("sbatch");
  EXPECT_SAYS(said, "--array=0-2\n");
  EXPECT_SAYS(said, "--array=0-0\n");
}

TEST_F(SlurmWords, ARefusalIsToldInSlurmsWordsAndLeavesNothing) {
  idle_slurm();
  command("sbatch", "echo 'sbatch: error: invalid partition specified: fat' >&2; exit 1");
  expect_refusal(run(), {"sbatch: error: invalid partition specified: fat"});
  EXPECT_FALSE(fs::exists(out / "submit-1.sh"));
  EXPECT_FALSE(fs::exists(out / "submit-1.txt"));
}

TEST_F(SlurmWords, AQueueThatDoesNotAnswerIsNoEmptyQueue) {
  idle_slurm();
  command("squeue", "echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2; exit 1");
  const ProcessResult ending = run();
  EXPECT_EQ(ending.exit, 74);
  EXPECT_SAYS(ending.err, "Unable to contact slurm controller");
  EXPECT_FALSE(fs::exists(folder.path() / "sbatch.said"));
}

TEST_F(SlurmWords, WithoutSlurmTheHostIsTheWrongOne) {
  ProcessEnvironment around;
  around.variables = {{"PATH", folder.path().string()}};
  const ProcessResult ending =
      raywatt(sweep_run(folder, write_sweep(folder, kFourPoints), {"--launcher", "slurm"}), around);
  expect_refusal(ending, {"squeue cannot be started", "local"});
}

TEST_F(SlurmWords, TasksThatNeverBeginAreToldOf) {
  idle_slurm();
  const ProcessResult ending = run({"--wait"});
  EXPECT_EQ(ending.exit, 1);
  EXPECT_SAYS(ending.out, "4 points have no result");
  EXPECT_SAYS(read_bytes(out / "results.csv"), ",missing,");
}

TEST_F(SlurmWords, WhatIsNotForOthersToChooseIsRefused) {
  idle_slurm();
  expect_refusal(run({"--slurm-args", "--array=1-5"}), {"--array=1-5", "--chunk"});
  expect_refusal(run({"--slurm-args", "--partition fat"}), {"'fat'", "in one word"});
  expect_refusal(raywatt(sweep_run(folder, write_sweep(folder, kFourPoints), {"--wait"})), {"--launcher slurm"});
}

TEST_F(SlurmWords, ToCopyAreQuotedForTheShell) {
  idle_slurm();
  const fs::path two = folder.path() / "two words";
  const std::string quoted = "'" + two.string() + "'";
  const Words words = {"sweep",      "run",     "-o",
                       two.string(), "--store", (folder.path() / "store").string(),
                       "--launcher", "slurm",   write_sweep(folder, kFourPoints).string()};
  EXPECT_SAYS(with_commands(words).out, "raywatt sweep status " + quoted + "; raywatt sweep cancel " + quoted + "\n");
  command("squeue", "test -e '" + (folder.path() / "scancel.said").string() + "' || echo '12|1|PENDING|Priority||" +
                        (fs::canonical(two) / "submit-1.sh").string() + "'");
  EXPECT_SAYS(with_commands({"sweep", "cancel", two.string()}).out, "raywatt sweep run --resume -o " + quoted + "\n");
}

}  // namespace
}  // namespace test

// Tests of how points are distributed to the tasks of a job array.

namespace tools::sweep {
namespace {

using Lines = std::vector<std::string>;

/// Returns points named a, b, c, ... The letters of `streams` name the recorded work that each uses; '-' is none.
Lines lines_of(const std::string& streams, std::uint64_t chunk) {
  std::vector<Point> points(streams.size());
  std::vector<const Point*> pointers;
  for (std::size_t p = 0; p < points.size(); ++p) {
    points[p].id = std::string(1, static_cast<char>('a' + p));
    if (streams[p] != '-') points[p].stream = std::string(1, streams[p]);
    pointers.push_back(&points[p]);
  }
  return task_lines(pointers, chunk);
}

TEST(SlurmTasks, ALineIsATaskOfAsManyPointsAsAChunkHas) {
  EXPECT_EQ(lines_of("-----", 1), (Lines{"a", "b", "c", "d", "e"}));
  EXPECT_EQ(lines_of("-----", 2), (Lines{"a b", "c d", "e"}));
  EXPECT_EQ(lines_of("-----", 9), (Lines{"a b c d e"}));
}

TEST(SlurmTasks, PointsWithTheSameRecordedWorkAreOfOneTask) {
  EXPECT_EQ(lines_of("XYXYXY", 3), (Lines{"a c e", "b d f"}));
  EXPECT_EQ(lines_of("XXYY", 3), (Lines{"a b", "c d"})) << "rather a short task than a stream in two";
  EXPECT_EQ(lines_of("XXYYZ", 5), (Lines{"a b c d e"}));
  EXPECT_EQ(lines_of("X-X-", 2), (Lines{"a c", "b d"}));
}

TEST(SlurmTasks, WhatIsTooLargeForATaskIsCut) {
  EXPECT_EQ(lines_of("XXXXX", 2), (Lines{"a b", "c d", "e"}));
  EXPECT_EQ(lines_of("XXXXXYY", 3), (Lines{"a b c", "d e", "f g"}));
}

}  // namespace
}  // namespace tools::sweep
