#include <array>

#include <gtest/gtest.h>

#include "hw_models/srp/array_loop.h"

namespace hw {
namespace {

TEST(ConfigMemory, AKernelIsLoadedOnceAndStaysWhileAllFit) {
  ConfigMemory memory(100, 3);
  for (const auto kernel : std::to_array<traces::KernelId>({0, 1, 2}))
    EXPECT_FALSE(memory.select_kernel(kernel, kernel == 2 ? 20 : 40));
  for (const auto kernel : std::to_array<traces::KernelId>({2, 0, 1, 1, 0, 2}))
    EXPECT_TRUE(memory.select_kernel(kernel, kernel == 2 ? 20 : 40));
}

TEST(ConfigMemory, TheLeastRecentlyUsedKernelIsEvicted) {
  ConfigMemory memory(100, 4);
  memory.select_kernel(0, 40);
  memory.select_kernel(1, 40);
  memory.select_kernel(0, 40);
  EXPECT_FALSE(memory.select_kernel(2, 50)) << "1 goes, 0 ran later";
  EXPECT_TRUE(memory.select_kernel(0, 40));
  EXPECT_FALSE(memory.select_kernel(1, 40));
}

TEST(ConfigMemory, ALargeKernelEvictsAsManyAsItNeeds) {
  ConfigMemory memory(100, 4);
  for (const auto kernel : std::to_array<traces::KernelId>({0, 1, 2})) memory.select_kernel(kernel, 30);
  EXPECT_FALSE(memory.select_kernel(3, 70));
  EXPECT_TRUE(memory.select_kernel(2, 30));
  EXPECT_FALSE(memory.select_kernel(1, 30)) << "3 goes, 2 ran later";
  EXPECT_TRUE(memory.select_kernel(2, 30));
}

TEST(ConfigMemory, AKernelLargerThanTheMemoryIsAlwaysLoadedAndLeavesNoneResident) {
  ConfigMemory memory(100, 2);
  memory.select_kernel(0, 40);
  EXPECT_FALSE(memory.select_kernel(1, 101));
  EXPECT_FALSE(memory.select_kernel(1, 101));
  EXPECT_FALSE(memory.select_kernel(0, 40));
  EXPECT_TRUE(memory.select_kernel(0, 40));
}

}  // namespace
}  // namespace hw
