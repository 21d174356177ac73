#include <gtest/gtest.h>

#include "tests/hw_models/memory/bank_harness.h"

namespace hw::test {
namespace {

TEST(L2Bank, HasRoomForTwoRequestsToMemoryForEachMshrAndTwoMore) {
  L2Config config = BankHarness::small();
  config.writes = L2Writes::kAround;
  constexpr std::uint64_t kMemory = 1'000;
  // Memory has one answer in flight at a time, so it accepts the second read after the first answer.
  BankHarness b(config, 1, 1, kMemory);
  for (Addr i = 0; i < 2; ++i) b.core(0).send(64 * i);
  for (Addr i = 2; i < 40; ++i) b.core(0).send(64 * i, 0, true);
  b.harness.run();
  std::uint32_t writes = 0;
  for (std::size_t i = 2; i < 40; ++i) writes += b.core(0).script[i].cycle < kMemory;
  // All room of the bank except for the two misses; one more write waits in the bank, and one in the port.
  EXPECT_EQ(writes, 2 * config.cache.mshrs + 2 - 2 + 1 + 1);
}

}  // namespace
}  // namespace hw::test
