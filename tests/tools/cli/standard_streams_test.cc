#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/tools/program.h"
#include "tests/tools/studies/sweep/small_sweep.h"

// Tests of processes whose standard streams are closed or accept no output.

namespace test {
namespace {

TEST(StandardStreams, AnErrorThatCannotBePrintedKeepsItsExitCode) {
  EXPECT_EQ(raywatt({"config", "show", "nosuch"}, {.closed = {STDERR_FILENO}}).exit, 2);
  EXPECT_EQ(raywatt({"config", "show", "nosuch"}, {.err = "/dev/full"}).exit, 2);
}

TEST(StandardStreams, OutputThatCannotBeWrittenFails) {
  EXPECT_EQ(raywatt({"config", "show"}, {.out = "/dev/full"}).exit, 74);
  EXPECT_EQ(raywatt({"config", "show"}, {.closed = {STDOUT_FILENO}}).exit, 74);
}

TEST(StandardStreams, HelpAndVersionThatCannotBeWrittenFail) {
  for (const Words& words : std::vector<Words>{{"--help"}, {"run", "--help"}, {"--version"}}) {
    EXPECT_EQ(raywatt(words).exit, 0);
    EXPECT_EQ(raywatt(words, {.out = "/dev/full"}).exit, 74);
    EXPECT_EQ(raywatt(words, {.unread = {STDOUT_FILENO}}).exit, 74);
  }
}

TEST(StandardStreams, AClosedPipeIsAFailedWrite) {
  const TempFolder folder;
  const ProcessResult table = raywatt({"scenes", "list"}, {.unread = {STDOUT_FILENO}});
  EXPECT_EQ(table.exit, 74);
  EXPECT_SAYS(table.err, "Broken pipe");
  EXPECT_EQ(raywatt({"config", "show", "nosuch"}, {.unread = {STDERR_FILENO}}).exit, 2);
  const ProcessResult run =
      raywatt(small_run(folder.path() / "out", {"--progress", "json"}), {.unread = {STDERR_FILENO}});
  EXPECT_EQ(run.exit, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / "report.json"));
}

TEST(StandardStreams, ARunWithoutStreamsWritesItsFiles) {
  const TempFolder folder;
  const ProcessResult ending =
      raywatt(small_run(folder.path() / "out", {"--quiet"}), {.closed = {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}});
  EXPECT_EQ(ending.exit, 0);
  EXPECT_EQ(read_json(folder.path() / "out/report.json")["frames"].size(), 1U);
  EXPECT_EQ(ending.out + ending.err, "") << "no file of the run took their place";
}

TEST(StandardStreams, ASweepWithoutStreamsKeepsTheResultOfEveryPoint) {
  const TempFolder folder;
  const std::filesystem::path file = write_sweep(folder, "axes: {cores: [1, 2], tni.trvs: [1, 2]}\n");
  const ProcessResult ending =
      raywatt(sweep_run(folder, file, {"-j", "2"}), {.closed = {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}});
  EXPECT_EQ(points_in(folder.path() / "store"), 4U);
  EXPECT_EQ(ending.exit, 74) << "its table goes nowhere";
  EXPECT_EQ(last_run_counts(folder.path() / "out"), (Tally{4, 4, 0, 0}));
}

}  // namespace
}  // namespace test
