#include <filesystem>

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

// Tests the program on older processors, emulated by QEMU (`tools/validate package` installs it).

ProcessResult on_processor(const char* name) {
  return raywatt({"-cpu", name, RAYWATT_PROGRAM, "--version"}, {.program = "/usr/bin/qemu-x86_64"});
}

struct Processors : testing::Test {
  void SetUp() override {
#ifdef RAYWATT_SANITIZED
    GTEST_SKIP() << "sanitizers look at the processor first";
#elif !defined(__x86_64__)
    GTEST_SKIP() << "any processor of this kind will do";
#endif
    if (!std::filesystem::exists("/usr/bin/qemu-x86_64"))
      GTEST_SKIP() << "there is no qemu-x86_64 (Debian's qemu-user)";
  }
};

TEST_F(Processors, WithoutAvx2GetOneLineAndNoCrash) {
  for (const char* name : {"Nehalem", "SandyBridge", "qemu64"}) {
    const ProcessResult ending = on_processor(name);
    EXPECT_EQ(ending.exit, 2) << name << ": " << ending.err;
    EXPECT_EQ(ending.out, "") << name;
    EXPECT_NE(ending.err.find("raywatt: needs a processor with AVX2, FMA and BMI2 (x86-64-v3)"), std::string::npos)
        << name << ": " << ending.err;
  }
}

TEST_F(Processors, WithAvx2AreTaken) {
  const ProcessResult ending = on_processor("Haswell");
  EXPECT_EQ(ending.exit, 0) << ending.err;
  EXPECT_TRUE(ending.out.starts_with("raywatt ")) << ending.out;
}

}  // namespace
}  // namespace test
