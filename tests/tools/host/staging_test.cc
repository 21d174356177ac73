#include "tools/host/staging.h"

#include <atomic>
#include <fstream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/program.h"

namespace test {
namespace {

// Each writer would remove the folders of the others if they did not hold their locks.
TEST(Staging, OfManyWithOneTargetIsTakenFromNone) {
  const TempFolder folder;
  std::atomic<int> lost = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 300; ++i) {
        tools::Staging staging(folder.path() / "out");
        lost += staging.make() || !(std::ofstream(staging.folder() / "report.json") << "{}") ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(lost, 0);
  EXPECT_EQ(names_in(folder.path()), Words{});
}

}  // namespace
}  // namespace test
