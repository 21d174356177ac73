#include "tools/interrupt.h"

#include <csignal>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "tools/run_folder.h"

// A run that is stopped leaves nothing half made.

namespace test {
namespace {

namespace fs = std::filesystem;

/// A run that takes many seconds, and says a warning once it has read its scene.
class LongRun {
 public:
  LongRun() {
    file_.material()["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1};
    scene_ = folder_.write("warned.gltf", file_.text()).string();
  }
  /// Stops a run into `out` with this signal while it works.
  Ending stopped_by(int signal, const fs::path& out) const {
    Program program({"run", "--scene", scene_, "--program", "full:1024", "--threads", "2", "-o", out.string()});
    EXPECT_TRUE(program.wait_for_complaint());
    program.send(signal);
    return program.wait();
  }

 private:
  TempFolder folder_;
  TinyGltf file_;
  std::string scene_;
};

TEST(Interrupt, EndsWithTheSignalsCodeAndLeavesNothing) {
  const LongRun run;
  const TempFolder folder;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Ending ending = run.stopped_by(signal, folder.path() / "new" / "out");
    EXPECT_EQ(ending.exit, 128 + signal);
    EXPECT_EQ(ending.out, "");
    EXPECT_TRUE(ending.err.ends_with("raywatt: interrupted\n")) << ending.err;
    EXPECT_EQ(names_in(folder.path()), Words{});
  }
}

TEST(Interrupt, LeavesTheFormerRunAsItWas) {
  const LongRun run;
  const TempFolder folder;
  const fs::path out = folder.path() / "out";
  ASSERT_EQ(raywatt(small_run(out)).exit, 0);
  const std::string former = read_bytes(out / "report.json");
  for (const int signal : {SIGINT, SIGKILL}) {
    EXPECT_EQ(run.stopped_by(signal, out).exit, 128 + signal);
    EXPECT_EQ(read_bytes(out / "report.json"), former);
    EXPECT_EQ(names_in(folder.path()), Words{"out"});
  }
  EXPECT_EQ(raywatt(small_run(out)).exit, 0) << "the next run is not disturbed";
}

TEST(Interrupt, WaitsUntilResultsThatAreBeingWrittenAreThere) {
  const TempFolder folder;
  const auto interrupted = [&] {
    tools::end_on_interrupts();
    tools::RunFolder results(folder.path() / "out", false);
    results.fill([](const tools::RunFolder::Open& open) {
      const fs::path& staging = open();
      std::raise(SIGTERM);
      std::ofstream(staging / "report.json") << "{}";
    });
  };
  EXPECT_EXIT(interrupted(), testing::ExitedWithCode(128 + SIGTERM), "raywatt: interrupted");
  EXPECT_EQ(names_in(folder.path()), Words{"out"});
  EXPECT_EQ(read_bytes(folder.path() / "out" / "report.json"), "{}");
}

TEST(Interrupt, StaysIgnoredWhereTheCallerIgnoresIt) {
  const auto ignored = [] {
    std::signal(SIGINT, SIG_IGN);
    tools::end_on_interrupts();
    std::raise(SIGINT);
    std::_Exit(0);
  };
  EXPECT_EXIT(ignored(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace test
