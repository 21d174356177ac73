#include <gtest/gtest.h>

#include "tests/hw_models/dram/dram_harness.h"

// Tests of reads whose data wait in the channel because their port is full.

namespace hw::test {
namespace {

constexpr std::uint64_t kLongAfter = 10'000;

/// Simulates hits of one row through a port with room for one answer. The requester takes one every `kLongAfter`
/// cycles.
struct SlowPort : DramHarness {
  explicit SlowPort(std::uint32_t reads, DramConfig c = quiet()) : DramHarness(c, 1, 1) {
    requester().pop_every = kLongAfter;
    for (Addr i = 0; i < reads; ++i) requester().send(64 * i);
    run();
  }
};

/// Reads in flight last RL + tDQSCK + a line = 28 + 3 + 16 cycles, which is 2 lines. The channel has room for twice (2
/// + 4) lines.
constexpr std::uint32_t kRoom = 2 * (2 + 4);

TEST(DramReturns, HaveRoomForTwiceWhatIsInFlightAndFourMore) {
  SlowPort s(1 + kRoom);
  EXPECT_LT(s.stats().read_latency_max, kLongAfter) << "one in the port, the others in the channel";
}

TEST(DramReturns, StopReadsThatFindNoRoom) {
  SlowPort s(1 + kRoom + 1);
  EXPECT_GT(s.stats().read_latency_max, kLongAfter - 100);
  EXPECT_GT(s.why(DramCycleReason::kReturnsFull), kLongAfter - 500);
}

TEST(DramReturns, HaveMoreRoomForALongerFabric) {
  DramConfig c = DramHarness::quiet();
  c.fabric = {17 * c.timing.ck.time};  // 64 cycles in flight: 4 lines
  SlowPort enough(1 + 2 * (4 + 4), c);
  EXPECT_LT(enough.stats().read_latency_max, kLongAfter);
  SlowPort one_more(1 + 2 * (4 + 4) + 1, c);
  EXPECT_GT(one_more.stats().read_latency_max, kLongAfter - 100);
}

}  // namespace
}  // namespace hw::test
