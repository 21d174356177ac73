#include <gtest/gtest.h>

#include "tests/hw_models/dram/dram_harness.h"

namespace hw::test {
namespace {

TEST(IdealChannel, ReadsAndWritesInTheCycleOfARequestsArrival) {
  DramHarness b(DramHarness::quiet(), 1, 64, true);
  b.requester().send(0, 0);
  b.requester().send(64, 5, true);
  b.requester().send(128, 9, true);
  b.requester().send(192, 20);
  const std::uint64_t cycles = b.run();
  EXPECT_EQ(b.why(DramCycleReason::kReading), 2U);
  EXPECT_EQ(b.why(DramCycleReason::kWriting), 2U);
  EXPECT_EQ(b.why(DramCycleReason::kIdle), cycles - 4);
}

TEST(IdealChannel, WaitsForAFullPort) {
  constexpr std::uint64_t kLongAfter = 1'000;
  DramHarness b(DramHarness::quiet(), 1, 1, true);
  b.requester().pop_every = kLongAfter;
  b.requester().send(0);
  b.requester().send(64);
  b.run();
  EXPECT_EQ(b.why(DramCycleReason::kReading), 2U);
  EXPECT_GT(b.why(DramCycleReason::kReturnsFull), kLongAfter - 10);
  EXPECT_LE(b.why(DramCycleReason::kReturnsFull), kLongAfter);
  EXPECT_EQ(b.requester().script[1].answered, 2 * kLongAfter);
}

}  // namespace
}  // namespace hw::test
