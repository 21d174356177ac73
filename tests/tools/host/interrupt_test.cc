#include <csignal>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/tools/program.h"
#include "tools/host/process.h"
#include "tools/host/run_folder.h"

// Tests of how a process handles signals.

namespace test {
namespace {

namespace fs = std::filesystem;

TEST(Interrupt, WaitsUntilResultsThatAreBeingWrittenAreThere) {
  const TempFolder folder;
  const auto interrupted = [&] {
    tools::install_interrupt_handlers();
    tools::RunFolder results(folder.path() / "out", false);
    results.fill([](const tools::RunFolder::Open& open) {
      const fs::path& staging = open();
      std::raise(SIGTERM);
      std::ofstream(staging / "report.json") << "{}";
      return "it";
    });
  };
  EXPECT_EXIT(interrupted(), testing::ExitedWithCode(128 + SIGTERM), "raywatt: interrupted");
  EXPECT_EQ(names_in(folder.path()), Words{"out"});
  EXPECT_EQ(read_bytes(folder.path() / "out" / "report.json"), "{}");
}

TEST(Interrupt, PrintsNoControlSequencesOfOthers) {
  const TempFolder folder;
  const auto interrupted = [&] {
    tools::install_interrupt_handlers();
    tools::RunFolder results(folder.path() / "out\x1b[31m", false);
    results.fill([](const tools::RunFolder::Open& open) {
      std::ofstream(open() / "report.json") << "{}";
      std::raise(SIGTERM);
      return "it";
    });
  };
  EXPECT_EXIT(interrupted(), testing::ExitedWithCode(128 + SIGTERM),
              "raywatt: interrupted; kept it in .*/out\\?\\[31m");
}

TEST(Interrupt, StaysIgnoredWhereTheCallerIgnoresIt) {
  const auto ignored = [] {
    std::signal(SIGINT, SIG_IGN);
    tools::install_interrupt_handlers();
    std::raise(SIGINT);
    std::_Exit(0);
  };
  EXPECT_EXIT(ignored(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace test
